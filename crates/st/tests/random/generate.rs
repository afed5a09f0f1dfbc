//! Random well-typed programs, in Structured Text and in C side by side. The rules for types and operators are
//! written again here, from the standard. No code of the compiler is used.
//!
//! Whole numbers are 128 bits wide in C and truncated to their type after every operator, so nothing
//! overflows; divisors are not 0, indices are in their bounds, and loops end.

use standstill_testkit::Random;
use std::fmt::Write;

/// The operations on a type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Bool,
    Bits,
    Whole,
    Real,
    Time,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ty {
    pub name: &'static str,
    kind: Kind,
    pub bits: u32,
    signed: bool,
}

const fn ty(name: &'static str, kind: Kind, bits: u32, signed: bool) -> Ty {
    Ty {
        name,
        kind,
        bits,
        signed,
    }
}

const BOOL: Ty = ty("BOOL", Kind::Bool, 1, false);
const REAL: Ty = ty("REAL", Kind::Real, 32, true);
const LREAL: Ty = ty("LREAL", Kind::Real, 64, true);
const TIME: Ty = ty("TIME", Kind::Time, 64, true);
const WHOLE: [Ty; 8] = [
    ty("SINT", Kind::Whole, 8, true),
    ty("INT", Kind::Whole, 16, true),
    ty("DINT", Kind::Whole, 32, true),
    ty("LINT", Kind::Whole, 64, true),
    ty("USINT", Kind::Whole, 8, false),
    ty("UINT", Kind::Whole, 16, false),
    ty("UDINT", Kind::Whole, 32, false),
    ty("ULINT", Kind::Whole, 64, false),
];
const BITS: [Ty; 4] = [
    ty("BYTE", Kind::Bits, 8, false),
    ty("WORD", Kind::Bits, 16, false),
    ty("DWORD", Kind::Bits, 32, false),
    ty("LWORD", Kind::Bits, 64, false),
];

fn all() -> Vec<Ty> {
    let mut all = vec![BOOL, BOOL, REAL, LREAL, LREAL, TIME];
    all.extend(WHOLE);
    all.extend(BITS);
    all
}

impl Ty {
    fn c(self) -> &'static str {
        match (self.kind, self.bits) {
            (Kind::Real, 32) => "float",
            (Kind::Real, _) => "double",
            _ => "wide",
        }
    }

    fn low(self) -> i128 {
        if self.signed { -(1 << (self.bits - 1)) } else { 0 }
    }

    fn high(self) -> i128 {
        if self.signed {
            (1 << (self.bits - 1)) - 1
        } else {
            (1 << self.bits) - 1
        }
    }

    /// Types whose values are accepted where one of this type is expected.
    fn narrower(self) -> Vec<Self> {
        let fits = |it: &Self| match (it.kind, self.kind) {
            (Kind::Bits, Kind::Bits) | (Kind::Real, Kind::Real) => it.bits < self.bits,
            (Kind::Whole, Kind::Whole) => it.bits < self.bits && (it.signed == self.signed || self.signed),
            (Kind::Whole, Kind::Real) => it.bits * 2 <= self.bits,
            _ => false,
        };
        all().into_iter().filter(fits).collect()
    }

    fn cut(self, c: &str) -> String {
        match self.kind {
            Kind::Bool => format!("(({c}) != 0)"),
            Kind::Real => format!("({})({c})", self.c()),
            _ => format!("keep({c}, {}, {})", self.bits, u8::from(self.signed)),
        }
    }
}

/// The same in both languages.
#[derive(Clone, Debug)]
struct Pair {
    st: String,
    c: String,
}

fn pair(st: impl Into<String>, c: impl Into<String>) -> Pair {
    Pair {
        st: st.into(),
        c: c.into(),
    }
}

/// A variable of a program.
#[derive(Clone, Debug)]
pub struct Variable {
    pub name: String,
    pub ty: Ty,
    /// Its path in C.
    pub c: String,
}

/// One program.
#[derive(Debug)]
pub struct Generated {
    pub st: String,
    pub c: String,
    pub variables: Vec<Variable>,
}

const INDEX_MOST: i64 = 3;

struct Generator<'r> {
    random: &'r mut Random,
    number: usize,
    variables: Vec<Variable>,
    /// Control variables that nothing else writes while their loop runs.
    locked: Vec<String>,
    /// The type of the array and of the structure's members.
    elements: Ty,
    statements: usize,
    labels: usize,
    loops: usize,
}

impl Generator<'_> {
    fn literal(&mut self, ty: Ty) -> Pair {
        match ty.kind {
            Kind::Bool => {
                let value = self.random.place(2);
                pair(["FALSE", "TRUE"][value], value.to_string())
            }
            Kind::Real => {
                let text = self.random.one_of(&[
                    "0.0",
                    "1.0",
                    "-1.0",
                    "0.1",
                    "-2.5",
                    "3.5",
                    "1.0E10",
                    "-7.25E-3",
                    "1.0E-40",
                    "3.4E38",
                    "123456.789",
                ]);
                pair(format!("{}#{text}", ty.name), format!("(({}){text})", ty.c()))
            }
            Kind::Time => {
                let ns = self.random.bits().cast_signed() >> (8 + self.random.place(50));
                let sign = if ns < 0 { "-" } else { "" };
                pair(
                    format!("T#{sign}{}ns", ns.unsigned_abs()),
                    format!("((wide){ns}LL)"),
                )
            }
            Kind::Whole | Kind::Bits => {
                let value = match self.random.place(6) {
                    0 => ty.low(),
                    1 => ty.high(),
                    2 | 3 => (self.random.place(20) as i128 - 5).max(ty.low()),
                    _ => (i128::from(self.random.bits()) >> self.random.place(60)).clamp(ty.low(), ty.high()),
                };
                let c = if value < 0 {
                    format!("(-(wide){}ULL)", value.unsigned_abs())
                } else {
                    format!("((wide){value}ULL)")
                };
                pair(format!("{}#{value}", ty.name), c)
            }
        }
    }

    fn variable(&mut self, ty: Ty, written: bool) -> Option<Pair> {
        let fit: Vec<Variable> = self
            .variables
            .iter()
            .filter(|it| it.ty == ty && !(written && self.locked.contains(&it.name)))
            .cloned()
            .collect();
        if ty == self.elements && self.random.place(3) == 0 {
            let index = self.index();
            return Some(pair(format!("arr[{}]", index.st), format!("v->arr[{}]", index.c)));
        }
        if fit.is_empty() {
            return None;
        }
        let found = &fit[self.random.place(fit.len())];
        Some(pair(&found.name, &found.c))
    }

    /// An index within the bounds of the array, for any values of the variables.
    fn index(&mut self) -> Pair {
        let ty = self.random.one_of(&WHOLE);
        let value = self.expression(ty, 1);
        let size = INDEX_MOST + 1;
        pair(
            format!("{} MOD {size}", value.st),
            format!("(int)(rest({}, {size}) + {INDEX_MOST})", value.c),
        )
    }

    /// A value of exactly this type, in parentheses where it needs them.
    fn expression(&mut self, ty: Ty, depth: usize) -> Pair {
        if depth == 0 || self.random.place(6) == 0 {
            let leaf = if self.random.place(4) > 0 {
                self.variable(ty, false)
            } else {
                None
            };
            return leaf.unwrap_or_else(|| self.literal(ty));
        }
        let depth = depth - 1;
        match self.random.place(10) {
            0 => self.conversion(ty, depth),
            1 => self.choice(ty, depth),
            _ => match ty.kind {
                Kind::Bool => self.boolean(depth),
                Kind::Bits => self.bits(ty, depth),
                Kind::Whole => self.whole(ty, depth),
                Kind::Real => self.real(ty, depth),
                Kind::Time => self.time(depth),
            },
        }
    }

    /// A value that is accepted where one of this type is expected, beside another one of that type.
    fn operand(&mut self, ty: Ty, depth: usize) -> Pair {
        let narrower = ty.narrower();
        if narrower.is_empty() || self.random.place(3) > 0 {
            return self.expression(ty, depth);
        }
        let from = self.random.one_of(&narrower);
        let value = self.expression(from, depth);
        pair(value.st, format!("({})({})", ty.c(), value.c))
    }

    fn choice(&mut self, ty: Ty, depth: usize) -> Pair {
        let (one, other) = (self.expression(ty, depth), self.expression(ty, depth));
        if self.random.place(2) == 0 {
            let decides = self.expression(BOOL, depth);
            return pair(
                format!("SEL({}, {}, {})", decides.st, one.st, other.st),
                format!("(({}) ? ({}) : ({}))", decides.c, other.c, one.c),
            );
        }
        let by = self.random.one_of(&WHOLE[4..]);
        let decides = self.expression(by, depth);
        pair(
            format!("MUX({} MOD 2, {}, {})", decides.st, one.st, other.st),
            format!("(rest({}, 2) ? ({}) : ({}))", decides.c, other.c, one.c),
        )
    }

    fn conversion(&mut self, to: Ty, depth: usize) -> Pair {
        let from = self.random.one_of(&all());
        let value = self.expression(from, depth);
        if from == to {
            return value;
        }
        let c = match (from.kind, to.kind) {
            (Kind::Time, Kind::Bool) => format!("({} != 0)", value.c),
            (_, Kind::Bool) => format!("(({}) != 0)", value.c),
            (Kind::Time, Kind::Real) => to.cut(&format!("(double)({}) / 1000000.0", value.c)),
            (Kind::Time, _) => to.cut(&format!("quotient({}, 1000000)", value.c)),
            (Kind::Real, Kind::Time) => format!(
                "rounded((double)({}) * 1000000.0, (wide)INT64_MIN, (wide)INT64_MAX)",
                value.c
            ),
            (_, Kind::Time) => to.cut(&format!("product(keep({}, 64, 1), 1000000)", value.c)),
            (Kind::Real, Kind::Real) => to.cut(&value.c),
            (Kind::Real, _) => {
                let low = if to.signed {
                    format!("-((wide)1 << {})", to.bits - 1)
                } else {
                    "0".to_owned()
                };
                let high = format!("(((wide)1 << {}) - 1)", to.bits - u32::from(to.signed));
                format!("rounded({}, {low}, {high})", value.c)
            }
            (_, Kind::Real) => {
                // From the 64 bits, as a processor does it: rounded once.
                let c = if from.signed { "int64_t" } else { "uint64_t" };
                format!("({})({c})({})", to.c(), value.c)
            }
            _ => to.cut(&value.c),
        };
        pair(format!("{}_TO_{}({})", from.name, to.name, value.st), c)
    }

    fn boolean(&mut self, depth: usize) -> Pair {
        match self.random.place(7) {
            0 => {
                let value = self.expression(BOOL, depth);
                pair(format!("(NOT {})", value.st), format!("(!({}))", value.c))
            }
            1 => {
                let (one, other) = (self.expression(BOOL, depth), self.expression(BOOL, depth));
                let (st, c) = self.random.one_of(&[("AND_THEN", "&&"), ("OR_ELSE", "||")]);
                pair(
                    format!("({} {st} {})", one.st, other.st),
                    format!("(({}) {c} ({}))", one.c, other.c),
                )
            }
            2 => {
                // AND binds tighter than XOR, and XOR tighter than OR.
                let [a, b, c, d] = [(); 4].map(|()| self.expression(BOOL, depth));
                pair(
                    format!("({} OR {} XOR {} AND {})", a.st, b.st, c.st, d.st),
                    format!("(({}) | (({}) ^ (({}) & ({}))))", a.c, b.c, c.c, d.c),
                )
            }
            3 => {
                let ty = self.random.one_of(&BITS);
                let bit = self.random.place(ty.bits as usize);
                match self.variables.iter().find(|it| it.ty == ty).cloned() {
                    Some(it) => pair(format!("{}.{bit}", it.name), format!("(({} >> {bit}) & 1)", it.c)),
                    None => self.literal(BOOL),
                }
            }
            _ => {
                let ty = self.random.one_of(&all());
                let (one, other) = (self.expression(ty, depth), self.operand(ty, depth));
                let signs = [
                    ("=", "=="),
                    ("<>", "!="),
                    ("<", "<"),
                    ("<=", "<="),
                    (">", ">"),
                    (">=", ">="),
                ];
                let signs = if ty == BOOL { &signs[..2] } else { &signs[..] };
                let (st, c) = self.random.one_of(signs);
                pair(
                    format!("({} {st} {})", one.st, other.st),
                    format!("(({}) {c} ({}))", one.c, other.c),
                )
            }
        }
    }

    fn bits(&mut self, ty: Ty, depth: usize) -> Pair {
        let one = self.expression(ty, depth);
        match self.random.place(6) {
            0 => pair(format!("(NOT {})", one.st), ty.cut(&format!("~({})", one.c))),
            1 | 2 => {
                let by = self.random.one_of(&WHOLE[..7]);
                let count = self.expression(by, depth);
                let (st, c) = self.random.one_of(&[
                    ("SHL", "shifted_left"),
                    ("SHR", "shifted_right"),
                    ("ROL", "rotated_left"),
                ]);
                pair(
                    format!("{st}({}, {})", one.st, count.st),
                    ty.cut(&format!(
                        "{c}((uint64_t)({}), (int64_t)({}), {})",
                        one.c, count.c, ty.bits
                    )),
                )
            }
            _ => {
                let other = self.operand(ty, depth);
                let (st, c) = self
                    .random
                    .one_of(&[("AND", "&"), ("OR", "|"), ("XOR", "^"), ("&", "&")]);
                pair(
                    format!("({} {st} {})", one.st, other.st),
                    format!("(({}) {c} ({}))", one.c, other.c),
                )
            }
        }
    }

    fn whole(&mut self, ty: Ty, depth: usize) -> Pair {
        let one = self.expression(ty, depth);
        match self.random.place(8) {
            0 if ty.signed => pair(format!("(-{})", one.st), ty.cut(&format!("-({})", one.c))),
            1 => pair(
                format!("ABS({})", one.st),
                ty.cut(&format!("most({0}, -({0}))", one.c)),
            ),
            2 => {
                let other = self.expression(ty, depth);
                let (st, c) = self.random.one_of(&[("MIN", "least"), ("MAX", "most")]);
                pair(
                    format!("{st}({}, {})", one.st, other.st),
                    format!("{c}({}, {})", one.c, other.c),
                )
            }
            3 => {
                let (low, high) = (self.expression(ty, depth), self.expression(ty, depth));
                pair(
                    format!("LIMIT({}, {}, {})", low.st, one.st, high.st),
                    format!("least(most({}, {}), {})", one.c, low.c, high.c),
                )
            }
            4 | 5 => {
                let (st, c) = self.random.one_of(&[("/", "quotient"), ("MOD", "rest")]);
                let other = self.divisor(ty, depth);
                pair(
                    format!("({} {st} {})", one.st, other.st),
                    ty.cut(&format!("{c}({}, {})", one.c, other.c)),
                )
            }
            6 => {
                // Multiplication binds tighter; the rest goes from left to right.
                let [b, c, d] = [(); 3].map(|()| self.expression(ty, depth));
                let inner = ty.cut(&format!("product({}, {})", b.c, c.c));
                let sum = ty.cut(&format!("({}) - ({inner})", one.c));
                pair(
                    format!("({} - {} * {} + {})", one.st, b.st, c.st, d.st),
                    ty.cut(&format!("({sum}) + ({})", d.c)),
                )
            }
            _ => {
                let other = self.operand(ty, depth);
                let (st, c) = match self.random.place(3) {
                    0 => ("+", format!("({}) + ({})", one.c, other.c)),
                    1 => ("-", format!("({}) - ({})", one.c, other.c)),
                    _ => ("*", format!("product({}, {})", one.c, other.c)),
                };
                pair(format!("({} {st} {})", one.st, other.st), ty.cut(&c))
            }
        }
    }

    /// A whole number that is not 0.
    fn divisor(&mut self, ty: Ty, depth: usize) -> Pair {
        if self.random.place(2) == 0 {
            let value = self.expression(ty, depth);
            return pair(
                format!("MAX({}, {}#1)", value.st, ty.name),
                format!("most({}, 1)", value.c),
            );
        }
        if ty.signed && self.random.place(2) == 0 {
            let value = self.expression(ty, depth);
            return pair(
                format!("MIN({}, {}#-1)", value.st, ty.name),
                format!("least({}, -1)", value.c),
            );
        }
        loop {
            let value = self.literal(ty);
            if !value.st.ends_with("#0") {
                return value;
            }
        }
    }

    fn real(&mut self, ty: Ty, depth: usize) -> Pair {
        let one = self.expression(ty, depth);
        let single = if ty == REAL { "f" } else { "" };
        match self.random.place(9) {
            0 => pair(format!("(-{})", one.st), format!("(-({}))", one.c)),
            1 => {
                let (st, c) = self.random.one_of(&[
                    ("ABS", "fabs"),
                    ("SQRT", "sqrt"),
                    ("FLOOR", "floor"),
                    ("CEIL", "ceil"),
                    ("ROUND", "nearbyint"),
                ]);
                pair(format!("{st}({})", one.st), format!("{c}{single}({})", one.c))
            }
            2 => {
                let other = self.expression(ty, depth);
                let (st, c) = self.random.one_of(&[("MIN", "least_real"), ("MAX", "most_real")]);
                pair(
                    format!("{st}({}, {})", one.st, other.st),
                    format!("({}){c}({}, {})", ty.c(), one.c, other.c),
                )
            }
            3 => {
                let [b, c, d] = [(); 3].map(|()| self.expression(ty, depth));
                pair(
                    format!("({} - {} * {} + {})", one.st, b.st, c.st, d.st),
                    format!("((({}) - ({}) * ({})) + ({}))", one.c, b.c, c.c, d.c),
                )
            }
            _ => {
                let other = self.operand(ty, depth);
                let sign = self.random.one_of(&["+", "-", "*", "/"]);
                pair(
                    format!("({} {sign} {})", one.st, other.st),
                    format!("(({}) {sign} ({}))", one.c, other.c),
                )
            }
        }
    }

    fn time(&mut self, depth: usize) -> Pair {
        let one = self.expression(TIME, depth);
        match self.random.place(4) {
            0 => {
                let by = self.random.one_of(&WHOLE[..7]);
                let other = self.expression(by, depth);
                pair(
                    format!("({} * {})", one.st, other.st),
                    TIME.cut(&format!("product({}, {})", one.c, other.c)),
                )
            }
            1 => {
                let by = self.random.one_of(&WHOLE[..7]);
                let other = self.divisor(by, depth);
                pair(
                    format!("({} / {})", one.st, other.st),
                    TIME.cut(&format!("quotient({}, {})", one.c, other.c)),
                )
            }
            _ => {
                let other = self.expression(TIME, depth);
                let sign = self.random.one_of(&["+", "-"]);
                pair(
                    format!("({} {sign} {})", one.st, other.st),
                    TIME.cut(&format!("({}) {sign} ({})", one.c, other.c)),
                )
            }
        }
    }

    fn block(&mut self, depth: usize, most: usize) -> Pair {
        let mut block = pair("", "");
        for _ in 0..=self.random.place(most) {
            let one = self.statement(depth);
            block.st.push_str(&one.st);
            block.c.push_str(&one.c);
        }
        block
    }

    fn assignment(&mut self) -> Pair {
        let ty = self.random.one_of(&all());
        if ty.kind == Kind::Bits && self.random.place(3) == 0 {
            let target = self.variables.iter().find(|it| it.ty == ty).cloned();
            if let Some(target) = target {
                let bit = self.random.place(ty.bits as usize);
                let value = self.expression(BOOL, 2);
                let mask = format!("((wide)1 << {bit})");
                return pair(
                    format!("{}.{bit} := {};\n", target.name, value.st),
                    format!(
                        "{{ int b = {}; {1} = b ? ({1} | {mask}) : ({1} & ~{mask}); }}\n",
                        value.c, target.c
                    ),
                );
            }
        }
        let Some(target) = self.variable(ty, true) else {
            return pair(";\n", ";\n");
        };
        let value = self.operand(ty, 3);
        pair(
            format!("{} := {};\n", target.st, value.st),
            // In Structured Text the place is evaluated before the value.
            format!(
                "{{ {0} *to = &{1}; {0} value = {2}; *to = value; }}\n",
                ty.c(),
                target.c,
                value.c
            ),
        )
    }

    fn statement(&mut self, depth: usize) -> Pair {
        self.statements += 1;
        if depth == 0 || self.statements > 16 {
            return self.assignment();
        }
        let depth = depth - 1;
        match self.random.place(9) {
            0 | 1 => {
                let (first, second) = (self.expression(BOOL, 2), self.expression(BOOL, 2));
                let (one, two, three) = (self.block(depth, 2), self.block(depth, 2), self.block(depth, 2));
                pair(
                    format!(
                        "IF {} THEN\n{}ELSIF {} THEN\n{}ELSE\n{}END_IF;\n",
                        first.st, one.st, second.st, two.st, three.st
                    ),
                    format!(
                        "if ({}) {{\n{}}} else if ({}) {{\n{}}} else {{\n{}}}\n",
                        first.c, one.c, second.c, two.c, three.c
                    ),
                )
            }
            2 => self.case(depth),
            3 => self.for_(depth),
            4 => self.while_(depth),
            5 if self.loops > 0 => {
                let when = self.expression(BOOL, 1);
                let (st, c) = self.random.one_of(&[("EXIT", "break"), ("CONTINUE", "continue")]);
                pair(
                    format!("IF {} THEN {st}; END_IF;\n", when.st),
                    format!("if ({}) {c};\n", when.c),
                )
            }
            6 if self.random.place(4) == 0 => {
                let when = self.expression(BOOL, 1);
                pair(
                    format!("IF {} THEN RETURN; END_IF;\n", when.st),
                    format!("if ({}) return;\n", when.c),
                )
            }
            _ => self.assignment(),
        }
    }

    fn case(&mut self, depth: usize) -> Pair {
        let ty = self.random.one_of(&WHOLE);
        let selector = self.expression(ty, 2);
        let (a, b, c) = (self.block(depth, 2), self.block(depth, 2), self.block(depth, 2));
        let far = self.random.place(100) + 20;
        // `s` has the same value in all comparisons.
        pair(
            format!(
                "CASE {} OF\n1, 3:\n{}5..9, {far}:\n{}ELSE\n{}END_CASE;\n",
                selector.st, a.st, b.st, c.st
            ),
            format!(
                "{{ wide s = {}; if (s == 1 || s == 3) {{\n{}}} else if ((s >= 5 && s <= 9) || s == {far}) {{\n{}}} else {{\n{}}} }}\n",
                selector.c, a.c, b.c, c.c
            ),
        )
    }

    fn for_(&mut self, depth: usize) -> Pair {
        let ty = self.random.one_of(&WHOLE);
        let Some(control) = self
            .variables
            .iter()
            .find(|it| it.ty == ty && !self.locked.contains(&it.name))
            .cloned()
        else {
            return self.assignment();
        };
        let step = self.random.one_of(&[1_i128, 1, 2, 3, -1, -2]);
        let count = self.random.place(5) as i128;
        // Often at an end of the type.
        let from = match (self.random.place(3), step > 0) {
            (0, true) => ty.high() - self.random.place(6) as i128,
            (0, false) => ty.low() + self.random.place(6) as i128,
            _ => 10,
        };
        let to = (from + count * step).clamp(ty.low(), ty.high());
        self.locked.push(control.name.clone());
        self.loops += 1;
        let body = self.block(depth, 2);
        self.loops -= 1;
        self.locked.pop();
        let c = |number: i128| {
            let sign = if number < 0 { "-" } else { "" };
            format!("({sign}(wide){}ULL)", number.unsigned_abs())
        };
        self.labels += 1;
        let n = self.labels;
        // `continue` leads to the step, and `break` past it.
        pair(
            format!(
                "FOR {} := {}#{from} TO {}#{to} BY {step} DO\n{}END_FOR;\n",
                control.name, ty.name, ty.name, body.st
            ),
            format!(
                "{{ {0} = {1}; wide k{n} = {1};\nfor (; {2}; ({{ k{n} += {3}; if (k{n} >= {4} && k{n} <= {5}) {0} = k{n}; }})) {{\n{6}}} }}\n",
                control.c,
                c(from),
                if step > 0 {
                    format!("k{n} <= {}", c(to))
                } else {
                    format!("k{n} >= {}", c(to))
                },
                c(step),
                c(ty.low()),
                c(ty.high()),
                body.c
            ),
        )
    }

    fn while_(&mut self, depth: usize) -> Pair {
        self.labels += 1;
        let n = self.labels;
        let name = format!("w{n}");
        let ty = WHOLE[1];
        let c = format!("v->{name}");
        self.variables.push(Variable {
            name: name.clone(),
            ty,
            c: c.clone(),
        });
        self.locked.push(name.clone());
        let condition = self.expression(BOOL, 1);
        let most = self.random.place(5);
        self.loops += 1;
        let body = self.block(depth, 2);
        self.loops -= 1;
        // It stays locked, so that it counts to the end.
        if self.random.place(2) == 0 {
            pair(
                format!(
                    "{name} := 0;\nWHILE {name} < {most} AND {} DO\n{name} := {name} + 1;\n{}END_WHILE;\n",
                    condition.st, body.st
                ),
                format!(
                    "{c} = 0;\nwhile ({c} < {most} && ({})) {{\n{c} = {c} + 1;\n{}}}\n",
                    condition.c, body.c
                ),
            )
        } else {
            pair(
                format!(
                    "{name} := 0;\nREPEAT\n{name} := {name} + 1;\n{}UNTIL {name} > {most} OR {}\nEND_REPEAT;\n",
                    body.st, condition.st
                ),
                format!(
                    "{c} = 0;\ndo {{\n{c} = {c} + 1;\n{}}} while (!({c} > {most} || ({})));\n",
                    body.c, condition.c
                ),
            )
        }
    }
}

/// One program: a function block, and a structure with a function in C.
pub fn generate(random: &mut Random, number: usize) -> Generated {
    let elements = random.one_of(&all());
    let mut generator = Generator {
        random,
        number,
        variables: Vec::new(),
        locked: Vec::new(),
        elements,
        statements: 0,
        labels: 0,
        loops: 0,
    };
    let mut first = Vec::new();
    for (place, ty) in all().into_iter().enumerate() {
        let name = format!("x{place}");
        let c = format!("v->{name}");
        first.push(generator.literal(ty));
        generator.variables.push(Variable { name, ty, c });
    }
    let mut body = pair("", "");
    for _ in 0..3 + generator.random.place(5) {
        let one = generator.statement(3);
        body.st.push_str(&one.st);
        body.c.push_str(&one.c);
    }
    let n = generator.number;
    let size = 2 * INDEX_MOST + 1;
    let (mut st, mut c) = (
        format!("FUNCTION_BLOCK B{n}\nVAR\n"),
        String::from("static struct {\n"),
    );
    for (place, it) in generator.variables.iter().enumerate() {
        let initial = first.get(place).map_or("0", |it| it.st.as_str());
        writeln!(st, "{} : {} := {initial};", it.name, it.ty.name).unwrap();
        writeln!(c, "{} {};", it.ty.c(), it.name).unwrap();
    }
    writeln!(
        st,
        "arr : ARRAY [-{INDEX_MOST}..{INDEX_MOST}] OF {};\nEND_VAR",
        elements.name
    )
    .unwrap();
    writeln!(c, "{} arr[{size}];\n}} s{n};", elements.c()).unwrap();
    writeln!(c, "static void begin{n}(void) {{ __typeof__(s{n}) *v = &s{n};").unwrap();
    for (place, literal) in first.iter().enumerate() {
        writeln!(c, "v->x{place} = {};", literal.c).unwrap();
    }
    writeln!(
        c,
        "}}\nstatic void run{n}(void) {{ __typeof__(s{n}) *v = &s{n};\n{}}}",
        body.c
    )
    .unwrap();
    let mut variables = generator.variables;
    variables.extend((0..size).map(|place| Variable {
        name: format!("arr[{}]", place - INDEX_MOST),
        ty: elements,
        c: format!("v->arr[{place}]"),
    }));
    writeln!(c, "static void show{n}(void) {{ __typeof__(s{n}) *v = &s{n};").unwrap();
    for it in &variables {
        match (it.ty.kind, it.ty.bits) {
            (Kind::Real, 32) => writeln!(c, "show_real({});", it.c).unwrap(),
            (Kind::Real, _) => writeln!(c, "show_lreal({});", it.c).unwrap(),
            (_, bits) => writeln!(c, "show({}, {bits});", it.c).unwrap(),
        }
    }
    writeln!(c, "puts(\"\"); }}").unwrap();
    Generated {
        st: format!("{st}{}END_FUNCTION_BLOCK\n", body.st),
        c,
        variables,
    }
}
