//! exp(tG) in space by its Taylor sum.

use glam::{DAffine3, DMat3, DVec3};
use steadysweep::motion::Generator;

/// exp(tG) by the Taylor sum of the 4 x 4 matrix divided by 2^k, squared k times: slow and
/// obviously right.
pub(crate) fn naive_exponential(generator: &Generator, t: f64) -> DAffine3 {
    let mut matrix = [[0.0; 4]; 4];
    for (row, values) in matrix.iter_mut().zip(generator.rows()) {
        *row = values.map(|value| t * value);
    }
    let size = generator
        .linear
        .to_cols_array()
        .iter()
        .fold(0.0_f64, |m, x| m.max(x.abs()))
        * t.abs();
    let mut halvings = 0;
    let mut scale = 1.0;
    while size * scale > 0.01 {
        scale *= 0.5;
        halvings += 1;
    }
    for value in matrix.as_flattened_mut() {
        *value *= scale;
    }
    // exp(X) - I is squared as 2 E + E^2, so that small motions keep their digits.
    let mut change = [[0.0; 4]; 4];
    let mut power = matrix;
    for k in 2..24 {
        add(&mut change, &power);
        power = multiply(&power, &matrix);
        for value in power.as_flattened_mut() {
            *value /= f64::from(k);
        }
    }
    for _ in 0..halvings {
        let mut next = multiply(&change, &change);
        add(&mut next, &change);
        add(&mut next, &change);
        change = next;
    }
    affine(std::array::from_fn(|i| {
        let mut row = change[i];
        row[i] += 1.0;
        row
    }))
}

fn multiply(a: &[[f64; 4]; 4], b: &[[f64; 4]; 4]) -> [[f64; 4]; 4] {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..4).map(|k| a[i][k] * b[k][j]).sum()))
}

fn add(a: &mut [[f64; 4]; 4], b: &[[f64; 4]; 4]) {
    for (x, y) in a.as_flattened_mut().iter_mut().zip(b.as_flattened()) {
        *x += y;
    }
}

/// From the rows [L t].
pub(crate) fn affine(rows: [[f64; 4]; 3]) -> DAffine3 {
    let column = |j: usize| DVec3::new(rows[0][j], rows[1][j], rows[2][j]);
    DAffine3 {
        matrix3: DMat3::from_cols(column(0), column(1), column(2)),
        translation: column(3),
    }
}
