//! Builds the part of the README: an L-shaped bracket with three through-holes and rounded edges,
//! as binary STL.
//!
//! You learn how to pass your own triangles to [`Mesh::new`], which refuses those that are not
//! closed and oriented, and how to write a body to a file.
//!
//! Run: `cargo run --example make_bracket [OUT.stl]` (default: `examples/bracket.stl`, the file of
//! the repository).
//!
//! You should see 896 triangles and a volume a little below 27,629 cubic mm, that of the rounded
//! part.

use std::collections::HashMap;
use std::error::Error;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::path::PathBuf;

use glam::{DVec2, DVec3};
use steadysweep::body::Mesh;
use steadysweep::io::write_mesh;

const LENGTH: f64 = 60.0;
const HEIGHT: f64 = 50.0;
const WIDTH: f64 = 40.0;
const THICKNESS: f64 = 8.0;
/// Radius of the inner fillet; the outer one is rounded about the same centre.
const FILLET: f64 = 8.0;
/// Radius of the rounded ends of the flanges.
const ROUNDING: f64 = 3.0;
const STEPS_PER_QUARTER: usize = 12;

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args()
        .nth(1)
        .unwrap_or("examples/bracket.stl".to_owned());
    let (positions, triangles) = indexed(&bracket());
    let body = Mesh::new(positions, triangles)?;
    write_mesh(&PathBuf::from(&path), body.positions(), body.triangles())?;
    println!("triangles {}", body.triangles().len());
    println!("volume    {:.3}", body.volume());
    println!("written to {path}");
    Ok(())
}

/// The triangles: a profile in (x, z), extruded along y, with two holes in the base and one in the
/// upright flange.
fn bracket() -> Vec<[DVec3; 3]> {
    let base = |p: DVec2| [DVec3::new(p.x, p.y, 0.0), DVec3::new(p.x, p.y, THICKNESS)];
    let upright = |p: DVec2| [DVec3::new(0.0, p.y, p.x), DVec3::new(THICKNESS, p.y, p.x)];
    let holes: Vec<Vec<[DVec3; 2]>> = vec![
        circle(DVec2::new(42.0, 10.0), 4.5).map(base).collect(),
        circle(DVec2::new(42.0, 30.0), 4.5).map(base).collect(),
        // Turned the other way round, because (z, y, x) is a left-handed frame.
        circle(DVec2::new(32.0, 20.0), 9.0)
            .map(upright)
            .rev()
            .collect(),
    ];
    let rims: Vec<Vec<DVec3>> = holes
        .iter()
        .flat_map(|hole| [0, 1].map(|end| hole.iter().map(|pair| pair[end]).collect()))
        .collect();

    let profile = profile();
    let at = |y: f64| profile.iter().map(move |p| DVec3::new(p.x, y, p.y));
    let mut soup = face(&at(0.0).collect::<Vec<_>>(), &[]);
    soup.extend(face(&at(WIDTH).rev().collect::<Vec<_>>(), &[]));
    for (a, b) in edges(&profile) {
        let quad =
            [(a, 0.0), (a, WIDTH), (b, WIDTH), (b, 0.0)].map(|(p, y)| DVec3::new(p.x, y, p.y));
        let normal = (quad[1] - quad[0]).cross(quad[2] - quad[0]);
        // Exact, since all coordinates are short binary fractions.
        let pierces = |rim: &&Vec<DVec3>| rim.iter().all(|p| normal.dot(p - quad[0]) == 0.0);
        soup.extend(face(
            &quad,
            &rims.iter().filter(pierces).cloned().collect::<Vec<_>>(),
        ));
    }
    for hole in &holes {
        for ([a, over_a], [b, over_b]) in edges(hole) {
            soup.extend([[a, over_a, over_b], [a, over_b, b]]);
        }
    }
    soup
}

/// The outline in (x, z), counter-clockwise.
fn profile() -> Vec<DVec2> {
    let outer = THICKNESS + FILLET;
    let arcs = [
        (DVec2::new(outer, outer), outer, PI, FRAC_PI_2),
        (
            DVec2::new(LENGTH - ROUNDING, ROUNDING),
            ROUNDING,
            -FRAC_PI_2,
            FRAC_PI_2,
        ),
        (
            DVec2::new(LENGTH - ROUNDING, THICKNESS - ROUNDING),
            ROUNDING,
            0.0,
            FRAC_PI_2,
        ),
        (DVec2::new(outer, outer), FILLET, -FRAC_PI_2, -FRAC_PI_2),
        (
            DVec2::new(THICKNESS - ROUNDING, HEIGHT - ROUNDING),
            ROUNDING,
            0.0,
            FRAC_PI_2,
        ),
        (
            DVec2::new(ROUNDING, HEIGHT - ROUNDING),
            ROUNDING,
            FRAC_PI_2,
            FRAC_PI_2,
        ),
    ];
    let steps = 0..=STEPS_PER_QUARTER;
    let point = |(centre, radius, from, turn): (DVec2, f64, f64, f64), i: usize| {
        let angle = from + turn * i as f64 / STEPS_PER_QUARTER as f64;
        snapped(centre + radius * DVec2::from_angle(angle))
    };
    arcs.into_iter()
        .flat_map(|arc| steps.clone().map(move |i| point(arc, i)))
        .collect()
}

/// The rim of a hole, counter-clockwise.
fn circle(centre: DVec2, radius: f64) -> impl DoubleEndedIterator<Item = DVec2> {
    const COUNT: usize = 4 * STEPS_PER_QUARTER;
    (0..COUNT)
        .map(move |i| snapped(centre + radius * DVec2::from_angle(TAU * i as f64 / COUNT as f64)))
}

/// Rounds to a grid of 1/1024 mm: such coordinates are exact in the file's 32 bits, and so is
/// arithmetic with them in 64.
fn snapped(point: DVec2) -> DVec2 {
    (point * 1024.0).round() / 1024.0
}

/// Consecutive pairs around a loop.
fn edges<T: Copy>(ring: &[T]) -> impl Iterator<Item = (T, T)> {
    ring.iter()
        .copied()
        .zip(ring.iter().copied().cycle().skip(1))
}

/// Triangulates a planar face with holes. The outline runs counter-clockwise seen from outside, the
/// rims in either sense.
fn face(outline: &[DVec3], rims: &[Vec<DVec3>]) -> Vec<[DVec3; 3]> {
    let normal: DVec3 = edges(outline)
        .map(|(a, b)| (a - outline[0]).cross(b - outline[0]))
        .sum();
    let u = normal.normalize().any_orthonormal_vector();
    let w = normal.normalize().cross(u);
    let corners: Vec<DVec3> = outline
        .iter()
        .chain(rims.iter().flatten())
        .copied()
        .collect();
    let plane: Vec<DVec2> = corners
        .iter()
        .map(|p| DVec2::new(u.dot(*p), w.dot(*p)))
        .collect();
    let mut polygon: Vec<usize> = (0..outline.len()).collect();
    let mut first = outline.len();
    let mut open: Vec<Vec<usize>> = Vec::new();
    for rim in rims {
        let mut ring: Vec<usize> = (first..first + rim.len()).collect();
        let area: f64 = edges(&ring).map(|(a, b)| plane[a].perp_dot(plane[b])).sum();
        if area > 0.0 {
            ring.reverse();
        }
        first += rim.len();
        open.push(ring);
    }
    while let Some(ring) = open.pop() {
        polygon = bridged(&plane, &polygon, &ring, &open);
    }
    clip_ears(&plane, polygon)
        .into_iter()
        .map(|ear| ear.map(|i| corners[i]))
        .collect()
}

/// The polygon with a clockwise hole joined to it along the shortest bridge that crosses nothing.
fn bridged(
    plane: &[DVec2],
    polygon: &[usize],
    ring: &[usize],
    others: &[Vec<usize>],
) -> Vec<usize> {
    let loops = || others.iter().map(Vec::as_slice).chain([polygon, ring]);
    let is_free = |a: usize, b: usize| {
        !loops().flat_map(edges).any(|(c, d)| {
            let side =
                |a: usize, b: usize, c: usize| (plane[b] - plane[a]).perp_dot(plane[c] - plane[a]);
            ![c, d].contains(&a)
                && ![c, d].contains(&b)
                && side(a, b, c) * side(a, b, d) <= 0.0
                && side(c, d, a) * side(c, d, b) <= 0.0
        })
    };
    let pairs = (0..polygon.len()).flat_map(|i| (0..ring.len()).map(move |j| (i, j)));
    let (i, j) = pairs
        .filter(|&(i, j)| is_free(polygon[i], ring[j]))
        .min_by(|&(i, j), &(k, l)| {
            let length = |i: usize, j: usize| plane[polygon[i]].distance_squared(plane[ring[j]]);
            length(i, j).total_cmp(&length(k, l))
        })
        .expect("a polygon sees its hole");
    [&polygon[..=i], &ring[j..], &ring[..=j], &polygon[i..]].concat()
}

/// Cuts the ear with the least sharp corners off a counter-clockwise polygon, until nothing is
/// left.
fn clip_ears(plane: &[DVec2], mut polygon: Vec<usize>) -> Vec<[usize; 3]> {
    let mut triangles = Vec::new();
    while polygon.len() > 2 {
        let count = polygon.len();
        let ear_at = |i: usize| {
            [
                polygon[(i + count - 1) % count],
                polygon[i],
                polygon[(i + 1) % count],
            ]
        };
        let is_empty = |ear: [usize; 3]| {
            let holds = |p: DVec2| {
                edges(&ear).all(|(a, b)| (plane[b] - plane[a]).perp_dot(p - plane[a]) >= 0.0)
            };
            !polygon.iter().any(|i| !ear.contains(i) && holds(plane[*i]))
        };
        let sharpness = |ear: [usize; 3]| {
            let area = (plane[ear[1]] - plane[ear[0]]).perp_dot(plane[ear[2]] - plane[ear[0]]);
            let longest = edges(&ear)
                .map(|(a, b)| plane[a].distance_squared(plane[b]))
                .fold(0.0, f64::max);
            area / longest
        };
        let best = (0..count)
            .filter(|&i| sharpness(ear_at(i)) > 0.0 && is_empty(ear_at(i)))
            .max_by(|&i, &j| sharpness(ear_at(i)).total_cmp(&sharpness(ear_at(j))))
            .expect("a polygon has an ear");
        triangles.push(ear_at(best));
        polygon.remove(best);
    }
    triangles
}

/// Each corner once, in the order of appearance.
fn indexed(soup: &[[DVec3; 3]]) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let mut positions = Vec::new();
    let mut numbers = HashMap::new();
    let triangles = soup
        .iter()
        .map(|corners| {
            corners.map(|p| {
                // Adding 0 turns -0 into 0, the same place with different bits.
                *numbers
                    .entry((p + 0.0).to_array().map(f64::to_bits))
                    .or_insert_with(|| {
                        positions.push(p);
                        u32::try_from(positions.len() - 1).expect("the part is small")
                    })
            })
        })
        .collect();
    (positions, triangles)
}
