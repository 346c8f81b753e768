//! A tree of boxes over the triangles of a surface.

use super::corners::triangle_box;
use super::outward::outward;
use crate::numeric::index;
use crate::numeric::tolerance::UNIT_ROUNDOFF;
use crate::watch::{Interrupted, Work, unwatched};
use glam::{DVec2, DVec3};
use obvhs::{Boundable, BvhBuildParams, aabb::Aabb, bvh2::builder::build_bvh2};
use std::time::Duration;

/// Most triangles per leaf. Fewer make a deeper tree, more make more tests per leaf; from 2 to 8
/// the measured times are alike.
const TRIANGLES_PER_LEAF: u32 = 4;

/// A surface of triangles under a tree of boxes, for queries by box, segment, ray and distance.
///
/// Holds its own copy of the surface. The result of the build depends only on the input.
#[derive(Debug, Clone)]
pub struct SurfaceTree {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    /// All nodes, the root first; empty for a surface without triangles.
    nodes: Vec<TreeNode>,
    /// Triangle indices; those of a leaf are adjacent.
    leaf_triangles: Vec<u32>,
    frame: Frame,
}

/// A box in the frame of the tree, and what it holds.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TreeNode {
    min: [f32; 3],
    max: [f32; 3],
    first: u32,
    /// Number of triangles in a leaf; 0 for an inner node.
    count: u32,
}

/// What a node of the tree holds.
pub(crate) enum Content<'a> {
    /// Indices of two nodes.
    Children([u32; 2]),
    /// Indices of triangles.
    Triangles(&'a [u32]),
}

/// The frame of the boxes: centred on the surface and scaled to it, so that single precision
/// resolves a small body far from the origin, and neither overflows nor underflows.
#[derive(Debug, Clone, Copy)]
struct Frame {
    centre: DVec3,
    /// A power of two: scaling is exact.
    scale: f64,
}

/// Largest margin of a box while the tree is built, as a fraction of its size: enough to separate
/// neighbours of equal or slowly growing size.
const MARGIN: f64 = 0.05;

/// A number in [0, 1) that looks random and depends only on the index.
fn scattered(index: u32) -> f64 {
    // Knuth's multiplicative hash: 2^32 over the golden ratio.
    f64::from(index.wrapping_mul(2_654_435_761)) * 0.5_f64.powi(32)
}

struct Leaf(Aabb);

impl Boundable for Leaf {
    fn aabb(&self) -> Aabb {
        self.0
    }
}

impl SurfaceTree {
    /// - `positions`: #V finite points.
    /// - `triangles`: #F triples of indices into `positions`, all in range.
    ///
    /// # Cost
    /// O(#F log #F), on one thread: about half a microsecond per triangle.
    pub fn new(positions: &[DVec3], triangles: &[[u32; 3]]) -> SurfaceTree {
        SurfaceTree::with_leaves(positions, triangles, TRIANGLES_PER_LEAF)
    }

    /// [`SurfaceTree::new`] as a part of some work.
    pub(crate) fn during(
        work: Work,
        positions: &[DVec3],
        triangles: &[[u32; 3]],
    ) -> Result<SurfaceTree, Interrupted> {
        SurfaceTree::build(
            positions.to_vec(),
            triangles.to_vec(),
            TRIANGLES_PER_LEAF,
            |boxed| boxed,
            work,
        )
    }

    /// [`SurfaceTree::new`] with at most `most` triangles per leaf.
    pub(crate) fn with_leaves(
        positions: &[DVec3],
        triangles: &[[u32; 3]],
        most: u32,
    ) -> SurfaceTree {
        let (positions, triangles) = (positions.to_vec(), triangles.to_vec());
        unwatched(|work| SurfaceTree::build(positions, triangles, most, |boxed| boxed, work))
    }

    /// Segments in the plane z = 0, as triangles that repeat their last corner.
    ///
    /// - `positions`: #V finite points; `segments`: #E pairs of indices into them, all in range.
    ///
    /// # Cost
    /// O(#E log #E), on one thread: about a microsecond per segment.
    pub(crate) fn of_segments(positions: &[DVec2], segments: &[[u32; 2]]) -> SurfaceTree {
        let positions = positions.iter().map(|p| p.extend(0.0)).collect();
        let triangles = segments.iter().map(|&[from, to]| [from, to, to]).collect();
        // The builder weighs boxes by their area, and flat ones have almost none. The frame reaches
        // from -1 to 1.
        let raised = |[min, max]: [DVec3; 2]| [min.with_z(-1.0), max.with_z(1.0)];
        unwatched(|work| SurfaceTree::build(positions, triangles, TRIANGLES_PER_LEAF, raised, work))
    }

    fn build(
        positions: Vec<DVec3>,
        triangles: Vec<[u32; 3]>,
        most: u32,
        raised: impl Fn([DVec3; 2]) -> [DVec3; 2] + Sync,
        work: Work,
    ) -> Result<SurfaceTree, Interrupted> {
        let frame = Frame::around(&positions);
        let boxes: Vec<[DVec3; 2]> = triangles
            .iter()
            .map(|corners| frame.around_triangle(corners.map(|corner| positions[corner as usize])))
            .collect();
        let mut numbers: Vec<u32> = (0..index(triangles.len())).collect();
        let builder = Builder {
            boxes: &boxes,
            most,
            raised,
            work,
        };
        let built = builder.build(&mut numbers)?;
        Ok(SurfaceTree {
            positions,
            triangles,
            nodes: built.nodes,
            leaf_triangles: built.leaf_triangles,
            frame,
        })
    }

    /// #F triples of indices, as given.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// #V points, as given.
    pub(crate) fn positions(&self) -> &[DVec3] {
        &self.positions
    }

    /// The three corners of a triangle.
    pub fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.triangles[triangle as usize].map(|corner| self.positions[corner as usize])
    }

    /// Every triangle whose box meets the closed box `[min, max]`, and perhaps a few whose box just
    /// misses it.
    ///
    /// Each is visited once, in an order that depends on the surface only.
    pub fn for_each_in_box(&self, [min, max]: [DVec3; 2], visit: impl FnMut(u32)) {
        let [low, high] = self.frame.enclose([min, max]);
        self.traverse(
            |node| node.min().cmple(high).all() && node.max().cmpge(low).all(),
            visit,
        );
    }

    /// Every triangle whose box comes within `radius` of the segment from `start` to `end`, and
    /// perhaps a few others.
    pub fn for_each_near_segment(
        &self,
        start: DVec3,
        end: DVec3,
        radius: f64,
        visit: impl FnMut(u32),
    ) {
        let (start, end) = (self.frame.local(start), self.frame.local(end));
        let middle = (start + end) * 0.5;
        let half = (end - start) * 0.5;
        let reach = half.abs();
        // Covers the rounding of the coordinates and of the products below: each is off by a few
        // unit roundoffs of the largest coordinate, and the boxes have coordinates up to 1.
        let slack = SEGMENT_ROUNDING
            * UNIT_ROUNDOFF
            * (middle.abs().max_element() + reach.max_element() + 1.0);
        let pad = DVec3::splat(radius * self.frame.scale + slack);
        let near = |node: &TreeNode| {
            let (low, high) = (node.min(), node.max());
            let extent = (high - low) * 0.5 + pad;
            let offset = middle - (high + low) * 0.5;
            // Separating axes of a segment and a box: the axes of the box ...
            if offset.abs().cmpgt(extent + reach).any() {
                return false;
            }
            // ... and their products with the direction.
            let across = offset.cross(half).abs();
            let limit = DVec3::new(
                extent.y * reach.z + extent.z * reach.y,
                extent.z * reach.x + extent.x * reach.z,
                extent.x * reach.y + extent.y * reach.x,
            );
            across.cmple(limit).all()
        };
        self.traverse(near, visit);
    }

    /// Every triangle whose box is met by the half line from `start` along a coordinate axis, and
    /// perhaps a few others.
    ///
    /// - `axis`: 0, 1 or 2. `forward`: 1 towards larger coordinates, -1 towards smaller ones.
    pub(crate) fn for_each_along_axis(
        &self,
        start: DVec3,
        axis: usize,
        forward: i32,
        visit: impl FnMut(u32),
    ) {
        let mut line = self.frame.enclose([start, start]);
        if forward > 0 {
            line[1][axis] = f64::INFINITY;
        } else {
            line[0][axis] = f64::NEG_INFINITY;
        }
        let [low, high] = line;
        self.traverse(
            |node| node.min().cmple(high).all() && node.max().cmpge(low).all(),
            visit,
        );
    }

    /// The smallest box around the surface that the tree knows, or `None` when it has no triangles.
    ///
    /// It contains the surface and exceeds it by no more than single precision of its size.
    pub fn bounds(&self) -> Option<[DVec3; 2]> {
        self.nodes.first().map(|root| self.node_bounds(root))
    }

    /// All nodes, the root first.
    pub(crate) fn nodes(&self) -> &[TreeNode] {
        &self.nodes
    }

    /// The contents of a node.
    pub(crate) fn content(&self, node: &TreeNode) -> Content<'_> {
        match node.count {
            0 => Content::Children([node.first, node.first + 1]),
            count => {
                Content::Triangles(&self.leaf_triangles[node.first as usize..][..count as usize])
            }
        }
    }

    /// The box of a node, in the coordinates of the surface; it contains all triangles below the
    /// node.
    pub(crate) fn node_bounds(&self, node: &TreeNode) -> [DVec3; 2] {
        let place = |local: DVec3| self.frame.centre + local / self.frame.scale;
        let [min, max] = [place(node.min()), place(node.max())];
        [min.map(f64::next_down), max.map(f64::next_up)]
    }

    fn traverse(&self, enter: impl Fn(&TreeNode) -> bool, mut visit: impl FnMut(u32)) {
        let Some(root) = self.nodes().first() else {
            return;
        };
        if !enter(root) {
            return;
        }
        let mut open = vec![root];
        while let Some(node) = open.pop() {
            match self.content(node) {
                Content::Triangles(triangles) => {
                    triangles.iter().for_each(|&triangle| visit(triangle))
                }
                Content::Children(children) => {
                    open.extend(
                        children
                            .iter()
                            .map(|&child| &self.nodes[child as usize])
                            .filter(|child| enter(child)),
                    );
                }
            }
        }
    }
}

/// Most triangles of one run of the builder, which uses one thread and cannot be stopped: some
/// hundredths of a second.
const AT_ONCE: usize = 1 << 16;

/// Builds a tree over some boxes.
///
/// The library's builder joins boxes that are each other's best partners. In a row of equal boxes,
/// and along a curve that is cut into pieces of slowly growing length, each box prefers the one
/// before, so that one pair is joined at a time, in quadratic time (1.9 s instead of 0.12 s for a
/// spiral of 100,000 pieces). So it gets boxes with uneven margins, and the resulting tree gets the
/// true ones.
struct Builder<'a, R> {
    boxes: &'a [[DVec3; 2]],
    /// Most boxes per leaf.
    most: u32,
    /// The box to be weighed in place of the given one.
    raised: R,
    work: Work<'a>,
}

/// A tree, or a part of one.
struct BuiltTree {
    /// The root first.
    nodes: Vec<TreeNode>,
    leaf_triangles: Vec<u32>,
}

impl<R: Fn([DVec3; 2]) -> [DVec3; 2] + Sync> Builder<'_, R> {
    /// A tree over some of the boxes: halves side by side until they are few enough, in parallel.
    fn build(&self, numbers: &mut [u32]) -> Result<BuiltTree, Interrupted> {
        self.work.check()?;
        if numbers.len() <= AT_ONCE {
            numbers.sort_unstable();
            let built = self.build_at_once(numbers);
            self.work
                .part(numbers.len() as u64, self.boxes.len() as u64)
                .done();
            return Ok(built);
        }
        let middle = |number: u32| {
            let [min, max] = self.boxes[number as usize];
            min + max
        };
        let empty = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (low, high) = numbers.iter().fold(empty, |(low, high), &number| {
            (low.min(middle(number)), high.max(middle(number)))
        });
        let axis = (high - low).max_position();
        let half = numbers.len() / 2;
        numbers.select_nth_unstable_by(half, |&one, &other| {
            let order = middle(one)[axis].total_cmp(&middle(other)[axis]);
            order.then(one.cmp(&other))
        });
        let (first, second) = numbers.split_at_mut(half);
        let (first, second) = rayon::join(|| self.build(first), || self.build(second));
        Ok(first?.beside(second?))
    }

    fn build_at_once(&self, numbers: &[u32]) -> BuiltTree {
        let boxed = |[min, max]: [DVec3; 2]| {
            let [min, max] = outward([min, max]);
            Aabb {
                min: min.into(),
                max: max.into(),
            }
        };
        let leaves: Vec<Leaf> = numbers
            .iter()
            .map(|&number| {
                let [min, max] = self.boxes[number as usize];
                let margin = (max - min) * (MARGIN * scattered(number));
                Leaf(boxed((self.raised)([min - margin, max + margin])))
            })
            .collect();
        // The builder needs a place for the time that it takes, which is not used here.
        let parameters = BvhBuildParams {
            max_prims_per_leaf: self.most,
            ..BvhBuildParams::medium_build()
        };
        let mut built = build_bvh2(&leaves, parameters, &mut Duration::default());
        let leaf_triangles: Vec<u32> = built
            .primitive_indices
            .iter()
            .map(|&place| numbers[place as usize])
            .collect();
        for node in built.nodes.iter_mut().filter(|node| node.is_leaf()) {
            let first = node.first_index as usize;
            let own = &leaf_triangles[first..][..node.prim_count as usize];
            let around = own
                .iter()
                .map(|&number| boxed(self.boxes[number as usize]))
                .reduce(|one, other| one.union(&other));
            node.set_aabb(around.unwrap_or(Aabb::empty()));
        }
        built.refit_all();
        let nodes = built
            .nodes
            .iter()
            .map(|node| TreeNode {
                min: node.aabb().min.to_array(),
                max: node.aabb().max.to_array(),
                first: node.first_index,
                count: node.prim_count,
            })
            .collect();
        BuiltTree {
            nodes,
            leaf_triangles,
        }
    }
}

impl BuiltTree {
    /// A tree of two, none of which is empty. Their roots come right after the new one, and then
    /// the other nodes of the first, and those of the second.
    fn beside(self, other: BuiltTree) -> BuiltTree {
        let count = index(self.nodes.len());
        let shift = index(self.leaf_triangles.len());
        let moved = |node: TreeNode, nodes: u32, triangles: u32| TreeNode {
            first: node.first + if node.count == 0 { nodes } else { triangles },
            ..node
        };
        let first = self.nodes.into_iter().map(|node| moved(node, 2, 0));
        let second = other.nodes.into_iter();
        let second = second.map(|node| moved(node, count + 1, shift));
        let (mut roots, mut rest) = (Vec::new(), Vec::new());
        for mut nodes in [first.collect::<Vec<_>>(), second.collect()] {
            rest.extend(nodes.drain(1..));
            roots.extend(nodes);
        }
        let corner = |pick: fn(f32, f32) -> f32, of: fn(&TreeNode) -> [f32; 3]| {
            let [one, other] = [of(&roots[0]), of(&roots[1])];
            [0, 1, 2].map(|axis| pick(one[axis], other[axis]))
        };
        let root = TreeNode {
            min: corner(f32::min, |node| node.min),
            max: corner(f32::max, |node| node.max),
            first: 1,
            count: 0,
        };
        let mut leaf_triangles = self.leaf_triangles;
        leaf_triangles.extend(other.leaf_triangles);
        BuiltTree {
            nodes: [vec![root], roots, rest].concat(),
            leaf_triangles,
        }
    }
}

/// Unit roundoffs by which the coordinates and products of the segment test may be off, rounded up.
const SEGMENT_ROUNDING: f64 = 16.0;

impl TreeNode {
    /// Whether the boxes of two nodes of one tree have a point in common.
    pub(super) fn meets(&self, other: &TreeNode) -> bool {
        (0..3).all(|i| self.min[i] <= other.max[i] && other.min[i] <= self.max[i])
    }

    fn min(&self) -> DVec3 {
        DVec3::from_array(self.min.map(f64::from))
    }

    fn max(&self) -> DVec3 {
        DVec3::from_array(self.max.map(f64::from))
    }
}

impl Frame {
    fn around(positions: &[DVec3]) -> Frame {
        let empty = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (min, max) = positions
            .iter()
            .fold(empty, |(min, max), &p| (min.min(p), max.max(p)));
        let half = (max * 0.5 - min * 0.5).max_element();
        if !(half.is_finite() && half > 0.0) {
            return Frame {
                centre: positions.first().copied().unwrap_or(DVec3::ZERO),
                scale: 1.0,
            };
        }
        // 2^1000 keeps the scale and its inverse finite; coordinates then stay within (0.5, 1].
        let scale = (-half.log2().ceil().clamp(-1000.0, 1000.0)).exp2();
        Frame {
            centre: min * 0.5 + max * 0.5,
            scale,
        }
    }

    /// Coordinates in the frame, rounded to nearest.
    fn local(&self, point: DVec3) -> DVec3 {
        (point - self.centre) * self.scale
    }

    /// A box in the frame that contains a triangle.
    fn around_triangle(&self, corners: [DVec3; 3]) -> [DVec3; 2] {
        self.enclose(triangle_box(corners))
    }

    /// A box in the frame that contains the given one.
    fn enclose(&self, [min, max]: [DVec3; 2]) -> [DVec3; 2] {
        // Both operations round to nearest, and only one of them is inexact: the next value is
        // beyond the true one.
        [
            self.local(min).map(f64::next_down),
            self.local(max).map(f64::next_up),
        ]
    }
}
