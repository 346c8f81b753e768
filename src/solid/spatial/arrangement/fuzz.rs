//! Random closed triangle soups with degenerate coordinates: the region is closed, and holds exactly
//! the points around which the soup winds.
//!
//! Case number n is the same in every run. A test run tries some; for half an hour of them:
//!
//! ```sh
//! FUZZ_SECONDS=1800 cargo test --lib arrangement::fuzz
//! FUZZ_FIRST=1234 FUZZ_SECONDS=1 cargo test --lib arrangement::fuzz
//! ```

use super::{Cancelled, positive_region};
use crate::bounds::SurfaceTree;
use crate::numeric::index;
use crate::watch::Work;
use glam::DVec3;
use std::collections::HashMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

/// Number of soups in a test run without `FUZZ_SECONDS`.
const FEW: u64 = 400;

type Soup = (Vec<DVec3>, Vec<[u32; 3]>);

/// A soup in closed pieces.
#[derive(Debug, Clone)]
struct Pieces {
    positions: Vec<DVec3>,
    pieces: Vec<Vec<[u32; 3]>>,
}

impl Pieces {
    fn soup(&self) -> Soup {
        (self.positions.clone(), self.pieces.concat())
    }
}

struct Random(u64);

impl Random {
    fn new(seed: u64) -> Random {
        let mut random = Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x5851_f42d_4c95_7f2d);
        for _ in 0..4 {
            random.unit();
        }
        random
    }

    /// A number in [0, 1).
    fn unit(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "below the count"
    )]
    fn below(&mut self, count: usize) -> usize {
        ((self.unit() * count as f64) as usize).min(count - 1)
    }

    fn one_of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len())]
    }

    /// A point in a cube of half width 1.
    fn point(&mut self) -> DVec3 {
        DVec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
    }
}

/// Boundaries of tetrahedra and fans, of either sense, between points on a small grid, nearly on
/// it, or rounded to 32 bits; of any size, anywhere.
fn pieces(number: u64) -> Pieces {
    let mut random = Random::new(number);
    let random = &mut random;
    let unit = random.one_of(&[1.0, 1.0, 1e-3, 0.1, 3e15, 1e-30]);
    let far = random.one_of(&[0.0, 0.0, 10.0, 1e6]);
    let origin = random.point() * unit * far;
    let half = random.one_of(&[1.0, 2.0, 3.0, 6.0]);
    let family = random.below(5);
    let is_single = random.below(3) == 0;
    let mut positions: Vec<DVec3> = (0..4 + random.below(14))
        .map(|k| {
            let (place, noise) = (random.point() * half, random.point());
            let place = match family {
                0 => place.round(),
                1 => place.round() + 1e-15 * (4.0 * noise).round(),
                2 => place.round() + 1e-8 * noise,
                // Points of a few planes and circles.
                3 => {
                    let angle = std::f64::consts::TAU * (k % 12) as f64 / 12.0;
                    DVec3::new(angle.cos(), angle.sin(), 0.0) * place.x.round()
                        + DVec3::Z * place.z.round()
                }
                _ => place,
            };
            let place = origin + unit * place;
            if is_single {
                #[expect(
                    clippy::cast_possible_truncation,
                    reason = "the rounding is what is wanted"
                )]
                place.map(|x| f64::from(x as f32))
            } else {
                place
            }
        })
        .collect();
    let count = positions.len();
    let mut pieces = Vec::new();
    for _ in 0..1 + random.below(12) {
        // A fan about an axis: with three corners around it two tetrahedra, or one where its ends
        // are the same.
        let [low, high] = [0; 2].map(|_: u32| index(random.below(count)));
        let ring: Vec<u32> = (0..3 + random.below(4))
            .map(|_| index(random.below(count)))
            .collect();
        let sides = ring.iter().zip(ring.iter().cycle().skip(1));
        let of_side = |(&here, &next)| [[low, next, here], [high, here, next]];
        pieces.push(sides.flat_map(of_side).collect::<Vec<_>>());
    }
    if random.below(4) == 0 {
        // Copies of the points: the same places under other numbers.
        positions.extend_from_within(..);
        for triangle in pieces.iter_mut().flatten() {
            *triangle = triangle.map(|v| {
                v + if random.below(2) == 0 {
                    0
                } else {
                    index(count)
                }
            });
        }
    }
    Pieces { positions, pieces }
}

/// The winding number of a closed surface around a point, by solid angles.
fn winding((positions, triangles): &Soup, point: DVec3) -> f64 {
    let angle = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| positions[v as usize] - point);
        let (l, m, n) = (a.length(), b.length(), c.length());
        let denominator = l * m * n + a.dot(b) * n + b.dot(c) * l + c.dot(a) * m;
        2.0 * f64::atan2(a.dot(b.cross(c)), denominator)
    };
    triangles.iter().map(angle).sum::<f64>() / (4.0 * std::f64::consts::PI)
}

/// What is wrong with the region of a soup, if anything.
fn wrong(soup: Soup, cancelled: Cancelled) -> Option<String> {
    let run = || positive_region(&soup.0, &soup.1, cancelled, None, Work::UNWATCHED);
    let region = match catch_unwind(AssertUnwindSafe(run)) {
        Ok(Ok(region)) => region.boundary,
        Ok(Err(stop)) => return Some(format!("{stop:?}")),
        Err(_) => return Some("a panic".into()),
    };
    let mut uses = HashMap::<[u32; 2], [u32; 2]>::new();
    for &[a, b, c] in &region.1 {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            uses.entry([from.min(to), from.max(to)]).or_default()[usize::from(from > to)] += 1;
        }
    }
    if let Some((edge, uses)) = uses.iter().find(|(_, uses)| uses[0] != uses[1]) {
        return Some(format!("an edge {edge:?} is open: {uses:?}"));
    }
    // Sizes near 1 keep the products of the solid angles in range.
    let empty = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    let [low, high] = (soup.0.iter()).fold(empty, |[low, high], &p| [low.min(p), high.max(p)]);
    let size = (high - low).max_element();
    if size == 0.0 {
        return (!region.1.is_empty()).then(|| "a region without volume".into());
    }
    let scaled = |(positions, triangles): Soup| -> Soup {
        let positions = positions.iter().map(|&p| (p - low) / size).collect();
        (positions, triangles)
    };
    let rounding = f64::EPSILON * low.abs().max(high.abs()).max_element() / size;
    let (soup, region) = (scaled(soup), scaled(region));
    let tree = SurfaceTree::new(&soup.0, &soup.1);
    let mut random = Random::new(7);
    for _ in 0..60 {
        let corners = [0; 3].map(|_: u32| soup.0[random.below(soup.0.len())]);
        let [s, t] = [random.unit(), random.unit()];
        let near = corners[0].lerp(corners[1], s).lerp(corners[2], t);
        let beside: f64 = random.one_of(&[0.5, 1e-2, 1e-4]);
        let point = near + random.point() * beside.max(1e3 * rounding);
        if tree.distance_to_surface(point) <= 1e2 * rounding + 1e-12 {
            continue;
        }
        let (before, after) = (winding(&soup, point), winding(&region, point));
        let expected = if before.round() >= 1.0 { 1.0 } else { 0.0 };
        if (after - expected).abs() > 1e-6 {
            return Some(format!("{after} of {before} at {point}"));
        }
    }
    None
}

/// The soup with as few pieces as are needed for something to be wrong.
fn smallest(mut found: Pieces, cancelled: Cancelled) -> Pieces {
    let mut place = 0;
    while place < found.pieces.len() {
        let mut fewer = found.clone();
        fewer.pieces.remove(place);
        if wrong(fewer.soup(), cancelled).is_some() {
            found = fewer;
        } else {
            place += 1;
        }
    }
    found
}

fn setting(name: &str) -> Option<u64> {
    let text = std::env::var(name).ok()?;
    Some(text.parse().expect("a number"))
}

#[test]
fn random_soups_have_the_region_of_their_winding_numbers() {
    let first = setting("FUZZ_FIRST").unwrap_or(0);
    let time = setting("FUZZ_SECONDS").map(Duration::from_secs);
    let start = Instant::now();
    let is_over = |count: u64| time.map_or(count >= FEW, |time| start.elapsed() >= time);
    let mut count = 0;
    while !is_over(count) {
        let number = first + count;
        let pieces = pieces(number);
        for cancelled in [Cancelled::Dropped, Cancelled::Kept] {
            if wrong(pieces.soup(), cancelled).is_some() {
                let least = smallest(pieces, cancelled);
                let why = wrong(least.soup(), cancelled);
                panic!("case {number}, {cancelled:?}: {why:?}\n{least:?}");
            }
        }
        count += 1;
    }
    println!("{count} soups");
}
