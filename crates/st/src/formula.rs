//! The names that an expression reads. A caller with their values declares variables for them, replaces
//! the names, and compiles the whole as a program.

use crate::Report;
use crate::error::Found;
use crate::parse;
use crate::source::{Source, Sources, Span};
use crate::syntax::{Expression, ExpressionKind, Path, Selector};

/// A name that an expression reads, such as `Z.ActualPosition` or `cell.Units[1].Busy`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Reference {
    /// The name as in the text, up to a bit of it.
    pub path: String,
    /// Its bytes in the text.
    pub span: Span,
}

/// The names that an expression reads, in the order of the text. Names of enumerations are included; those of
/// functions are not. Cost: linear in the text.
///
/// # Errors
/// The [`Report`] of an expression that cannot be read.
pub fn references(text: &str) -> Result<Vec<Reference>, Box<Report>> {
    let source = Source {
        name: "expression",
        bytes: text.as_bytes(),
    };
    let mut found = Found::default();
    let sources = Sources::new(&[source], &mut found);
    let expression = parse::expression(&sources, &mut found);
    if found.has_errors() {
        return Err(Box::new(found.report(sources)));
    }
    let mut references = Vec::new();
    in_expression(&expression, &sources, &mut references);
    references.sort_by_key(|reference| reference.span);
    Ok(references)
}

fn in_expression(expression: &Expression, sources: &Sources, found: &mut Vec<Reference>) {
    match &expression.kind {
        ExpressionKind::Bool(_)
        | ExpressionKind::Integer(_)
        | ExpressionKind::Real(_)
        | ExpressionKind::Duration(..)
        | ExpressionKind::Text(_)
        | ExpressionKind::Element(..)
        | ExpressionKind::Wrong => {}
        ExpressionKind::Typed(_, inner) | ExpressionKind::Negative(inner) | ExpressionKind::Not(inner) => {
            in_expression(inner, sources, found);
        }
        ExpressionKind::Path(path) => in_path(path, sources, found),
        ExpressionKind::Call(call) => {
            let values = call
                .arguments
                .iter()
                .filter_map(|argument| argument.value.as_ref());
            values.for_each(|value| in_expression(value, sources, found));
        }
        ExpressionKind::Chain(first, rest) => {
            in_expression(first, sources, found);
            rest.iter()
                .for_each(|(.., inner)| in_expression(inner, sources, found));
        }
    }
}

fn in_path(path: &Path, sources: &Sources, found: &mut Vec<Reference>) {
    let whole = path
        .selectors
        .iter()
        .take_while(|selector| !matches!(selector, Selector::Bit(..)));
    let end = whole.last().map_or(path.root.span, |selector| match selector {
        Selector::Member(name) => name.span,
        Selector::Index(_, span) | Selector::Bit(_, span) => *span,
    });
    let span = path.root.span.to(end);
    let text = sources.text(span);
    found.push(Reference {
        path: text.chars().filter(|c| !c.is_whitespace()).collect(),
        span,
    });
}
