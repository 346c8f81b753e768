//! Differences of products, accurate where they cancel.

/// a b - c d, within one and a half units in the last place of the exact value, unless it overflows
/// or underflows.
///
/// # Source
/// Kahan's difference with fused multiply-add. The bound: Jeannerod, Louvet & Muller (2013).
pub(crate) fn difference_of_products(a: f64, b: f64, c: f64, d: f64) -> f64 {
    let product = c * d;
    let lost = (-c).mul_add(d, product);
    a.mul_add(b, -product) + lost
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_that_cancel_leave_their_difference() {
        // Integers below 2^53, so that i128 has the exact value.
        for step in 0..1000_i64 {
            let [a, b] = [(1 << 52) + 7919 * step, (1 << 51) - 104_729 * step];
            for [c, d] in [
                [a + 1, b - 1],
                [a - step, b + 1],
                [a, b],
                [b, a + 3],
                [1, a],
            ] {
                let exact = i128::from(a) * i128::from(b) - i128::from(c) * i128::from(d);
                let [x, y, z, w] = [a, b, c, d].map(|n| n as f64);
                let found = difference_of_products(x, y, z, w);
                #[expect(clippy::cast_possible_truncation, reason = "an integer")]
                let off = (found as i128 - exact).unsigned_abs() as f64;
                let unit = exact.unsigned_abs() as f64 * f64::EPSILON;
                assert!(off <= 1.5 * unit, "{a} {b} - {c} {d}: {found} for {exact}");
            }
        }
    }
}
