//! Finds every defect that keeps a triangle list from being a body, with its index and place.

use super::defect::Defect;
use super::edge::Edge;
use super::shell::{Shell, ShellRole, Thickness, depths};
use crate::numeric::tolerance::LARGEST_COORDINATE;
use crate::surface::{Shells, Sides, edges};
use glam::DVec3;

/// Most triangles or vertices: half edges are numbered by `u32`, three per triangle.
const MOST: usize = u32::MAX as usize / 3;

/// Every defect of a triangle list; empty when it is a body.
///
/// - `positions`: #V; finite, at most 1e18 in each coordinate. Vertices that no triangle uses are
///   allowed.
/// - `triangles`: #F index triples into `positions`, counter-clockwise from outside (or all
///   clockwise).
///
/// Damaged numbers hide the defects of edges that depend on them, and defects of edges hide those
/// of shells: every reported defect is there, but others may turn up once these are repaired.
///
/// # Cost
/// O(n log n).
pub fn defects(positions: &[DVec3], triangles: &[[u32; 3]]) -> Vec<Defect> {
    check(positions, triangles).err().unwrap_or_default()
}

/// What validation finds about a body.
pub(super) struct Checked {
    /// Sorted by vertices.
    pub(super) edges: Vec<Edge>,
    /// Sorted by first triangle; the volumes are those after turning.
    pub(super) shells: Vec<Shell>,
    /// Whether all triangles must be reversed; the edges are those before that.
    pub(super) turned: bool,
}

/// Edges and shells of a body, or its defects.
pub(super) fn check(positions: &[DVec3], triangles: &[[u32; 3]]) -> Result<Checked, Vec<Defect>> {
    let found = damaged_numbers(positions, triangles);
    // Edges of triangles with wrong indices have no positions, and triangles next to them no
    // neighbours.
    if found
        .iter()
        .any(|d| !matches!(d, Defect::NonFinite { .. } | Defect::RepeatedVertex { .. }))
    {
        return Err(found);
    }
    let edges = match_edges(positions, triangles, found)?;
    check_shells(positions, triangles, edges)
}

/// The defects in the numbers of a triangle list; its edges are not examined.
pub(super) fn damaged_numbers(positions: &[DVec3], triangles: &[[u32; 3]]) -> Vec<Defect> {
    if triangles.is_empty() {
        return vec![Defect::Empty];
    }
    if triangles.len() > MOST || positions.len() > MOST {
        return vec![Defect::TooMany {
            triangles: triangles.len(),
            vertices: positions.len(),
            limit: MOST,
        }];
    }
    let mut found = Vec::new();
    for (vertex, &position) in (0u32..).zip(positions) {
        if !position.is_finite() {
            found.push(Defect::NonFinite { vertex, position });
        } else if position.abs().max_element() > LARGEST_COORDINATE {
            found.push(Defect::TooFar { vertex, position });
        }
    }
    for (triangle, corners) in (0u32..).zip(triangles) {
        let [a, b, c] = *corners;
        if let Some(&index) = corners.iter().find(|&&v| v as usize >= positions.len()) {
            found.push(Defect::IndexOutOfRange {
                triangle,
                index,
                vertices: positions.len(),
            });
        } else if a == b || b == c || c == a {
            let vertex = if b == c { b } else { a };
            found.push(Defect::RepeatedVertex {
                triangle,
                vertex,
                position: positions[vertex as usize],
            });
        }
    }
    found
}

/// Every edge with its two triangles, or the defects in `found` and those of the edges.
fn match_edges(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    mut found: Vec<Defect>,
) -> Result<Vec<Edge>, Vec<Defect>> {
    // A triangle with a repeated vertex, reported above, uses its edge once in each sense: it is
    // left out.
    let whole = (0u32..)
        .zip(triangles)
        .filter(|(_, [a, b, c])| a != b && b != c && c != a);
    let sides = Sides::of(whole.flat_map(|(face, corners)| (3 * face..).zip(edges(corners))));
    let mut matched = Vec::with_capacity(3 * triangles.len() / 2);
    for edge in sides.edges() {
        let vertices = edge.ends;
        if let Some(pair) = edge.pair() {
            matched.push(Edge {
                vertices,
                faces: pair.map(|half| half / 3),
            });
            continue;
        }
        // The edge in the sense of the first triangle.
        let [a, b] = vertices;
        let directed = if edge.there().len() > 0 {
            [a, b]
        } else {
            [b, a]
        };
        let place = |ends: [u32; 2]| ends.map(|v| positions[v as usize]);
        let mut faces: Vec<u32> = edge.halves().map(|half| half / 3).collect();
        found.push(match faces[..] {
            [one] => Defect::OpenEdge {
                vertices: directed,
                triangle: one,
                places: place(directed),
            },
            [one, two] => Defect::OpposedTriangles {
                vertices: directed,
                triangles: [one, two],
                places: place(directed),
            },
            _ => {
                faces.sort_unstable();
                Defect::NonManifoldEdge {
                    vertices,
                    triangles: faces,
                    places: place(vertices),
                }
            }
        });
    }
    if found.is_empty() {
        Ok(matched)
    } else {
        Err(found)
    }
}

fn check_shells(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    edges: Vec<Edge>,
) -> Result<Checked, Vec<Defect>> {
    let neighbours = edges.iter().map(|edge| edge.faces);
    let lists = Shells::joined(triangles.len(), neighbours).members;
    let mut found = Vec::new();
    let mut volumes = Vec::with_capacity(lists.len());
    for list in &lists {
        let shell = list.iter().map(|&f| triangles[f as usize]);
        let thickness = Thickness::of(positions, shell);
        if thickness.is_flat() {
            found.push(Defect::FlatShell {
                triangle: list[0],
                triangles: list.len(),
                thickness: thickness.mean,
                limit: thickness.limit,
                place: positions[triangles[list[0] as usize][0] as usize],
            });
        }
        volumes.push(thickness.volume);
    }
    if !found.is_empty() {
        return Err(found);
    }
    let turned = volumes.iter().sum::<f64>() < 0.0;
    let sign = if turned { -1.0 } else { 1.0 };
    let mut shells = Vec::with_capacity(lists.len());
    for ((list, volume), depth) in lists
        .iter()
        .zip(&volumes)
        .zip(depths(positions, triangles, &lists))
    {
        let depth = if turned { -depth } else { depth };
        let role = match (volume * sign > 0.0, depth >= 1) {
            (true, false) => ShellRole::Outer,
            (true, true) => ShellRole::Nested,
            (false, true) => ShellRole::Cavity,
            (false, false) => {
                let place = positions[triangles[list[0] as usize][0] as usize];
                let (triangle, triangles) = (list[0], list.len());
                found.push(Defect::InvertedShell {
                    triangle,
                    triangles,
                    volume: *volume,
                    place,
                });
                continue;
            }
        };
        shells.push(Shell {
            triangles: list.clone(),
            volume: volume * sign,
            role,
        });
    }
    if found.is_empty() {
        Ok(Checked {
            edges,
            shells,
            turned,
        })
    } else {
        Err(found)
    }
}

#[cfg(test)]
mod tests {
    use super::super::shell::tests::{Soup, boxes, sphere};
    use super::*;

    fn cube() -> Soup {
        let mut soup = (Vec::new(), Vec::new());
        boxes(&mut soup, DVec3::ZERO, DVec3::ONE, true);
        soup
    }

    #[test]
    fn a_cube_and_a_ball_have_no_defects() {
        let (positions, triangles) = cube();
        assert_eq!(defects(&positions, &triangles), [], "a cube");
        let (positions, triangles) = sphere(12);
        assert_eq!(defects(&positions, &triangles), [], "a ball");
    }

    #[test]
    fn nothing_is_no_body() {
        assert_eq!(defects(&[], &[]), [Defect::Empty], "no triangles");
        assert_eq!(
            defects(&[DVec3::ZERO], &[]),
            [Defect::Empty],
            "a vertex but no triangles"
        );
    }

    #[test]
    fn an_open_edge_is_named_with_triangle_and_place() {
        let (positions, mut triangles) = cube();
        // Without [0, 2, 3], its three edges are open, in the sense of the remaining neighbours.
        let removed = triangles.remove(0);
        assert_eq!(removed, [0, 2, 3], "first triangle of the cube");
        let found = defects(&positions, &triangles);
        assert_eq!(found.len(), 3, "{found:?}");
        // Edge 0-2 belongs to triangles [0, 2, 3] and [0, 6, 2] (number 9, now 8), which runs from
        // 2 to 0.
        assert_eq!(
            found[0],
            Defect::OpenEdge {
                vertices: [2, 0],
                triangle: 8,
                places: [DVec3::Y, DVec3::ZERO]
            },
            "first in the order of vertices"
        );
    }

    #[test]
    fn an_edge_of_four_triangles_is_non_manifold() {
        let (mut positions, mut triangles) = cube();
        // A tetrahedron over the edge 0-1 of the cube, whose vertices it shares.
        positions.extend([DVec3::new(0.5, -1.0, -0.5), DVec3::new(0.5, -0.5, -1.0)]);
        triangles.extend([[0, 1, 8], [1, 0, 9], [1, 9, 8], [0, 8, 9]]);
        let found = defects(&positions, &triangles);
        let [
            Defect::NonManifoldEdge {
                vertices: [0, 1],
                triangles: faces,
                ..
            },
        ] = &found[..]
        else {
            panic!("expected one non-manifold edge, found {found:?}");
        };
        assert_eq!(
            faces,
            &[1, 4, 12, 13],
            "two of the cube, two of the tetrahedron"
        );
    }

    #[test]
    fn a_triangle_turned_over_is_named_with_its_neighbours() {
        let (positions, mut triangles) = cube();
        triangles[5].swap(1, 2);
        let found = defects(&positions, &triangles);
        assert_eq!(
            found.len(),
            3,
            "one defect per edge of the triangle: {found:?}"
        );
        for defect in &found {
            let Defect::OpposedTriangles { triangles, .. } = defect else {
                panic!("unexpected {defect:?}")
            };
            assert!(triangles.contains(&5), "{defect:?}");
        }
    }

    #[test]
    fn wrong_indices_and_numbers_are_named() {
        let (mut positions, mut triangles) = cube();
        triangles[3][1] = 8;
        assert_eq!(
            defects(&positions, &triangles),
            [Defect::IndexOutOfRange {
                triangle: 3,
                index: 8,
                vertices: 8
            }],
            "neighbours are not reported as open"
        );
        triangles[3][1] = triangles[3][0];
        let found = defects(&positions, &triangles);
        assert!(
            matches!(found[0], Defect::RepeatedVertex { triangle: 3, .. }),
            "{found:?}"
        );
        let (_, triangles) = cube();
        positions[2].y = f64::NAN;
        positions[5].x = f64::INFINITY;
        let found = defects(&positions, &triangles);
        assert!(
            matches!(
                found[..],
                [
                    Defect::NonFinite { vertex: 2, .. },
                    Defect::NonFinite { vertex: 5, .. }
                ]
            ),
            "{found:?}"
        );
        positions = cube().0;
        positions[1].x = 1e19;
        assert!(
            matches!(
                defects(&positions, &triangles)[..],
                [Defect::TooFar { vertex: 1, .. }]
            ),
            "too large"
        );
    }

    #[test]
    fn a_sheet_is_flat_at_any_scale_and_place() {
        for (scale, offset) in [(1.0, 0.0), (1e-3, 0.0), (1e6, 0.0), (1.0, 1e6)] {
            let mut soup = (Vec::new(), Vec::new());
            boxes(
                &mut soup,
                DVec3::splat(offset),
                DVec3::new(scale, scale, 0.0),
                true,
            );
            let found = defects(&soup.0, &soup.1);
            assert!(
                matches!(
                    found[..],
                    [Defect::FlatShell {
                        triangle: 0,
                        triangles: 12,
                        ..
                    }]
                ),
                "{found:?}"
            );
            let mut soup = (Vec::new(), Vec::new());
            boxes(
                &mut soup,
                DVec3::splat(offset),
                DVec3::new(scale, scale, 1e-6 * scale),
                true,
            );
            assert_eq!(
                defects(&soup.0, &soup.1),
                [],
                "a foil of a millionth is a body at {scale}, {offset}"
            );
        }
    }

    #[test]
    fn a_tilted_sheet_is_flat_although_rounding_gives_it_a_volume() {
        let mut soup = (Vec::new(), Vec::new());
        boxes(
            &mut soup,
            DVec3::splat(3.0),
            DVec3::new(1.0, 1.0, 0.0),
            true,
        );
        let tilt = glam::DQuat::from_rotation_x(0.7) * glam::DQuat::from_rotation_y(0.3);
        soup.0.iter_mut().for_each(|p| *p = tilt * *p);
        let found = defects(&soup.0, &soup.1);
        assert!(matches!(found[..], [Defect::FlatShell { .. }]), "{found:?}");
    }

    #[test]
    fn an_inverted_shell_outside_the_others_is_refused() {
        let mut soup = cube();
        boxes(&mut soup, DVec3::splat(2.0), DVec3::splat(0.5), false);
        let found = defects(&soup.0, &soup.1);
        let [
            Defect::InvertedShell {
                triangle: 12,
                triangles: 12,
                volume,
                place,
            },
        ] = found[..]
        else {
            panic!("expected the second shell, found {found:?}");
        };
        assert_eq!(
            (volume, place),
            (-0.125, DVec3::splat(2.0)),
            "volume and first corner of the small box"
        );
    }

    #[test]
    fn a_shell_inverted_in_a_cavity_is_refused() {
        let mut soup = cube();
        boxes(&mut soup, DVec3::splat(0.2), DVec3::splat(0.6), false);
        boxes(&mut soup, DVec3::splat(0.4), DVec3::splat(0.2), false);
        let found = defects(&soup.0, &soup.1);
        assert!(
            matches!(found[..], [Defect::InvertedShell { triangle: 24, .. }]),
            "{found:?}"
        );
    }
}
