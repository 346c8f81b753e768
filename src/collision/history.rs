//! The distance between a moving body and its obstacles at given times: a curve to look at, not a proof.

use super::Obstacle;
use super::nearest::{Nearest, nearest};
use crate::body::Mesh;
use crate::bounds::{Content, Location, SurfaceTree};
use crate::motion::Motion;
use glam::{DAffine3, DVec3};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// A moving body and the obstacles that it must not touch, prepared for [`History::distance_at`].
#[derive(Debug, Clone)]
pub struct History<'a> {
    body: Carried<'a>,
    /// With their numbers in the list of obstacles.
    obstacles: Vec<(usize, Carried<'a>)>,
}

/// How close the body is to the nearest obstacle at some time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Closeness {
    /// Distance between body and obstacle; 0 in contact, and where one is inside the other.
    pub distance: f64,
    /// Number of the obstacle.
    pub obstacle: usize,
    /// The nearest points of body and obstacle, in the world; one point in contact.
    pub points: [DVec3; 2],
}

/// A surface and what carries it.
#[derive(Debug, Clone)]
struct Carried<'a> {
    tree: SurfaceTree,
    /// `None`: it rests in the world.
    motion: Option<&'a Motion>,
    /// Whether it bounds a solid.
    closed: bool,
    /// A vertex of each piece that is joined across vertices.
    pieces: Vec<DVec3>,
}

impl<'a> History<'a> {
    /// - `obstacles`: what the body is to be kept away from.
    /// - `allowed`: per obstacle, whether it may be touched and is left out; empty when none may.
    ///
    /// # Cost
    /// O(n log n) for all triangles together.
    pub fn new(
        body: &Mesh,
        motion: &'a Motion,
        obstacles: &[Obstacle<'a>],
        allowed: &[bool],
    ) -> History<'a> {
        let is_allowed = |index: usize| allowed.get(index).copied().unwrap_or(false);
        let obstacles = obstacles
            .iter()
            .enumerate()
            .filter(|(index, _)| !is_allowed(*index))
            .map(|(index, Obstacle { surface, motion })| {
                let (positions, triangles) = (surface.positions(), surface.triangles());
                let closed = surface.closed();
                (index, Carried::new(positions, triangles, *motion, closed))
            })
            .collect();
        History {
            body: Carried::new(body.positions(), body.triangles(), Some(motion), true),
            obstacles,
        }
    }

    /// How close the body is at a time of the motion's clock, `None` without obstacles; of equally near obstacles the first.
    ///
    /// # Guarantee
    /// The distance is that of two points, to rounding, and there are no nearer ones.
    ///
    /// # Cost
    /// A search over two trees; some 20 microseconds for 1,000 triangles on both sides.
    pub fn distance_at(&self, time: f64) -> Option<Closeness> {
        let pose = self.body.pose_at(time);
        let mut best: Option<Closeness> = None;
        for (obstacle, carried) in &self.obstacles {
            let other = carried.pose_at(time);
            let limit = best.map_or(f64::INFINITY, |best| best.distance);
            let found = match overlap([&self.body, carried], [&pose, &other]) {
                Some(point) => Some((0.0, [point; 2])),
                None => closest([&self.body, carried], [&pose, &other], limit)
                    .map(|nearest| (nearest.distance(), nearest.points)),
            };
            if let Some((distance, points)) = found
                && best.is_none_or(|best| distance < best.distance)
            {
                best = Some(Closeness {
                    distance,
                    obstacle: *obstacle,
                    points,
                });
            }
        }
        best
    }
}

impl<'a> Carried<'a> {
    fn new(
        positions: &[DVec3],
        triangles: &[[u32; 3]],
        motion: Option<&'a Motion>,
        closed: bool,
    ) -> Carried<'a> {
        Carried {
            tree: SurfaceTree::new(positions, triangles),
            motion,
            closed,
            pieces: pieces(positions.len(), triangles)
                .map(|v| positions[v])
                .collect(),
        }
    }

    fn pose_at(&self, time: f64) -> DAffine3 {
        self.motion
            .map_or(DAffine3::IDENTITY, |motion| motion.pose_at_time(time))
    }

    /// World box of a node.
    fn bounds(&self, node: u32, pose: &DAffine3) -> [DVec3; 2] {
        let [low, high] = self.tree.node_bounds(&self.tree.nodes()[node as usize]);
        let centre = pose.transform_point3(low.midpoint(high));
        let half = 0.5 * (high - low);
        let linear = pose.matrix3;
        let reach = linear.x_axis.abs() * half.x
            + linear.y_axis.abs() * half.y
            + linear.z_axis.abs() * half.z;
        [centre - reach, centre + reach]
    }
}

/// The first vertex of each set of triangles that hang together by their vertices.
fn pieces(vertices: usize, triangles: &[[u32; 3]]) -> impl Iterator<Item = usize> {
    let mut parent: Vec<usize> = (0..vertices).collect();
    let mut used = vec![false; vertices];
    fn root(parent: &mut [usize], mut v: usize) -> usize {
        while parent[v] != v {
            // Path halving: every visited vertex skips one step from now on.
            parent[v] = parent[parent[v]];
            v = parent[v];
        }
        v
    }
    for triangle in triangles {
        let [a, b, c] = triangle.map(|v| root(&mut parent, v as usize));
        let first = a.min(b).min(c);
        for v in [a, b, c] {
            parent[v] = first;
        }
        triangle.iter().for_each(|&v| used[v as usize] = true);
    }
    (0..vertices).filter(move |&v| used[v] && parent[v] == v)
}

/// A point of one that is inside the other: when the surfaces do not meet, pieces are inside or outside as a whole.
fn overlap([a, b]: [&Carried<'_>; 2], [pose_a, pose_b]: [&DAffine3; 2]) -> Option<DVec3> {
    let inside = |inner: &Carried<'_>,
                  pose: &DAffine3,
                  outer: &Carried<'_>,
                  outer_pose: &DAffine3| {
        if !outer.closed {
            return None;
        }
        let to_outer = outer_pose.inverse();
        inner
            .pieces
            .iter()
            .map(|&point| pose.transform_point3(point))
            .find(|&point| outer.tree.locate(to_outer.transform_point3(point)) == Location::Inside)
    };
    inside(a, pose_a, b, pose_b).or_else(|| inside(b, pose_b, a, pose_a))
}

/// Nearest points of two surfaces, `None` when they are not nearer than `limit`.
fn closest(surfaces: [&Carried<'_>; 2], poses: [&DAffine3; 2], limit: f64) -> Option<Nearest> {
    let mut best: Option<Nearest> = None;
    let mut limit_squared = limit * limit;
    let mut open = BinaryHeap::new();
    let candidate = |nodes: [u32; 2]| {
        let boxes = [0, 1].map(|i| surfaces[i].bounds(nodes[i], poses[i]));
        Candidate::new(nodes, boxes)
    };
    if surfaces
        .iter()
        .all(|surface| !surface.tree.nodes().is_empty())
    {
        open.push(candidate([0, 0]));
    }
    while let Some(Candidate {
        gap_squared,
        nodes,
        sizes,
    }) = open.pop()
    {
        if gap_squared >= limit_squared {
            break;
        }
        let contents = [0, 1].map(|i| {
            let tree = &surfaces[i].tree;
            tree.content(&tree.nodes()[nodes[i] as usize])
        });
        match contents {
            [Content::Triangles(left), Content::Triangles(right)] => {
                let corners = |i: usize, triangle: u32| {
                    let tree = &surfaces[i].tree;
                    tree.corners(triangle).map(|p| poses[i].transform_point3(p))
                };
                let rights: Vec<[DVec3; 3]> = right.iter().map(|&g| corners(1, g)).collect();
                for &f in left {
                    let a = corners(0, f);
                    for b in &rights {
                        // Faces that lie side by side have many pairs that are all equally near.
                        if gap([box_of(&a), box_of(b)]).length_squared() >= limit_squared {
                            continue;
                        }
                        let found = nearest(&a, b);
                        if found.distance_squared < limit_squared {
                            limit_squared = found.distance_squared;
                            best = Some(found);
                        }
                    }
                }
            }
            // The larger box says less: it is opened first.
            [Content::Children(children), Content::Triangles(_)] => {
                open.extend(children.map(|child| candidate([child, nodes[1]])));
            }
            [Content::Children(children), Content::Children(_)] if sizes[0] >= sizes[1] => {
                open.extend(children.map(|child| candidate([child, nodes[1]])));
            }
            [_, Content::Children(children)] => {
                open.extend(children.map(|child| candidate([nodes[0], child])));
            }
        }
    }
    best
}

/// Two nodes that may hold the nearest points.
struct Candidate {
    /// Square of the distance of their boxes.
    gap_squared: f64,
    nodes: [u32; 2],
    /// Squared diagonals of the boxes.
    sizes: [f64; 2],
}

impl Candidate {
    fn new(nodes: [u32; 2], boxes: [[DVec3; 2]; 2]) -> Candidate {
        Candidate {
            gap_squared: gap(boxes).length_squared(),
            nodes,
            sizes: boxes.map(|[low, high]| low.distance_squared(high)),
        }
    }
}

/// From box to box.
fn gap([[low_a, high_a], [low_b, high_b]]: [[DVec3; 2]; 2]) -> DVec3 {
    (low_a - high_b).max(low_b - high_a).max(DVec3::ZERO)
}

fn box_of(&[a, b, c]: &[DVec3; 3]) -> [DVec3; 2] {
    [a.min(b).min(c), a.max(b).max(c)]
}

/// Nearest first; of equally near ones, as boxes are that overlap, the smallest, which lead down to triangles; then by number.
/// The order of the search, and with it the result, depends on nothing else.
impl Ord for Candidate {
    fn cmp(&self, other: &Candidate) -> Ordering {
        let by_gap = other.gap_squared.total_cmp(&self.gap_squared);
        let size = |candidate: &Candidate| candidate.sizes[0] + candidate.sizes[1];
        by_gap
            .then_with(|| size(other).total_cmp(&size(self)))
            .then_with(|| other.nodes.cmp(&self.nodes))
    }
}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Candidate) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Candidate) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Candidate {}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::Surface;
    use crate::motion::{Generator, Span};

    /// A box as a mesh.
    fn a_box(low: DVec3, high: DVec3) -> Mesh {
        let corner = |i: usize| {
            DVec3::new(
                if i & 1 == 0 { low.x } else { high.x },
                if i & 2 == 0 { low.y } else { high.y },
                if i & 4 == 0 { low.z } else { high.z },
            )
        };
        let quads = [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ];
        let triangles = quads
            .into_iter()
            .flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]])
            .collect();
        Mesh::new((0..8).map(corner).collect(), triangles).expect("a box is a body")
    }

    fn motion(generator: Generator) -> Motion {
        Motion::from_spans(vec![Span::new(generator, 2.0).expect("finite")]).expect("one span")
    }

    #[test]
    fn a_box_between_two_walls_is_nearest_to_one_and_then_to_the_other() {
        let body = a_box(DVec3::ZERO, DVec3::ONE);
        let slide = motion(Generator::translation(3.0 * DVec3::X));
        let walls = [-1.0, 6.0].map(|x| {
            let corners = [[x, -9.0, -9.0], [x, 9.0, -9.0], [x, 0.0, 9.0]];
            Surface::new(corners.map(DVec3::from_array).to_vec(), vec![[0, 1, 2]]).expect("a wall")
        });
        let obstacles: Vec<Obstacle<'_>> = walls
            .iter()
            .map(|surface| Obstacle {
                surface,
                motion: None,
            })
            .collect();
        let history = History::new(&body, &slide, &obstacles, &[]);
        // 1 + 1.5 t to the one, 5 - 1.5 t to the other.
        for (time, distance, obstacle) in
            [(0.0, 1.0, 0), (1.0, 2.5, 0), (1.5, 2.75, 1), (2.0, 2.0, 1)]
        {
            let found = history.distance_at(time).expect("two walls");
            assert!(
                (found.distance - distance).abs() < 1e-14,
                "{found:?} at {time}"
            );
            assert_eq!(found.obstacle, obstacle, "at {time}");
            let [p, q] = found.points;
            assert!((p.distance(q) - found.distance).abs() < 1e-14, "{found:?}");
        }
        let allowed = History::new(&body, &slide, &obstacles, &[true, false]);
        let found = allowed.distance_at(0.0).expect("one wall");
        assert_eq!((found.distance, found.obstacle), (5.0, 1), "the other one");
        let none = History::new(&body, &slide, &obstacles, &[true, true]);
        assert_eq!(none.distance_at(0.0), None, "nothing to be close to");
    }

    #[test]
    fn inside_and_in_contact_the_distance_is_zero() {
        let body = a_box(DVec3::ZERO, DVec3::ONE);
        let rest = motion(Generator::translation(DVec3::ZERO));
        for (low, high, expected) in [
            (-5.0, 5.0, 0.0),
            (0.25, 0.75, 0.0),
            (0.5, 3.0, 0.0),
            (2.0, 3.0, 3f64.sqrt()),
        ] {
            let surface = Surface::from(&a_box(DVec3::splat(low), DVec3::splat(high)));
            let obstacles = [Obstacle {
                surface: &surface,
                motion: None,
            }];
            let found = History::new(&body, &rest, &obstacles, &[])
                .distance_at(1.0)
                .expect("an obstacle");
            assert!(
                (found.distance - expected).abs() < 1e-14,
                "{low}..{high}: {found:?}"
            );
        }
        // Only a solid has an inside; the body is one.
        let lid = |mesh: Mesh| {
            let triangles = mesh.triangles()[2..].to_vec();
            Surface::new(mesh.positions().to_vec(), triangles).expect("a surface")
        };
        let room = lid(a_box(DVec3::splat(-5.0), DVec3::splat(5.0)));
        let seed = lid(a_box(DVec3::splat(0.25), DVec3::splat(0.75)));
        for (surface, expected) in [(&room, 4.0), (&seed, 0.0)] {
            let obstacles = [Obstacle {
                surface,
                motion: None,
            }];
            let history = History::new(&body, &rest, &obstacles, &[]);
            let found = history.distance_at(0.0).expect("an obstacle");
            assert_eq!(found.distance, expected, "{found:?}");
        }
    }

    #[test]
    fn the_search_finds_what_all_pairs_of_triangles_give() {
        // Stretched and sheared, so that boxes in the frames of the bodies say little.
        let body = a_box(DVec3::new(1.0, -2.0, 0.5), DVec3::new(1.5, -1.0, 3.0));
        let surface = Surface::from(&a_box(
            DVec3::new(-2.0, 3.0, -1.0),
            DVec3::new(0.0, 4.0, 2.0),
        ));
        let spiral = motion(Generator::screw(
            DVec3::new(1.0, 2.0, -1.0),
            DVec3::Y,
            5.0,
            1.5,
            0.4,
        ));
        let shear = Generator {
            linear: glam::DMat3::from_cols(DVec3::ZERO, 0.5 * DVec3::X, 0.3 * DVec3::Y),
            offset: DVec3::Z,
        };
        let shear = motion(shear);
        let obstacles = [Obstacle {
            surface: &surface,
            motion: Some(&shear),
        }];
        let history = History::new(&body, &spiral, &obstacles, &[]);
        for step in 0..=40 {
            let time = f64::from(step) / 20.0;
            let found = history.distance_at(time).expect("an obstacle").distance;
            let poses = [spiral.pose_at_time(time), shear.pose_at_time(time)];
            let mut expected = f64::INFINITY;
            for f in body.triangles() {
                let a = f.map(|v| poses[0].transform_point3(body.positions()[v as usize]));
                for g in surface.triangles() {
                    let b = g.map(|v| poses[1].transform_point3(surface.positions()[v as usize]));
                    expected = expected.min(nearest(&a, &b).distance());
                }
            }
            assert!(
                (found - expected).abs() < 1e-12,
                "{found} not {expected} at {time}"
            );
        }
    }
}
