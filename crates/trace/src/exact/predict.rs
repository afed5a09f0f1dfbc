//! Predictions of smooth signals, and distances from them.

use super::bytes::len_signed;
use crate::column::canonical_bits;

/// Coefficients of the extrapolations of order 0 to 6, last value first: a polynomial through as many
/// values as the order, continued by one step (the binomials with alternating signs).
const EXTRAPOLATIONS: [&[f64]; EXTRAPOLATION_ORDERS] = [
    &[],
    &[1.0],
    &[2.0, -1.0],
    &[3.0, -3.0, 1.0],
    &[4.0, -6.0, 4.0, -1.0],
    &[5.0, -10.0, 10.0, -5.0, 1.0],
    &[6.0, -15.0, 20.0, -15.0, 6.0, -1.0],
];

/// Orders of extrapolation: 0 to 6.
pub const EXTRAPOLATION_ORDERS: usize = 7;

/// Largest number of scans by which a column may repeat an earlier one (feedback of an ideal drive).
const LAG_MAX: usize = 3;

/// The prediction of a column of reals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Predictor {
    /// By the polynomial through some of its own last values.
    Extrapolation(usize),
    /// By the column of reals of this number, `lag` scans ago.
    Copy { from: usize, lag: usize },
}

impl Predictor {
    /// The next value of a column that has the values `own` so far; `earlier` are the columns of reals
    /// before it.
    fn predict(self, own: &[f64], earlier: &[Vec<f64>]) -> f64 {
        let prediction = match self {
            Self::Extrapolation(order) => {
                let coefficients = EXTRAPOLATIONS
                    .get(order.min(own.len()))
                    .copied()
                    .unwrap_or_default();
                let terms = own.iter().rev().zip(coefficients);
                terms.fold(0.0, |sum, (value, coefficient)| sum + value * coefficient)
            }
            Self::Copy { from, lag } => {
                let scan = own.len().checked_sub(lag);
                scan.and_then(|scan| earlier.get(from)?.get(scan))
                    .copied()
                    .unwrap_or(0.0)
            }
        };
        // An overflow is useless, and the NaN that it gives differs between processors.
        if prediction.is_finite() {
            prediction
        } else {
            own.last().copied().unwrap_or(0.0)
        }
    }

    /// The distance of the value from its prediction, in representable numbers.
    pub fn distance(self, own: &[f64], earlier: &[Vec<f64>], value: f64) -> i64 {
        ordered(value).wrapping_sub(ordered(self.predict(own, earlier)))
    }

    /// The value at this distance from its prediction.
    pub fn at_distance(self, own: &[f64], earlier: &[Vec<f64>], distance: i64) -> f64 {
        from_ordered(ordered(self.predict(own, earlier)).wrapping_add(distance))
    }

    /// The bytes a column takes under this predictor, or `None` as soon as they reach `bound`.
    fn cost(self, values: &[f64], earlier: &[Vec<f64>], bound: usize) -> Option<usize> {
        let mut cost = 0;
        for (scan, value) in values.iter().enumerate() {
            cost += len_signed(self.distance(values.get(..scan)?, earlier, *value));
            if cost >= bound {
                return None;
            }
        }
        Some(cost)
    }
}

/// The search ends when a predictor is within this many bytes of the least that any predictor can need: a constant
/// column costs its first value.
const BYTES_SPARE: usize = 10;

/// The predictor with which a column takes the fewest bytes, or nearly the least possible. All are tried one after
/// the other; of equal ones the first is taken.
pub fn cheapest(values: &[f64], earlier: &[Vec<f64>]) -> Predictor {
    let extrapolations = (0..EXTRAPOLATION_ORDERS).map(Predictor::Extrapolation);
    let copies =
        (0..earlier.len()).flat_map(|from| (0..=LAG_MAX).map(move |lag| Predictor::Copy { from, lag }));
    let mut best = Predictor::Extrapolation(0);
    let mut bound = usize::MAX;
    for candidate in extrapolations.chain(copies) {
        if let Some(cost) = candidate.cost(values, earlier, bound) {
            (best, bound) = (candidate, cost);
            if cost <= values.len() + BYTES_SPARE {
                break;
            }
        }
    }
    best
}

/// Floats as integers in the same order, neighbours one apart.
pub fn ordered(value: f64) -> i64 {
    let bits = canonical_bits(value).cast_signed();
    if bits < 0 {
        i64::MIN.wrapping_sub(bits)
    } else {
        bits
    }
}

fn from_ordered(order: i64) -> f64 {
    let bits = if order < 0 {
        i64::MIN.wrapping_sub(order)
    } else {
        order
    };
    f64::from_bits(bits.cast_unsigned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_order_of_floats_is_the_order_of_their_integers() {
        let rising = [
            f64::NEG_INFINITY,
            f64::MIN,
            -1.0,
            -5e-324,
            0.0,
            5e-324,
            1.0,
            f64::MAX,
            f64::INFINITY,
        ];
        for pair in rising.windows(2) {
            assert!(ordered(pair[0]) < ordered(pair[1]), "{pair:?}");
        }
        for value in rising {
            assert_eq!(from_ordered(ordered(value)).to_bits(), value.to_bits());
        }
        assert_eq!(ordered(5e-324) - ordered(-5e-324), 2);
        assert_eq!(ordered(-0.0), 0);
    }

    #[test]
    fn polynomials_are_extrapolated() {
        let cubic: Vec<f64> = (0..8).map(|x| f64::from(x * x * x - 4 * x)).collect();
        for order in 4..=6 {
            assert_eq!(
                Predictor::Extrapolation(order).predict(&cubic[..7], &[]),
                cubic[7],
                "order {order}"
            );
        }
        assert_eq!(Predictor::Extrapolation(6).predict(&[], &[]), 0.0);
        assert_eq!(
            Predictor::Extrapolation(2).predict(&[f64::MAX, -f64::MAX], &[]),
            -f64::MAX
        );
    }

    #[test]
    fn feedback_is_found_to_repeat_the_set_point() {
        let set_point: Vec<f64> = (0..50).map(|x| f64::from(x * x % 17)).collect();
        let feedback = [&[0.0, 0.0], &set_point[..48]].concat();
        assert_eq!(
            cheapest(&feedback, &[set_point]),
            Predictor::Copy { from: 0, lag: 2 }
        );
        assert_eq!(cheapest(&[1.5; 50], &[]), Predictor::Extrapolation(1));
    }
}
