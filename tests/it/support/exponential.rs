//! exp(tG) in the plane to far more digits than f64 has: slow and obviously right.

use dashu_int::IBig;
use glam::{DAffine2, DMat2, DVec2};
use steadysweep::motion::planar::Generator;

/// Binary places after the point: entries of up to 2^100 keep over 60 decimal digits through 20
/// squarings.
const PLACES: usize = 400;

/// A 3 x 3 matrix of integers over 2^PLACES.
type Matrix = [[IBig; 3]; 3];

/// exp(tG), rounded once: the Taylor sum of tG / 2^k, squared k times.
pub(crate) fn exponential(generator: &Generator, t: f64) -> DAffine2 {
    let rows = generator.rows();
    let rows = [rows[0], rows[1], [0.0; 3]];
    let largest = rows.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs())) * t.abs();
    let halvings = (0..)
        .take_while(|&k| largest * 0.5_f64.powi(k) > 0.01)
        .count();
    let matrix = map(&rows, |&entry| {
        (fixed(entry) * fixed(t)) >> (PLACES + halvings)
    });
    let mut sum = map(&rows, |_| IBig::from(0));
    for (i, row) in sum.iter_mut().enumerate() {
        row[i] = IBig::from(1) << PLACES;
    }
    let mut power = sum.clone();
    for k in 1..45 {
        power = map(&product(&power, &matrix), |entry| entry / k);
        sum = std::array::from_fn(|i| std::array::from_fn(|j| &sum[i][j] + &power[i][j]));
    }
    for _ in 0..halvings {
        sum = product(&sum, &sum);
    }
    let column = |j: usize| DVec2::new(float(&sum[0][j]), float(&sum[1][j]));
    DAffine2 {
        matrix2: DMat2::from_cols(column(0), column(1)),
        translation: column(2),
    }
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let terms = (0..3).map(|k| &a[i][k] * &b[k][j]);
            terms.sum::<IBig>() >> PLACES
        })
    })
}

fn map<T>(matrix: &[[T; 3]; 3], of: impl Fn(&T) -> IBig) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| of(&matrix[i][j])))
}

/// Exact up to 2^-PLACES.
fn fixed(x: f64) -> IBig {
    let bits = x.abs().to_bits();
    let exponent = (bits >> 52) as i64;
    let fraction = bits & ((1 << 52) - 1);
    let (mantissa, exponent) = if exponent == 0 {
        (fraction, -1074)
    } else {
        (fraction | 1 << 52, exponent - 1075)
    };
    let shift = exponent + PLACES as i64;
    let size = if shift >= 0 {
        IBig::from(mantissa) << shift.unsigned_abs() as usize
    } else {
        IBig::from(mantissa) >> shift.unsigned_abs() as usize
    };
    if x < 0.0 { -size } else { size }
}

fn float(x: &IBig) -> f64 {
    x.to_f64().value() * 0.5_f64.powi(PLACES as i32)
}
