//! The exponential of a small matrix, with multiplications and additions only.

/// Size of the matrices: three states, the distance, and the input.
pub(super) const SIZE: usize = 5;

pub(super) type Matrix = [[f64; SIZE]; SIZE];

const IDENTITY: Matrix = {
    let mut matrix = [[0.0; SIZE]; SIZE];
    let mut index = 0;
    while index < SIZE {
        matrix[index][index] = 1.0;
        index += 1;
    }
    matrix
};

/// Terms of the series. For a norm of one half, further terms do not change a 64-bit result.
const TERMS: u32 = 20;

/// The largest number of halvings; larger matrices are refused.
const HALVINGS: u32 = 30;

/// exp(`matrix`), or `None` if it is not finite or its norm is above 2^29. Cost: at most 50 products.
pub(super) fn exponential(matrix: &Matrix) -> Option<Matrix> {
    let norm = matrix
        .iter()
        .map(|row| row.iter().map(|value| value.abs()).sum::<f64>())
        .fold(0.0, f64::max);
    let (mut scale, mut halvings) = (1.0, 0);
    while norm * scale > 0.5 {
        if halvings >= HALVINGS {
            return None;
        }
        scale *= 0.5;
        halvings += 1;
    }
    let scaled = matrix.map(|row| row.map(|value| value * scale));
    // Horner's scheme of the series.
    let mut result = IDENTITY;
    for term in (1..=TERMS).rev() {
        result = product(&scaled, &result).map(|row| row.map(|value| value / f64::from(term)));
        for (row, unit) in result.iter_mut().zip(&IDENTITY) {
            for (value, one) in row.iter_mut().zip(unit) {
                *value += one;
            }
        }
    }
    for _ in 0..halvings {
        result = product(&result, &result);
    }
    result
        .iter()
        .flatten()
        .all(|value| value.is_finite())
        .then_some(result)
}

fn product(one: &Matrix, other: &Matrix) -> Matrix {
    one.map(|row| {
        let mut sums = [0.0; SIZE];
        for (factor, line) in row.iter().zip(other) {
            for (sum, value) in sums.iter_mut().zip(line) {
                *sum += factor * value;
            }
        }
        sums
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_exponentials_are_met() {
        let mut matrix = [[0.0; SIZE]; SIZE];
        // A rotation, a decay, and a nilpotent pair.
        (matrix[0][1], matrix[1][0]) = (-3.0, 3.0);
        matrix[2][2] = -7.5;
        matrix[3][4] = 2.0;
        let found = exponential(&matrix).expect("finite");
        let (sine, cosine, decay) = (0.1411200080598672, -0.9899924966004454, 0.0005530843701478336);
        let expected = [
            [cosine, -sine, 0.0, 0.0, 0.0],
            [sine, cosine, 0.0, 0.0, 0.0],
            [0.0, 0.0, decay, 0.0, 0.0],
            [0.0, 0.0, 0.0, 1.0, 2.0],
            [0.0, 0.0, 0.0, 0.0, 1.0],
        ];
        for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
            assert!((found - expected).abs() <= 1e-13, "{found} {expected}");
        }
        matrix[0][0] = f64::NAN;
        assert_eq!(exponential(&matrix), None);
        matrix[0][0] = 1e12;
        assert_eq!(exponential(&matrix), None);
    }
}
