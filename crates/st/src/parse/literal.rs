//! Numbers and durations.

use super::Parser;
use crate::error::{Code, Diagnostic, quoted};
use crate::lex::{Token, Word};
use crate::source::Span;
use crate::syntax::{Expression, ExpressionKind as Kind, Ident};
use crate::types::TEXT_MOST;

const UNITS: [(&str, i128); 7] = [
    ("d", 86_400_000_000_000),
    ("h", 3_600_000_000_000),
    ("m", 60_000_000_000),
    ("s", 1_000_000_000),
    ("ms", 1_000_000),
    ("us", 1000),
    ("ns", 1),
];

impl Parser<'_> {
    fn bad_literal(&mut self, span: Span, why: String, help: &str) -> Kind {
        self.tell(Diagnostic::error(Code::BadLiteral, span, why).help(help));
        Kind::Wrong
    }

    /// `123` or `16#FF`.
    pub(super) fn integer(&mut self) -> Kind {
        let span = self.span();
        let text: String = self.text_of(span).chars().filter(|c| *c != '_').collect();
        let (base, digits) = text.split_once('#').unwrap_or(("10", &text));
        let radix = match base {
            "2" => 2,
            "8" => 8,
            "10" => 10,
            "16" => 16,
            _ => {
                let why = format!("{} has the base {base}", quoted(&text));
                let kind = self.bad_literal(span, why, "bases are 2, 8 and 16: 2#1010, 8#17, 16#FF");
                self.next();
                return kind;
            }
        };
        let kind = if digits.is_empty() || !digits.chars().all(|digit| digit.is_digit(radix)) {
            let why = format!("{} is no number of base {base}", quoted(&text));
            self.bad_literal(span, why, "bases are 2, 8 and 16: 2#1010, 8#17, 16#FF")
        } else {
            match u64::from_str_radix(digits, radix) {
                Ok(value) => Kind::Integer(value.into()),
                Err(_) => {
                    let why = format!("{} is larger than any integer type holds", quoted(&text));
                    self.bad_literal(span, why, "the largest is that of ULINT, 18446744073709551615")
                }
            }
        };
        self.next();
        kind
    }

    pub(super) fn real(&mut self) -> Kind {
        let span = self.span();
        let text: String = self.text_of(span).chars().filter(|c| *c != '_').collect();
        let value: Option<f64> = text.parse().ok();
        let kind = match value.filter(|value| value.is_finite()) {
            Some(value) => Kind::Real(value),
            None => {
                let why = format!("{} is no number that LREAL holds", quoted(&text));
                self.bad_literal(span, why, "the largest is about 1.79E308")
            }
        };
        self.next();
        kind
    }

    pub(super) fn duration(&mut self) -> Kind {
        let span = self.span();
        let text = self.text_of(span).to_owned();
        let (prefix, rest) = text.split_once('#').unwrap_or(("T", &text));
        let long = prefix.starts_with(['l', 'L']);
        let kind = match nanoseconds(rest) {
            Ok(ns) => Kind::Duration(ns, long),
            Err(why) => {
                let why = format!("{} is no duration: {why}", quoted(&text));
                self.bad_literal(
                    span,
                    why,
                    "write numbers with d, h, m, s, ms, us, ns in this order: T#1m30s, T#2.5ms",
                )
            }
        };
        self.next();
        kind
    }

    /// The text after `INT#` or `E#`.
    pub(super) fn typed(&mut self) -> Kind {
        let prefix = self.next();
        let text = self.text_of(prefix).trim_end_matches('#').to_owned();
        let ty = Ident { text, span: prefix };
        let upper = ty.key();
        if matches!(
            upper.as_str(),
            "D" | "DATE" | "LDATE" | "LD" | "TOD" | "TIME_OF_DAY" | "LTOD" | "DT" | "DATE_AND_TIME" | "LDT"
        ) {
            self.unsupported(
                prefix,
                "a date or a time of day",
                "use TIME, which counts from the start of the run: TIME()",
            );
            self.skip_date();
            return Kind::Wrong;
        }
        if self.span().start != prefix.end {
            let why = format!("a literal must follow `{upper}#` without a space");
            return self.bad_literal(prefix, why, "write it in one: INT#5, WORD#16#FF, E#element");
        }
        let from = self.span();
        let negative = self.take(Token::Minus);
        if !negative {
            self.take(Token::Plus);
        }
        let kind = match self.token() {
            Token::Integer | Token::Based => self.integer(),
            Token::Real => self.real(),
            Token::Word(Word::True) => self.boolean(true),
            Token::Word(Word::False) => self.boolean(false),
            Token::Name if !negative => {
                return Kind::Element(ty, self.next_ident());
            }
            Token::Text if !negative => self.text(),
            Token::WideText => {
                let span = self.next();
                self.unsupported(span, "WSTRING", super::expression::STRINGS);
                return Kind::Wrong;
            }
            _ => {
                let why = format!("a literal must follow `{upper}#`, not {}", self.shown());
                return self.bad_literal(prefix, why, "write it in one: INT#5, WORD#16#FF, E#element");
            }
        };
        let span = from.to(self.before());
        let kind = match kind {
            Kind::Integer(value) if negative => Kind::Integer(-value),
            Kind::Real(value) if negative => Kind::Real(-value),
            other => other,
        };
        Kind::Typed(ty, Box::new(Expression { kind, span }))
    }

    /// `'it$'s'`
    pub(super) fn text(&mut self) -> Kind {
        let span = self.next();
        let inner = self.text_of(span).get(1..).unwrap_or_default();
        let inner = inner.strip_suffix('\'').unwrap_or(inner);
        match unescaped(inner) {
            Ok(bytes) if bytes.len() <= usize::from(TEXT_MOST) => Kind::Text(bytes),
            Ok(bytes) => {
                let why = format!("a string has at most {TEXT_MOST} bytes, not {}", bytes.len());
                self.bad_literal(span, why, "put it together with CONCAT where it is used")
            }
            Err(sign) => {
                let why = format!("{} is no character", quoted(&sign));
                let help = "write $$, $', $L, $N, $P, $R, $T, or a byte in two digits of base 16: $0A";
                self.bad_literal(span, why, help)
            }
        }
    }

    pub(super) fn boolean(&mut self, value: bool) -> Kind {
        self.next();
        Kind::Bool(value)
    }

    /// `2024-01-01-12:30:15.5`, without a space after the last token.
    fn skip_date(&mut self) {
        while matches!(
            self.token(),
            Token::Integer | Token::Real | Token::Minus | Token::Colon
        ) && self.span().start == self.before().end
        {
            self.next();
        }
    }
}

/// The bytes of a string as it is written, or the escape that is none.
fn unescaped(text: &str) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    let mut rest = text;
    while let Some((plain, behind)) = rest.split_once('$') {
        bytes.extend(plain.as_bytes());
        let digits = behind
            .get(..2)
            .filter(|it| it.bytes().all(|it| it.is_ascii_hexdigit()));
        if let Some(digits) = digits {
            bytes.extend(u8::from_str_radix(digits, 16));
            rest = behind.get(2..).unwrap_or_default();
            continue;
        }
        let sign = behind.chars().next().unwrap_or(' ');
        bytes.push(match sign.to_ascii_uppercase() {
            '$' | '\'' => sign as u8,
            'L' | 'N' => b'\n',
            'P' => 0x0C,
            'R' => b'\r',
            'T' => b'\t',
            _ => return Err(format!("${sign}")),
        });
        rest = behind.get(1..).unwrap_or_default();
    }
    bytes.extend(rest.as_bytes());
    Ok(bytes)
}

/// A duration behind its `#`.
fn nanoseconds(text: &str) -> Result<i64, String> {
    let text: String = text.chars().filter(|c| *c != '_').collect();
    let (negative, mut rest) = match text.strip_prefix('-') {
        Some(rest) => (true, rest),
        None => (false, text.strip_prefix('+').unwrap_or(&text)),
    };
    if rest.is_empty() {
        return Err("it has no number".to_owned());
    }
    let mut total = 0_i128;
    let mut least = 0;
    while !rest.is_empty() {
        let end = rest
            .find(|c: char| !c.is_ascii_digit() && c != '.')
            .unwrap_or(rest.len());
        let (number, behind) = rest.split_at(end);
        if number.is_empty() {
            return Err(format!("a number is missing before `{behind}`"));
        }
        let end = behind
            .find(|c: char| !c.is_ascii_alphabetic())
            .unwrap_or(behind.len());
        let (unit, behind) = behind.split_at(end);
        if unit.is_empty() {
            return Err(format!("a unit is missing behind `{number}`"));
        }
        let place = UNITS.iter().position(|(name, _)| name.eq_ignore_ascii_case(unit));
        let place = place.ok_or_else(|| format!("`{unit}` is no unit"))?;
        if place < least {
            return Err(format!("`{unit}` stands behind a smaller unit, or twice"));
        }
        least = place + 1;
        let (whole, fraction) = number.split_once('.').unwrap_or((number, ""));
        if !fraction.is_empty() && !behind.is_empty() {
            return Err("only the last part may have a fraction".to_owned());
        }
        total += part(whole, fraction, UNITS[place].1)
            .ok_or_else(|| format!("`{number}` is no number that fits"))?;
        rest = behind;
    }
    let total = if negative { -total } else { total };
    i64::try_from(total).map_err(|_| "64 bits of nanoseconds, 292 years, are the most".to_owned())
}

/// A number with a fraction times its unit, rounded to the nearest whole.
fn part(whole: &str, fraction: &str, unit: i128) -> Option<i128> {
    // More digits of a fraction are smaller than a nanosecond.
    const DIGITS: usize = 20;
    let digits = fraction.get(..fraction.len().min(DIGITS))?;
    let whole: u64 = whole.parse().ok()?;
    let scale = 10_i128.pow(digits.len() as u32);
    let digits: i128 = if digits.is_empty() {
        0
    } else {
        digits.parse().ok()?
    };
    let rounded = (digits.checked_mul(unit)? * 2 + scale) / (2 * scale);
    i128::from(whole).checked_mul(unit)?.checked_add(rounded)
}

#[cfg(test)]
mod tests {
    use super::nanoseconds;

    /// Covers: ST3
    #[test]
    fn durations_add_up_their_parts() {
        for (text, ns) in [
            ("1d2h3m4s5ms6us7ns", 93_784_005_006_007),
            ("90m", 5_400_000_000_000),
            ("1_0.5s", 10_500_000_000),
            ("-250us", -250_000),
            ("0s", 0),
            ("1.0000000015s", 1_000_000_002),
        ] {
            assert_eq!(nanoseconds(text), Ok(ns), "{text}");
        }
        for text in [
            "",
            "-",
            "5",
            "5x",
            "1s2h",
            "1s1s",
            "1.5m3s",
            "1..5s",
            "99999999999d",
            ".s",
        ] {
            assert!(nanoseconds(text).is_err(), "{text}");
        }
    }

    #[test]
    fn what_is_wrong_with_a_duration_is_told_as_it_is_written() {
        for (text, why) in [
            ("5", "a unit is missing behind `5`"),
            ("1s2", "a unit is missing behind `2`"),
            ("1m2Q", "`Q` is no unit"),
            ("S", "a number is missing before `S`"),
            ("--1s", "a number is missing before `-1s`"),
            ("1s1S", "`S` stands behind a smaller unit, or twice"),
        ] {
            assert_eq!(nanoseconds(text), Err(why.to_owned()));
        }
    }
}
