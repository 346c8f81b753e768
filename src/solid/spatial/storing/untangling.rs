//! A boundary whose triangles meet nowhere but in common corners and edges, on the coordinates as
//! they are stored.
//!
//! Rounding moves sheets that touch, or nearly touch, through each other. Each vertex of triangles
//! that meet elsewhere is moved by a few units (the distance at which readers join vertices, or the
//! rounding of coordinates), or into a neighbour, if fewer pairs meet then; exact signs decide.
//! Where that does not suffice, the boundary is arranged again as it is stored. Most boundaries have
//! no such pairs and stay as they are.

use super::super::arrangement::Cancelled;
use super::super::{MOST_CROSSINGS, RawBoundary, arranged};
use super::joining::Precision;
use crate::bounds::{SurfaceTree, boxes_meet, meeting, triangle_box};
use crate::numeric::tolerance::{ARRANGEMENT_ROUNDING, UNIT_ROUNDOFF, WELD_DISTANCE};
use crate::surface::{Collapsing, bounds_of};
use crate::watch::{Interrupted, Stop, Work};
use glam::DVec3;
use std::collections::{BTreeSet, HashSet};
use std::iter::repeat;

/// How often the vertices of the pairs that are left are visited. Most pairs are gone after two.
const VISITS: usize = 12;

/// Displacements that are tried, in units of the rounding of coordinates or of the distance at
/// which readers join vertices, whichever is larger.
const STEPS: [f64; 4] = [1.0, 3.0, 8.0, 24.0];

/// Vertices with more triangles than this stay where they are; others around them move.
const LARGEST_STAR: usize = 40;

/// A boundary whose vertices have moved.
#[derive(Debug)]
pub(crate) struct Loosened {
    pub(crate) positions: Vec<DVec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Largest distance by which a point of the surface moved.
    pub(crate) largest_move: f64,
    /// Number of pairs of triangles that still meet elsewhere than in common corners and edges.
    pub(crate) meetings: usize,
}

/// The pairs of triangles that meet elsewhere than in common corners and edges.
fn tangled(tree: &SurfaceTree, work: Work) -> Result<Vec<[u32; 2]>, Interrupted> {
    let meetings = tree.meetings_during(work)?;
    Ok(meetings.into_iter().map(|(pair, _)| pair).collect())
}

/// Number of pairs of triangles that meet elsewhere than in common corners and edges.
pub(crate) fn crossings(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    work: Work,
) -> Result<usize, Interrupted> {
    let tree = SurfaceTree::during(work, positions, triangles)?;
    Ok(tangled(&tree, work)?.len())
}

fn largest_coordinate(positions: &[DVec3]) -> f64 {
    let [low, high] = bounds_of(positions.iter().copied());
    low.abs().max(high.abs()).max_element()
}

/// Width of the grid on which all coordinates up to the largest one are stored exactly.
fn grid(positions: &[DVec3], precision: Precision) -> f64 {
    let unit = match precision {
        Precision::Double => f64::EPSILON,
        Precision::Single => f64::from(f32::EPSILON),
    };
    unit * largest_coordinate(positions)
        .max(f64::MIN_POSITIVE)
        .log2()
        .ceil()
        .exp2()
}

/// The region of a boundary that crosses itself, as it is stored, and how far its corners were
/// moved: those of the triangles that cross to a grid on which the arrangement and the file have the
/// same points.
pub(crate) fn arranged_again(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    precision: Precision,
    work: Work,
) -> Result<(RawBoundary, f64), Stop> {
    let width = grid(positions, precision);
    let on_grid = |place: DVec3| (place / width).round() * width;
    let mut positions = positions.to_vec();
    let tree = SurfaceTree::during(work, &positions, triangles)?;
    for pair in tangled(&tree, work)? {
        for vertex in pair.into_iter().flat_map(|t| triangles[t as usize]) {
            positions[vertex as usize] = on_grid(positions[vertex as usize]);
        }
    }
    let bits = |place: &DVec3| place.to_array().map(f64::to_bits);
    let known: HashSet<[u64; 3]> = positions.iter().map(bits).collect();
    let mut region = arranged(&positions, triangles, Cancelled::Dropped, None, work)?;
    for crossing in region
        .positions
        .iter_mut()
        .filter(|place| !known.contains(&bits(place)))
    {
        *crossing = on_grid(*crossing);
    }
    // Rounding to the grid, before and after the arrangement, is less than its width each.
    let rounding = ARRANGEMENT_ROUNDING * UNIT_ROUNDOFF * largest_coordinate(&positions);
    Ok((region, 2.0 * width + rounding))
}

/// The same boundary with as few pairs of triangles that meet elsewhere than in common corners and
/// edges as could be reached by small moves: vertices of such triangles are moved, or joined to
/// neighbours, where fewer pairs meet then.
///
/// - `positions`: as stored in `precision`.
pub(crate) fn loosened(
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    precision: Precision,
    work: Work,
) -> Result<Loosened, Interrupted> {
    let [boxing, seeking] = work.parts([1, 3]);
    let tree = SurfaceTree::during(boxing, &positions, &triangles)?;
    let bad = tangled(&tree, seeking)?;
    if bad.is_empty() || bad.len() > MOST_CROSSINGS {
        return Ok(Loosened {
            positions,
            triangles,
            largest_move: 0.0,
            meetings: bad.len(),
        });
    }
    let work = work.uncounted();
    let [low, high] = bounds_of(positions.iter().copied());
    let weld = WELD_DISTANCE * low.distance(high);
    let corners = |&triangle: &u32| triangles[triangle as usize];
    let mut open: BTreeSet<u32> = bad.iter().flatten().flat_map(corners).collect();
    let mut loose = Loose {
        tree,
        meetings: bad.len(),
        surface: Collapsing::new(triangles, positions.len()),
        moved: vec![0.0; positions.len()],
        unit: weld.max(0.5 * grid(&positions, precision)),
        positions,
        farthest: 0.0,
        weld,
        precision,
    };
    for _ in 0..VISITS {
        let (mut next, mut is_changed) = (BTreeSet::new(), false);
        for vertex in open {
            work.check()?;
            let visit = loose.visit(vertex);
            is_changed |= visit.is_changed;
            if visit.left > 0 {
                next.extend(
                    loose
                        .surface
                        .around(vertex)
                        .flat_map(|(_, corners)| corners),
                );
            }
        }
        open = next;
        if !is_changed {
            break;
        }
    }
    let triangles: Vec<[u32; 3]> = loose.surface.triangles().collect();
    debug_assert_eq!(
        loose.meetings,
        SurfaceTree::new(&loose.positions, &triangles)
            .meetings()
            .len(),
        "each change of the number was counted"
    );
    Ok(Loosened {
        meetings: loose.meetings,
        positions: loose.positions,
        triangles,
        largest_move: loose.farthest,
    })
}

/// A surface whose vertices move by a few units.
struct Loose {
    surface: Collapsing,
    positions: Vec<DVec3>,
    /// How far a point that was a vertex is from the vertex that it has become, at most.
    moved: Vec<f64>,
    /// The largest of these distances.
    farthest: f64,
    /// Number of pairs that meet.
    meetings: usize,
    /// Of the surface before anything moved.
    tree: SurfaceTree,
    unit: f64,
    /// Distance within which readers join vertices.
    weld: f64,
    precision: Precision,
}

/// What became of the triangles around a vertex.
struct Visit {
    is_changed: bool,
    /// Number of meetings of one of them.
    left: usize,
}

/// A change of the triangles around a vertex.
#[derive(Clone, Copy)]
enum Change {
    None,
    JoinTo(u32),
    MoveTo(DVec3),
}

/// A triangle and its box.
type Boxed = ([u32; 3], [DVec3; 2]);

impl Loose {
    /// Makes the change of the triangles around a vertex after which the fewest of them meet
    /// others, if that is fewer than before; the first of several.
    fn visit(&mut self, vertex: u32) -> Visit {
        if self.surface.around(vertex).len() > LARGEST_STAR {
            return Visit {
                is_changed: false,
                left: 1,
            };
        }
        let star: Vec<[u32; 3]> = self
            .surface
            .around(vertex)
            .map(|(_, corners)| corners)
            .collect();
        let mut others = self.others(vertex);
        // Those that meet now come first: most changes leave them meeting, and are soon given up.
        let boxed: Vec<Boxed> = star.iter().map(|&one| (one, self.box_of(one))).collect();
        others.sort_by_cached_key(|other| !boxed.iter().any(|one| self.meet([one, other])));
        let now = self.meetings(&star, &others, usize::MAX);
        let mut best = (now, Change::None);
        if now == 0 {
            return Visit {
                is_changed: false,
                left: 0,
            };
        }
        let place = self.positions[vertex as usize];
        let neighbours: BTreeSet<u32> = star.iter().flatten().copied().collect();
        for &kept in &neighbours {
            let length = self.positions[kept as usize].distance(place);
            if length > self.farthest_step() || !self.surface.may_collapse(kept, vertex) {
                continue;
            }
            let joined = star.iter().filter(|corners| !corners.contains(&kept));
            let joined: Vec<[u32; 3]> = joined
                .map(|corners| corners.map(|v| if v == vertex { kept } else { v }))
                .collect();
            let count = self.meetings(&joined, &others, best.0);
            if count < best.0 {
                best = (count, Change::JoinTo(kept));
            }
        }
        for step in STEPS {
            for direction in directions() {
                if best.0 == 0 {
                    break;
                }
                let there = self.precision.round(place + direction * (step * self.unit));
                let is_taken = |corner: &u32| {
                    *corner != vertex
                        && self.positions[*corner as usize].distance(there) <= 2.0 * self.weld
                };
                let near = others.iter().map(|(corners, _)| corners).chain(&star);
                if near.flatten().any(is_taken) {
                    continue;
                }
                self.positions[vertex as usize] = there;
                let count = self.meetings(&star, &others, best.0);
                if count < best.0 {
                    best = (count, Change::MoveTo(there));
                }
                self.positions[vertex as usize] = place;
            }
        }
        self.meetings -= now - best.0;
        self.make(vertex, best.1);
        Visit {
            is_changed: !matches!(best.1, Change::None),
            left: best.0,
        }
    }

    fn make(&mut self, vertex: u32, change: Change) {
        let was = self.positions[vertex as usize];
        let changed = match change {
            Change::None => return,
            Change::JoinTo(kept) => {
                self.surface.collapse(kept, vertex);
                kept
            }
            Change::MoveTo(there) => {
                self.positions[vertex as usize] = there;
                vertex
            }
        };
        let by = self.moved[vertex as usize] + self.positions[changed as usize].distance(was);
        let moved = &mut self.moved[changed as usize];
        *moved = moved.max(by);
        self.farthest = self.farthest.max(*moved);
    }

    /// The longest displacement of one change.
    fn farthest_step(&self) -> f64 {
        2.0 * STEPS[STEPS.len() - 1] * self.unit
    }

    /// The triangles that those around a vertex may meet before or after a change, without these.
    fn others(&self, vertex: u32) -> Vec<Boxed> {
        // All of these may have moved since the tree was built.
        let pad = DVec3::splat(self.farthest_step() + 2.0 * self.farthest);
        let mut near = BTreeSet::new();
        for (_, corners) in self.surface.around(vertex) {
            let [low, high] = self.box_of(corners);
            self.tree
                .for_each_in_box([low - pad, high + pad], |triangle| {
                    near.insert(triangle);
                });
        }
        let corners = near
            .into_iter()
            .filter_map(|triangle| self.surface.triangle(triangle));
        let others = corners.filter(|corners| !corners.contains(&vertex));
        others
            .map(|corners| (corners, self.box_of(corners)))
            .collect()
    }

    fn box_of(&self, corners: [u32; 3]) -> [DVec3; 2] {
        triangle_box(corners.map(|v| self.positions[v as usize]))
    }

    /// Number of pairs of triangles of `star`, or of one of them and one of `others`, that meet
    /// elsewhere than in common corners and edges; counted up to `most`.
    fn meetings(&self, star: &[[u32; 3]], others: &[Boxed], most: usize) -> usize {
        let star = star.iter().map(|&corners| (corners, self.box_of(corners)));
        let star: Vec<Boxed> = star.collect();
        let with_others = others
            .iter()
            .flat_map(|other| star.iter().map(move |one| [one, other]));
        let among = (0..star.len()).flat_map(|i| star[..i].iter().zip(repeat(&star[i])));
        let pairs = with_others.chain(among.map(<[&Boxed; 2]>::from));
        pairs.filter(|&pair| self.meet(pair)).take(most).count()
    }

    /// Whether two triangles meet elsewhere than in common corners and edges.
    fn meet(&self, [(one, box_of_one), (other, box_of_other)]: [&Boxed; 2]) -> bool {
        boxes_meet(*box_of_one, *box_of_other) && meeting(&self.positions, [*one, *other]).is_some()
    }
}

/// Along the axes, and along the diagonals of the planes and of space between them.
fn directions() -> impl Iterator<Item = DVec3> {
    let along = |number: u32| f64::from(number % 3) - 1.0;
    let all =
        (0..27).map(move |number| DVec3::new(along(number), along(number / 3), along(number / 9)));
    all.filter(|&direction| direction != DVec3::ZERO)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::{cuboid, drum};
    use crate::surface::{is_closed, volume_and_area};

    /// A unit cube, and another one that begins at `offset`.
    fn two_cubes(offset: DVec3) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let (mut positions, mut triangles) = cuboid(DVec3::ZERO, DVec3::ONE);
        let (more, others) = cuboid(offset, offset + DVec3::ONE);
        positions.extend(more);
        triangles.extend(others.iter().map(|t| t.map(|v| v + 8)));
        (positions, triangles)
    }

    fn apart(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Loosened {
        let work = Work::UNWATCHED;
        let apart = loosened(positions, triangles, Precision::Double, work).expect("unwatched");
        assert_eq!(apart.meetings, 0);
        let tree = SurfaceTree::new(&apart.positions, &apart.triangles);
        assert_eq!(tree.meetings(), []);
        assert!(is_closed(&apart.triangles), "without a gap");
        apart
    }

    #[test]
    fn a_boundary_that_does_not_meet_itself_stays_as_it_is() {
        let drum = drum(12, 3);
        let same = apart(drum.positions().to_vec(), drum.triangles().to_vec());
        assert_eq!(same.positions, drum.positions());
        assert_eq!(same.triangles, drum.triangles());
        assert_eq!(same.largest_move, 0.0);
    }

    #[test]
    fn sheets_that_pass_each_other_by_a_rounding_come_apart() {
        for by in [1e-15, 1e-12, 1e-10] {
            let (positions, triangles) = two_cubes(DVec3::new(1.0 - by, 0.25, 0.125));
            let apart = apart(positions, triangles);
            assert_eq!(apart.triangles.len(), 24, "two cubes still");
            let moved = apart.largest_move;
            assert!(moved > by && moved < 3e-7, "by {by:e}: moved {moved:e}");
        }
    }

    #[test]
    fn what_no_small_move_parts_is_arranged_again() {
        let (positions, triangles) = two_cubes(DVec3::new(0.5, 0.25, 0.125));
        let work = Work::UNWATCHED;
        let before = loosened(
            positions.clone(),
            triangles.clone(),
            Precision::Double,
            work,
        );
        assert!(before.expect("unwatched").meetings > 0);
        let (one, _) =
            arranged_again(&positions, &triangles, Precision::Double, work).expect("closed");
        let all = one.triangles.iter().copied();
        let (volume, _) = volume_and_area(&one.positions, all, DVec3::ZERO);
        let expected = 2.0 - 0.5 * 0.75 * 0.875;
        assert!((volume - expected).abs() < 1e-6, "{volume}");
        apart(one.positions, one.triangles);
    }
}
