//! What a steady motion of the plane leaves alone.

use super::Generator;
use super::logarithm::largest_entry;
use crate::motion::invariants::PairInvariants;
use crate::motion::pair::Traceless;
use crate::numeric::difference_of_products;
use crate::numeric::tolerance::{NEGATIVE_PAIR, NEGLIGIBLE_RATE};
use glam::DVec2;

/// What a steady motion of the plane leaves alone, whatever its kind.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Invariants {
    /// The eigenvalues of M, the linear part of the generator of the whole span, as \[re, im\]; a
    /// complex pair with im > 0 first.
    pub eigenvalues: [[f64; 2]; 2],
    /// The point that stays, where there is exactly one.
    pub fixed_point: Option<DVec2>,
    /// The turn of the complex pair in radians, of any size, positive from x towards y.
    pub turn: Option<f64>,
    /// The area of a body at the end, divided by that at the start.
    pub area_factor: f64,
}

/// What exp(tG) leaves alone.
///
/// Rates (turn in radians, logarithms of factors) below `NEGLIGIBLE_RATE` count as 0.
pub fn invariants(generator: &Generator) -> Invariants {
    let [x, y] = [generator.linear.x_axis, generator.linear.y_axis];
    let block = Traceless::of(&generator.linear);
    let size = largest_entry(&generator.linear);
    let noise = NEGATIVE_PAIR * size * block.largest();
    let pair = PairInvariants::new(0.5 * (x.x + y.y), &block, noise);
    let moves = |[re, im]: &[f64; 2]| re.hypot(*im) > NEGLIGIBLE_RATE;
    let offset = generator.offset;
    let fixed_point = || {
        DVec2::new(
            difference_of_products(y.x, offset.y, offset.x, y.y),
            difference_of_products(offset.x, x.y, x.x, offset.y),
        ) / difference_of_products(x.x, y.y, y.x, x.y)
    };
    Invariants {
        eigenvalues: pair.eigenvalues,
        fixed_point: pair
            .eigenvalues
            .iter()
            .all(moves)
            .then(fixed_point)
            .filter(|point| point.is_finite()),
        turn: pair.turn.map(|turn| turn.copysign(block.lower)),
        area_factor: generator.volume_rate().exp(),
    }
}
