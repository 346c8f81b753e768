//! Random curves of the plane for the arrangement: its cells have the winding numbers of a plain
//! count, and its region is theirs.

use crate::campaign;
use crate::random::Random;
use glam::DVec2;
use steadysweep::solid::planar::{Arrangement, Segment, arrange};

/// Closed polygons, as numbers in bytes: the count of corners of each, then their coordinates.
fn written(curves: &[Vec<DVec2>]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for curve in curves {
        bytes.extend((curve.len() as u64).to_le_bytes());
        for corner in curve {
            bytes.extend(corner.x.to_le_bytes());
            bytes.extend(corner.y.to_le_bytes());
        }
    }
    bytes
}

fn read(bytes: &[u8]) -> Vec<Vec<DVec2>> {
    let mut words = bytes
        .chunks_exact(8)
        .map(|word| u64::from_le_bytes(word.try_into().expect("eight bytes")));
    let mut curves = Vec::new();
    while let Some(count) = words.next() {
        let mut number = || f64::from_bits(words.next().expect("as written"));
        curves.push((0..count).map(|_| DVec2::new(number(), number())).collect());
    }
    curves
}

/// Polygons on small grids, nearly on them, or rounded to 32 bits; of any size, anywhere.
fn random_curves(number: u64) -> Vec<Vec<DVec2>> {
    let mut random = Random::new(number);
    let random = &mut random;
    let unit = random.one_of(&[1.0, 1.0, 1e-3, 0.1, 3e15, 1e-30, 1e17]);
    let origin = if random.chance(0.3) {
        random.planar_point() * unit * random.one_of(&[10.0, 1e6, 1e12])
    } else {
        DVec2::ZERO
    };
    let family = random.below(5);
    let half = random.one_of(&[1.0, 2.0, 3.0, 8.0]);
    let count = 1 + random.below(5);
    (0..count)
        .map(|_| {
            let corners = 3 + random.below(18);
            (0..corners)
                .map(|k| {
                    let place = random.planar_point() * half;
                    let noise = random.planar_point();
                    let place = match family {
                        0 => place.round(),
                        1 => place.round() + 1e-15 * (4.0 * noise).round(),
                        2 => place.round() + 1e-7 * noise,
                        3 => DVec2::from_angle(0.1 * (k as f64) * half) * place.x.round(),
                        _ => place,
                    };
                    let place = origin + unit * place;
                    if number.is_multiple_of(3) {
                        place.map(|x| f64::from(x as f32))
                    } else {
                        place
                    }
                })
                .collect()
        })
        .collect()
}

/// The winding number around a point, by the crossings of the half line to the right.
fn winding_number(curves: &[Vec<DVec2>], point: DVec2) -> i32 {
    let mut winding = 0;
    for curve in curves {
        for (k, &a) in curve.iter().enumerate() {
            let b = curve[(k + 1) % curve.len()];
            let left = (b - a).perp_dot(point - a);
            if a.y <= point.y && b.y > point.y && left > 0.0 {
                winding += 1;
            } else if b.y <= point.y && a.y > point.y && left < 0.0 {
                winding -= 1;
            }
        }
    }
    winding
}

fn distance(curves: &[Vec<DVec2>], point: DVec2) -> f64 {
    let to_side = |(a, b): (DVec2, DVec2)| {
        let along = b - a;
        let share = ((point - a).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        let share = if share.is_nan() { 0.0 } else { share };
        point.distance(a + along * share)
    };
    let sides = curves.iter().flat_map(|curve| {
        let next = curve.iter().cycle().skip(1);
        curve.iter().copied().zip(next.copied())
    });
    sides.map(to_side).fold(f64::INFINITY, f64::min)
}

/// The loops of a region.
fn loops(arrangement: &Arrangement) -> Vec<Vec<DVec2>> {
    let place = |&vertex: &u32| arrangement.positions()[vertex as usize];
    let outlines = arrangement.outlines();
    let loops = outlines.loops();
    loops
        .map(|outline| outline.vertices.iter().map(place).collect())
        .collect()
}

fn check(curves: &[Vec<DVec2>]) {
    let (mut points, mut segments) = (Vec::new(), Vec::new());
    for curve in curves {
        let (first, count) = (points.len() as u32, curve.len() as u32);
        points.extend(curve);
        segments.extend((0..count).map(|k| Segment {
            ends: [first + k, first + (k + 1) % count],
            weight: 1,
        }));
    }
    let arrangement = arrange(&points, &segments).expect("closed curves of finite points");
    let region = loops(&arrangement);
    let triangulation = arrangement.triangulation().expect("a triangulation");
    let size = points
        .iter()
        .fold(0.0_f64, |far, p| far.max(p.abs().max_element()));
    // Far more than a point may move, and than the rounding of the counts.
    let near = 16.0 * arrangement.rounding() + 1e-13 * size;
    let mut random = Random::new(7);
    for _ in 0..100 {
        let corner = points[random.below(points.len())];
        let other = points[random.below(points.len())];
        let beside = random.planar_point() * random.one_of(&[0.5, 1e-2, 1e-5]);
        let point = corner.lerp(other, random.unit()) + beside * corner.distance(other);
        if distance(curves, point) <= near {
            continue;
        }
        let winding = winding_number(curves, point);
        let inside = winding_number(&region, point);
        assert_eq!(inside, i32::from(winding >= 1), "{winding} at {point}");
        let at = |corners: &[u32; 3]| corners.map(|v| arrangement.positions()[v as usize]);
        let holds = |[a, b, c]: [DVec2; 3]| {
            [(a, b), (b, c), (c, a)]
                .iter()
                .all(|(from, to)| (*to - *from).perp_dot(point - *from) > 0.0)
        };
        let cells = triangulation.triangles.iter().zip(&triangulation.winding);
        for (corners, &found) in cells {
            if holds(at(corners)) {
                assert_eq!(found, winding, "at {point}");
            }
        }
    }
}

#[test]
fn arrangement_of_the_plane() {
    campaign::run(
        "arrangement_of_the_plane",
        |number| written(&random_curves(number)),
        |bytes| {
            check(&read(bytes));
            true
        },
    );
}
