//! The places where the sources can be changed a little, and the changes: one [`Point`] for each.

use std::collections::BTreeMap;
use std::ops::Range;
use syn::spanned::Spanned;
use syn::visit::{self, Visit};
use syn::{BinOp, Expr, Stmt, UnOp};

/// One small change of one file.
#[derive(Clone, Debug)]
pub struct Point {
    /// The identity of the change, as long as its function keeps its name and the changed piece its text.
    pub key: String,
    /// The file, relative to the root of the repository.
    pub file: String,
    pub line: usize,
    /// The bytes of the file that are replaced.
    pub range: Range<usize>,
    /// The replacement.
    pub mutated: String,
    /// Whether the bytes are a whole statement, or an expression.
    pub statement: bool,
}

/// The variants without data of every enum in `files`, in their order.
pub fn variants(files: &[(String, String, syn::File)]) -> BTreeMap<String, Vec<String>> {
    struct Enums(BTreeMap<String, Vec<String>>);
    impl<'a> Visit<'a> for Enums {
        fn visit_item_enum(&mut self, item: &'a syn::ItemEnum) {
            let plain = item.variants.iter().filter(|variant| variant.fields.is_empty());
            let names = plain.map(|variant| variant.ident.to_string()).collect();
            self.0.insert(item.ident.to_string(), names);
        }
    }
    let mut enums = Enums(BTreeMap::new());
    for (_, _, parsed) in files {
        enums.visit_file(parsed);
    }
    enums.0
}

/// Every point of a file. Left out: tests, `const` (no choice at run time there), patterns, types, macros
/// except `matches!`, and functions that only make text.
pub fn points(
    file: &str,
    text: &str,
    parsed: &syn::File,
    variants: &BTreeMap<String, Vec<String>>,
) -> Vec<Point> {
    let mut finder = Finder {
        file,
        text,
        variants,
        within: Vec::new(),
        seen: BTreeMap::new(),
        points: Vec::new(),
    };
    finder.visit_file(parsed);
    finder.points
}

/// Operators and methods that replace each other, in both directions.
const SWAPS: [[&str; 2]; 20] = [
    ["<", ">="],
    [">", "<="],
    ["<", "<="],
    [">", ">="],
    ["==", "!="],
    ["&&", "||"],
    ["+", "-"],
    ["*", "/"],
    ["&", "|"],
    ["<<", ">>"],
    ["+=", "-="],
    ["*=", "/="],
    ["&=", "|="],
    ["min", "max"],
    ["any", "all"],
    ["is_some", "is_none"],
    ["is_ok", "is_err"],
    ["is_some_and", "is_none_or"],
    ["saturating_add", "saturating_sub"],
    ["wrapping_add", "wrapping_sub"],
];

struct Finder<'a> {
    file: &'a str,
    text: &'a str,
    variants: &'a BTreeMap<String, Vec<String>>,
    /// The type and the function around, outermost first.
    within: Vec<String>,
    seen: BTreeMap<String, usize>,
    points: Vec<Point>,
}

impl<'a> Finder<'a> {
    fn text_of(&self, node: &impl Spanned) -> &'a str {
        &self.text[node.span().byte_range()]
    }

    fn add(&mut self, node: &impl Spanned, mutated: &str, statement: bool) {
        // Types and constants have expressions of their own; code that runs is in a function.
        if self.within.is_empty() {
            return;
        }
        let original = one_line(self.text_of(node));
        let changed = if mutated.is_empty() { "nothing" } else { mutated };
        let place = self.within.join("::");
        let mut key = format!("{} | {place} | {original} -> {}", self.file, one_line(changed));
        let times = self.seen.entry(key.clone()).or_default();
        *times += 1;
        if *times > 1 {
            key += &format!(" #{times}");
        }
        self.points.push(Point {
            key,
            file: self.file.to_owned(),
            line: node.span().start().line,
            range: node.span().byte_range(),
            mutated: mutated.to_owned(),
            statement,
        });
    }

    /// `node` with `part` of it replaced.
    fn replaced(&self, node: &impl Spanned, part: &impl Spanned, by: &str) -> String {
        let (outer, inner) = (node.span().byte_range(), part.span().byte_range());
        [
            &self.text[outer.start..inner.start],
            by,
            &self.text[inner.end..outer.end],
        ]
        .concat()
    }

    /// `node` with its operator or method swapped.
    fn swaps(&mut self, node: &impl Spanned, part: &impl Spanned) {
        for [one, other] in SWAPS {
            for (from, to) in [(one, other), (other, one)] {
                if self.text_of(part) == from {
                    self.add(node, &self.replaced(node, part, to), false);
                }
            }
        }
    }

    /// A condition between two paths; a `let` among `&&` cannot be a value.
    fn condition(&mut self, condition: &Expr) {
        match condition {
            Expr::Let(_) => {}
            Expr::Binary(chain) if has_let(condition) => {
                self.condition(&chain.left);
                self.condition(&chain.right);
            }
            _ => {
                self.add(condition, "true", false);
                self.add(condition, "false", false);
            }
        }
    }

    fn function(
        &mut self,
        attributes: &[syn::Attribute],
        signature: &syn::Signature,
        body: Option<&syn::Block>,
    ) {
        let makes_text = matches!(&signature.output, syn::ReturnType::Type(_, kind) if self.text_of(kind).ends_with("str"));
        if let Some(body) = body
            && signature.constness.is_none()
            && !makes_text
            && !is_test(attributes)
        {
            self.within.push(signature.ident.to_string());
            self.visit_block(body);
            self.within.pop();
        }
    }

    fn implementation(&mut self, name: String, of: impl FnOnce(&mut Self)) {
        let outer = std::mem::replace(&mut self.within, vec![name]);
        of(self);
        self.within = outer;
    }
}

impl<'a> Visit<'a> for Finder<'_> {
    fn visit_item_mod(&mut self, item: &'a syn::ItemMod) {
        if !is_test(&item.attrs) {
            visit::visit_item_mod(self, item);
        }
    }

    fn visit_item_impl(&mut self, item: &'a syn::ItemImpl) {
        let shown = |path: &syn::Path| {
            path.segments
                .last()
                .is_some_and(|last| last.ident == "Debug" || last.ident == "Display")
        };
        if item.trait_.as_ref().is_some_and(|(_, path, _)| shown(path)) {
            return;
        }
        let name = self
            .text_of(&item.self_ty)
            .split('<')
            .next()
            .unwrap_or_default()
            .to_owned();
        self.implementation(name, |finder| visit::visit_item_impl(finder, item));
    }

    fn visit_item_trait(&mut self, item: &'a syn::ItemTrait) {
        self.implementation(item.ident.to_string(), |finder| {
            visit::visit_item_trait(finder, item)
        });
    }

    fn visit_item_fn(&mut self, item: &'a syn::ItemFn) {
        self.function(&item.attrs, &item.sig, Some(&item.block));
    }

    fn visit_impl_item_fn(&mut self, item: &'a syn::ImplItemFn) {
        self.function(&item.attrs, &item.sig, Some(&item.block));
    }

    fn visit_trait_item_fn(&mut self, item: &'a syn::TraitItemFn) {
        self.function(&item.attrs, &item.sig, item.default.as_ref());
    }

    fn visit_item_const(&mut self, _: &'a syn::ItemConst) {}
    fn visit_item_static(&mut self, _: &'a syn::ItemStatic) {}
    fn visit_impl_item_const(&mut self, _: &'a syn::ImplItemConst) {}
    fn visit_trait_item_const(&mut self, _: &'a syn::TraitItemConst) {}
    fn visit_expr_const(&mut self, _: &'a syn::ExprConst) {}
    fn visit_expr_repeat(&mut self, _: &'a syn::ExprRepeat) {}
    fn visit_attribute(&mut self, _: &'a syn::Attribute) {}
    fn visit_type(&mut self, _: &'a syn::Type) {}
    fn visit_pat(&mut self, _: &'a syn::Pat) {}

    fn visit_stmt(&mut self, statement: &'a Stmt) {
        if let Stmt::Expr(expr, Some(_)) = statement {
            let called = if let Expr::Try(tried) = expr {
                &tried.expr
            } else {
                expr
            };
            let sets = match called {
                Expr::Assign(_) | Expr::MethodCall(_) | Expr::Call(_) => true,
                Expr::Binary(binary) => self.text_of(&binary.op).ends_with('='),
                _ => false,
            };
            if sets {
                self.add(statement, "", true);
            }
        }
        visit::visit_stmt(self, statement);
    }

    fn visit_expr_if(&mut self, expr: &'a syn::ExprIf) {
        self.condition(&expr.cond);
        visit::visit_expr_if(self, expr);
    }

    fn visit_expr_while(&mut self, expr: &'a syn::ExprWhile) {
        self.condition(&expr.cond);
        visit::visit_expr_while(self, expr);
    }

    fn visit_arm(&mut self, arm: &'a syn::Arm) {
        if let Some((_, guard)) = &arm.guard {
            self.condition(guard);
        }
        visit::visit_arm(self, arm);
    }

    fn visit_expr_match(&mut self, expr: &'a syn::ExprMatch) {
        for pair in expr.arms.windows(2) {
            let (body, next) = (self.text_of(&pair[0].body), self.text_of(&pair[1].body));
            if body != next {
                self.add(&pair[0].body, next, false);
            }
        }
        visit::visit_expr_match(self, expr);
    }

    fn visit_expr_binary(&mut self, expr: &'a syn::ExprBinary) {
        if !has_let(&expr.left) && !has_let(&expr.right) {
            self.swaps(expr, &expr.op);
            if matches!(expr.op, BinOp::And(_) | BinOp::Or(_)) {
                for side in [&expr.left, &expr.right] {
                    self.add(expr, self.text_of(side), false);
                }
            }
        }
        visit::visit_expr_binary(self, expr);
    }

    fn visit_expr_unary(&mut self, expr: &'a syn::ExprUnary) {
        if matches!(expr.op, UnOp::Not(_) | UnOp::Neg(_)) {
            self.add(expr, self.text_of(&expr.expr), false);
        }
        visit::visit_expr_unary(self, expr);
    }

    fn visit_expr_lit(&mut self, expr: &'a syn::ExprLit) {
        if let syn::Lit::Bool(value) = &expr.lit {
            self.add(expr, if value.value { "false" } else { "true" }, false);
        }
    }

    fn visit_expr_path(&mut self, expr: &'a syn::ExprPath) {
        let mut back = expr.path.segments.iter().rev();
        if let (Some(variant), Some(of)) = (back.next(), back.next())
            && let Some(all) = self.variants.get(&of.ident.to_string())
            && let Some(at) = all.iter().position(|name| variant.ident == name)
        {
            let next = &all[(at + 1) % all.len()];
            if variant.ident != next {
                self.add(expr, &self.replaced(expr, variant, next), false);
            }
        }
    }

    fn visit_expr_method_call(&mut self, expr: &'a syn::ExprMethodCall) {
        self.swaps(expr, &expr.method);
        visit::visit_expr_method_call(self, expr);
    }

    fn visit_expr_macro(&mut self, expr: &'a syn::ExprMacro) {
        if expr.mac.path.is_ident("matches") {
            self.add(expr, &format!("!{}", self.text_of(expr)), false);
        }
    }
}

fn has_let(expr: &Expr) -> bool {
    match expr {
        Expr::Let(_) => true,
        Expr::Binary(binary) => has_let(&binary.left) || has_let(&binary.right),
        _ => false,
    }
}

fn is_test(attributes: &[syn::Attribute]) -> bool {
    attributes.iter().any(|attribute| match &attribute.meta {
        syn::Meta::Path(path) => path.is_ident("test"),
        syn::Meta::List(list) => list.path.is_ident("cfg") && list.tokens.to_string() == "test",
        syn::Meta::NameValue(_) => false,
    })
}

fn one_line(text: &str) -> String {
    let code = text
        .lines()
        .map(|line| line.split("//").next().unwrap_or_default());
    code.flat_map(str::split_whitespace).collect::<Vec<_>>().join(" ")
}
