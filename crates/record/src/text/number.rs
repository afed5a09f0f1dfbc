//! Numbers as traces write them, without a heap and without a reachable panic.

use core::fmt::{self, Display, Write};

/// Room for the significant digits of a number: the longest text of `ryu` has 24 bytes.
const DIGITS: usize = 24;

/// A number as the shortest text that reads back as the same one, as `standstill_trace::shortest` gives it: NaN and
/// infinities as words, -0.0 as `0.0`.
pub struct Real(pub f64);

impl Display for Real {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(value) = *self;
        if value.is_nan() {
            return out.write_str("NaN");
        }
        if value.is_infinite() {
            return out.write_str(if value > 0.0 { "Infinity" } else { "-Infinity" });
        }
        if value == 0.0 {
            return out.write_str("0.0");
        }
        if value < 0.0 {
            out.write_str("-")?;
        }
        let mut buffer = ryu::Buffer::new();
        let mut digits = Digits::of(buffer.format_finite(value.abs()));
        digits.round_up(value.abs());
        // From here on as `{:?}` does: powers of ten where plain digits would be long.
        match digits.exponent {
            exponent @ (-4..16) => digits.plain(out, exponent),
            exponent => {
                digits.put(out, 0, 1)?;
                if digits.count > 1 {
                    out.write_str(".")?;
                    digits.put(out, 1, digits.count)?;
                }
                write!(out, "e{exponent}")
            }
        }
    }
}

fn put(out: &mut impl Write, digits: &[u8]) -> fmt::Result {
    out.write_str(core::str::from_utf8(digits).unwrap_or_default())
}

/// The significant digits of a number above 0, and the power of ten of the first. The first and the last
/// digit are not 0.
struct Digits {
    digits: [u8; DIGITS],
    count: usize,
    exponent: i32,
}

impl Digits {
    /// From a text like `120.0`, `0.0012` or `1.2e-7`.
    fn of(text: &str) -> Self {
        let mut all = Self {
            digits: [b'0'; DIGITS],
            count: 0,
            exponent: -1,
        };
        let (mut past_point, mut power, mut sign, mut in_power) = (false, 0, 1, false);
        for byte in text.bytes() {
            match byte {
                b'.' => past_point = true,
                b'e' => in_power = true,
                b'-' => sign = -1,
                b'0'..=b'9' if in_power => power = power * 10 + i32::from(byte - b'0'),
                b'0' if all.count == 0 && !past_point => {}
                b'0' if all.count == 0 => all.exponent -= 1,
                b'0'..=b'9' => {
                    if all.count == 0 && !past_point {
                        all.exponent = 0;
                    } else if !past_point {
                        all.exponent += 1;
                    }
                    if let Some(digit) = all.digits.get_mut(all.count) {
                        *digit = byte;
                        all.count += 1;
                    }
                }
                _ => {}
            }
        }
        let written = all.digits.get(..all.count).unwrap_or_default();
        let zeros = written.iter().rev().take_while(|digit| **digit == b'0').count();
        all.count -= zeros;
        all.exponent += sign * power;
        all
    }

    /// If the number is exactly between two texts of this length, `ryu` takes the even one and `{:?}` the
    /// larger one. This takes the larger one, too.
    fn round_up(&mut self, value: f64) {
        let Some(last) = self
            .count
            .checked_sub(1)
            .and_then(|last| self.digits.get_mut(last))
        else {
            return;
        };
        if *last % 2 == 1 {
            return;
        }
        // The number is odd * 2^two, because it is above 0 and not infinite.
        let bits = value.to_bits();
        let (fraction, biased) = (bits & ((1 << 52) - 1), (bits >> 52) as i32);
        let (whole, two) = if biased == 0 {
            (fraction, -1074)
        } else {
            (fraction | 1 << 52, biased - 1075)
        };
        let odd = whole >> whole.trailing_zeros().min(63);
        let two = two + whole.trailing_zeros() as i32;
        // An exact middle equals (2 * digits + 1) * 10^ten / 2, where `ten` is the place of the last
        // digit.
        let ten = self.exponent + 1 - self.count as i32;
        *last += 1;
        let mut wanted = 0_u64;
        for digit in self.digits.iter().take(self.count) {
            // 17 digits: it fits.
            wanted = wanted.wrapping_mul(10).wrapping_add(u64::from(digit - b'0'));
        }
        let wanted = wanted.wrapping_mul(2).wrapping_sub(1);
        let fives = 5_u64.checked_pow(ten.unsigned_abs());
        let is_middle = two + 1 == ten
            && fives.is_some_and(|fives| {
                if ten < 0 {
                    odd.checked_mul(fives) == Some(wanted)
                } else {
                    wanted.checked_mul(fives) == Some(odd)
                }
            });
        if !is_middle && let Some(last) = self.digits.get_mut(self.count.wrapping_sub(1)) {
            *last -= 1;
        }
    }

    /// The digits from one place to before another; zeros behind the last digit.
    fn put(&self, out: &mut impl Write, from: usize, to: usize) -> fmt::Result {
        let there = to.min(self.count);
        put(out, self.digits.get(from..there).unwrap_or_default())?;
        for _ in from.max(there)..to {
            out.write_str("0")?;
        }
        Ok(())
    }

    /// Without a power of ten in the text; `ten` is at most 15.
    fn plain(&self, out: &mut impl Write, exponent: i32) -> fmt::Result {
        let Ok(exponent) = usize::try_from(exponent) else {
            out.write_str("0.")?;
            for _ in exponent..-1 {
                out.write_str("0")?;
            }
            return self.put(out, 0, self.count);
        };
        self.put(out, 0, exponent + 1)?;
        out.write_str(".")?;
        self.put(out, exponent + 1, self.count.max(exponent + 2))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::format;
    use std::string::{String, ToString};

    fn text(value: f64) -> String {
        Real(value).to_string()
    }

    /// The reference is `standstill_trace::shortest`, which prints with `{:?}`.
    #[test]
    fn numbers_are_those_of_traces() {
        for value in [
            0.0,
            -0.0,
            1.0,
            -1.0,
            0.1,
            1e15,
            1e16,
            123_456_789_012_345_680.0,
            9_999_999_999_999_998.0,
            1e-4,
            1.5e-4,
            9.9e-5,
            1e-5,
            5e-324,
            f64::MAX,
            f64::MIN_POSITIVE,
            -1.0 / 3.0,
            100.0,
            1200.0,
            0.001,
            12.5,
            1e21,
            1e-7,
        ] {
            assert_eq!(text(value), format!("{:?}", value + 0.0));
        }
        assert_eq!([text(f64::NAN), text(f64::NEG_INFINITY)], ["NaN", "-Infinity"]);
        // Random bits, and numbers of everyday sizes.
        let mut random = standstill_testkit::Random(1);
        for round in 0..200_000 {
            let bits = random.bits();
            let everyday = (bits >> 40) as f64 / 1000.0 - 5000.0;
            // Numbers with short binary fractions lie exactly between two texts more often.
            let dyadic = (bits >> (12 + round % 50)) as f64 / (1_u64 << (round % 53)) as f64;
            for value in [f64::from_bits(bits), everyday, everyday * everyday, dyadic] {
                if value.is_finite() {
                    assert_eq!(text(value), format!("{:?}", value + 0.0));
                }
            }
        }
    }
}
