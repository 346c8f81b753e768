//! Shallow folds of polygons: changes of sign that are dropped, and the proof that only a layer is
//! lost by that.
//!
//! A first integral h of the flow (constant along its paths, growing to their left) makes an
//! outline a function h(u) of its arc length: egress where h grows, ingress where it falls. A
//! finely divided outline that slides along itself zigzags: h falls a little and grows again, and
//! both changes of sign would sweep paths closer to each other than their sampling error.
//!
//! # What may be dropped
//! Write the outline as (s, h), s along the paths. Along a stretch that is to count as egress, let
//! h'(u) be a function that grows, with |h' - h| at most the depth d, below h where the outline
//! runs along the motion (s grows: the body lies above), and above h where it runs against it. The
//! outline (s, h') encloses a body B'. It contains the body B, since the outline was only moved
//! outwards, and its exact signs are the chosen ones. So the sweep of B lies in that of B', which
//! is {w >= 1} of the cycle of B'. That cycle is the chosen one up to a homotopy that moves no
//! point farther than d times the growth of lengths. Such an h' exists if and only if
//! low(u) <= high(v) for all u <= v on the stretch, where
//!
//! > along the motion low = h - d, high = h; against it low = h, high = h + d;
//!
//! for ingress with u and v exchanged. In particular, a needle that points along the motion is
//! never dropped, however thin.
//!
//! # How
//! Runs of one sign are merged with their two neighbours, shallowest first, while the merged
//! stretch satisfies the condition. To first order in the depth, h is the integral of flux / |v|,
//! with lengths across the paths scaled by their divergence. Each merged stretch is then checked
//! along exact paths. Where the check fails, all is done again with half the depth there, and in
//! the end the stretch gets its own signs back.
//!
//! Where the field turns too much within the depth, near a point at rest, h' = h. Such a piece may
//! be part of a stretch of its own sign, which must meet its height on either side; it never takes
//! the other sign. Long edges are divided, so that such pieces are small.

use super::heights::{FIRST_ORDER, Heights, SignedPiece, pieces};
use crate::grazing::flux::EdgeFlux;
use crate::motion::planar::{Flow, Generator};
use crate::numeric::tolerance::SAME_POSE;
use glam::DVec2;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Share of the depth that is used in that check: distances are measured along straight lines,
/// while the outline moves along a curve that is at most this much longer, see
/// [`FOLD_CURVATURE`](crate::numeric::tolerance::FOLD_CURVATURE).
const STRAIGHT: f64 = 0.98;

/// A loop with its chosen signs.
pub(super) struct Flattened {
    /// The sign of the flux per edge.
    pub(super) edges: Vec<EdgeFlux>,
    /// Largest distance to the outline of the larger body; 0 when nothing was dropped.
    pub(super) depth: f64,
}

/// Drops the folds of one loop that are shallower than `fold`.
///
/// - `corners`, `fluxes`: those of the loop; edge i runs from corner i to the next one.
///
/// O(n log n).
pub(super) fn flattened(
    corners: &[DVec2],
    fluxes: &[EdgeFlux],
    generator: &Generator,
    fold: f64,
) -> Flattened {
    let kept = Flattened {
        edges: fluxes.to_vec(),
        depth: 0.0,
    };
    let mut pieces = pieces(corners, fluxes, generator, fold);
    let mut share = FIRST_ORDER;
    let FlattenedSigns { is_egress, depth } = loop {
        let mut runs = SignRuns::of(&pieces);
        if runs.list.len() < 2 {
            return kept;
        }
        runs.merge(fold);
        let (signs, refused) = runs.signs(&pieces, fold, generator);
        share *= 0.5;
        if refused.is_empty() || share < LEAST_SHARE {
            break signs;
        }
        for i in refused {
            pieces[i].height = pieces[i].heights(generator, share * fold);
        }
    };
    let mut edges = kept.edges;
    if depth > 0.0 {
        let mut first_sign = vec![None; edges.len()];
        let mut last_sign = vec![false; edges.len()];
        for (piece, &egress) in pieces.iter().zip(&is_egress) {
            first_sign[piece.edge].get_or_insert(egress);
            last_sign[piece.edge] = egress;
        }
        for ((flux, first), last) in edges.iter_mut().zip(first_sign).zip(last_sign) {
            if first == Some(last) {
                *flux = if last {
                    EdgeFlux::Egress
                } else {
                    EdgeFlux::Ingress
                };
            }
        }
    }
    Flattened { edges, depth }
}

/// A maximal sequence of pieces of one sign.
#[derive(Debug, Clone, Copy)]
struct SignRun {
    egress: bool,
    height: Heights,
    /// First piece, and one past the last, cyclically.
    pieces: [usize; 2],
    /// The neighbours in the loop.
    before: usize,
    after: usize,
    /// How often it has changed; `None` once it is part of another run.
    version: Option<u32>,
    /// The largest rise or fall of a merged run with the other sign; `None` when there is none.
    deepest: Option<f64>,
}

/// The runs of a loop.
struct SignRuns {
    list: Vec<SignRun>,
    alive: usize,
}

impl SignRuns {
    fn of(pieces: &[SignedPiece]) -> SignRuns {
        let count = pieces.len();
        let starts: Vec<usize> = (0..count)
            .filter(|&i| pieces[i].egress != pieces[(i + count - 1) % count].egress)
            .collect();
        let alive = starts.len();
        let list = starts
            .iter()
            .enumerate()
            .map(|(run, &start)| {
                let end = starts.get(run + 1).copied().unwrap_or(starts[0] + count);
                let heights = (start..end).map(|i| pieces[i % count].height);
                SignRun {
                    egress: pieces[start].egress,
                    height: heights.reduce(Heights::then).expect("a run has pieces"),
                    pieces: [start, end],
                    before: (run + alive - 1) % alive,
                    after: (run + 1) % alive,
                    version: Some(0),
                    deepest: None,
                }
            })
            .collect();
        SignRuns { list, alive }
    }

    /// Merges runs that rise or fall by at most `fold` with their neighbours, shallowest first.
    fn merge(&mut self, fold: f64) {
        let mut queue: BinaryHeap<Reverse<(u64, usize, u32)>> = BinaryHeap::new();
        let depth = |run: &SignRun| run.height.rise.abs();
        // Positive numbers are ordered like their bits.
        let entry = |number: usize, run: &SignRun, version: u32| {
            (depth(run) <= fold).then(|| Reverse((depth(run).to_bits(), number, version)))
        };
        queue.extend(
            self.list
                .iter()
                .enumerate()
                .filter_map(|(number, run)| entry(number, run, 0)),
        );
        while let Some(Reverse((_, number, version))) = queue.pop() {
            let run = self.list[number];
            if run.version != Some(version) || self.alive < 2 {
                continue;
            }
            let [before, after] = [run.before, run.after];
            let egress = !run.egress;
            let through = self.list[before].height.then(run.height);
            let given_up = [
                Some(depth(&run)),
                self.list[before].deepest,
                self.list[after].deepest,
            ];
            let deepest = given_up.into_iter().flatten().reduce(f64::max);
            if before == after {
                // The whole loop is traversed twice, for all pairs.
                if through.then(through).may_be(egress) {
                    let [start, _] = self.list[before].pieces;
                    let length =
                        run.pieces[1] - run.pieces[0] + self.list[before].pieces[1] - start;
                    let whole = &mut self.list[before];
                    whole.height = through.then(through);
                    whole.pieces = [start, start + length];
                    whole.deepest = deepest;
                    whole.version = Some(u32::MAX);
                    self.list[number].version = None;
                    self.alive = 1;
                }
                continue;
            }
            let height = through.then(self.list[after].height);
            if !height.may_be(egress) {
                continue;
            }
            let next = self.list[after];
            self.list[number].version = None;
            self.list[after].version = None;
            self.list[next.after].before = before;
            let length = run.pieces[1] - run.pieces[0] + next.pieces[1] - next.pieces[0];
            let grown = &mut self.list[before];
            grown.height = height;
            grown.after = next.after;
            grown.pieces[1] += length;
            grown.deepest = deepest;
            let version = grown.version.map_or(0, |version| version + 1);
            grown.version = Some(version);
            self.alive -= 2;
            queue.extend(entry(before, &self.list[before], version));
        }
    }

    /// The signs of the pieces, and the pieces whose own signs were restored.
    fn signs(
        &self,
        pieces: &[SignedPiece],
        fold: f64,
        generator: &Generator,
    ) -> (FlattenedSigns, Vec<usize>) {
        let mut refused = Vec::new();
        let mut signs: Vec<bool> = pieces.iter().map(|piece| piece.egress).collect();
        let mut depth: f64 = 0.0;
        for run in self.list.iter().filter(|run| run.version.is_some()) {
            let Some(deepest) = run.deepest else {
                continue;
            };
            let [start, end] = run.pieces;
            let twice = if end - start == pieces.len() { 2 } else { 1 };
            let stretch: Vec<SignedPiece> = (start..start + twice * (end - start))
                .map(|i| pieces[i % pieces.len()])
                .collect();
            // Usually little more than the deepest fold is needed.
            let mut enough = (SPARE * deepest).clamp(LEAST_SHARE * fold, fold);
            let is_kept = loop {
                if keeps_condition(&stretch, run.egress, generator, enough) {
                    break true;
                }
                if enough >= fold {
                    break false;
                }
                enough = (2.0 * enough).min(fold);
            };
            if is_kept {
                depth = depth.max(enough);
                (start..end).for_each(|i| signs[i % pieces.len()] = run.egress);
            } else {
                refused.extend((start..end).map(|i| i % pieces.len()));
            }
        }
        let is_egress = signs;
        (FlattenedSigns { is_egress, depth }, refused)
    }
}

/// The chosen signs of the pieces.
struct FlattenedSigns {
    is_egress: Vec<bool>,
    /// The depth that is lost by this choice.
    depth: f64,
}

/// Factor over the first-order depth with which the condition is tried first.
const SPARE: f64 = 1.1;

/// Least share of the depth that is tried.
const LEAST_SHARE: f64 = 1.0 / 256.0;

/// Whether the stretch may count as egress, or ingress, by the exact paths: low(u) <= high(v) for
/// all u before v.
///
/// The path of the largest low so far (for ingress, of the least high) is followed beside the
/// outline; each comparison asks only on which side of it a point lies.
fn keeps_condition(
    stretch: &[SignedPiece],
    egress: bool,
    generator: &Generator,
    fold: f64,
) -> bool {
    let flow = Flow::new(*generator);
    let coordinates = stretch.iter().flat_map(|piece| piece.ends);
    let slack = SAME_POSE
        * coordinates
            .map(|p| p.abs().max_element())
            .fold(0.0, f64::max);
    let fold = STRAIGHT * fold;
    let sense = if egress { 1.0 } else { -1.0 };
    let mut path: Option<DVec2> = None;
    for piece in stretch {
        // First the bound that later points must respect, then the one that must respect earlier
        // points.
        let [low, high] = match (piece.is_fixed, piece.along) {
            (true, _) => [0.0, 0.0],
            (false, true) => [-fold, 0.0],
            (false, false) => [0.0, fold],
        };
        let [leading, following] = if egress { [low, high] } else { [high, low] };
        let points = if piece.is_fixed {
            &piece.ends[..1]
        } else {
            &piece.ends[..]
        };
        for &point in points {
            let left = generator.velocity(point).perp().normalize_or_zero();
            let Some(earlier) = path else {
                path = Some(point + left * leading);
                continue;
            };
            if earlier == point {
                continue;
            }
            let Some(foot) = beside(point, earlier, generator, &flow, slack) else {
                return false;
            };
            let across = generator.velocity(foot).perp().normalize_or_zero();
            let height = across.dot(point - foot);
            if sense * (height + following) < -slack {
                return false;
            }
            path = Some(if sense * (height + leading) > 0.0 {
                point + left * leading
            } else {
                foot
            });
        }
        if piece.is_fixed {
            path = Some(piece.ends[1]);
        }
    }
    true
}

/// The point of the path through `from` next to `point`: the line between them is square to the
/// path, up to `slack` along it. `None` where it is not found.
fn beside(
    point: DVec2,
    from: DVec2,
    generator: &Generator,
    flow: &Flow,
    slack: f64,
) -> Option<DVec2> {
    let mut foot = from;
    for _ in 0..MOST_STEPS {
        let velocity = generator.velocity(foot);
        let speed_squared = velocity.length_squared();
        // For paths that bend towards the point the slope is smaller, for others it is larger.
        let slope = speed_squared - (generator.linear * velocity).dot(point - foot);
        let time = velocity.dot(point - foot) / slope.max(LEAST_SLOPE * speed_squared);
        if !time.is_finite() {
            return None;
        }
        foot = flow.pose_at(time).transform_point2(foot);
        if time.abs() * speed_squared.sqrt() <= slack {
            return Some(foot);
        }
    }
    None
}

/// Least slope that Newton's method uses, as a share of that of a straight path: where it is less,
/// the point is farther away than the radius at which the path bends.
const LEAST_SLOPE: f64 = 0.25;

/// Newton's method doubles its digits with each step, except for the first few, which turn by up to
/// [`FOLD_TURN`](crate::numeric::tolerance::FOLD_TURN).
const MOST_STEPS: usize = 40;

#[cfg(test)]
mod tests {
    use super::super::GrazingSet;
    use super::*;
    use crate::body::{FillRule, Polygon};
    use std::f64::consts::TAU;

    fn disc(corners: u32, centre: DVec2) -> Polygon {
        let outline = (0..corners)
            .map(|i| centre + DVec2::from_angle(f64::from(i) / f64::from(corners) * TAU))
            .collect();
        Polygon::new(vec![outline], FillRule::EvenOdd).expect("a disc is a body")
    }

    fn grazing(body: &Polygon, generator: &Generator, fold: f64) -> GrazingSet {
        GrazingSet::new(body, body.positions(), generator, fold)
    }

    /// Depth of the edges of a disc below its circle.
    fn sagitta(corners: u32) -> f64 {
        1.0 - (TAU / f64::from(2 * corners)).cos()
    }

    #[test]
    fn the_edges_of_a_disc_that_turns_on_the_spot_take_one_sign() {
        let spin = Generator::spiral(DVec2::ZERO, 20.0, 1.0);
        for corners in [16, 50, 1000] {
            let body = disc(corners, DVec2::ZERO);
            let depth = sagitta(corners);
            let set = grazing(&body, &spin, 2.0 * depth);
            assert!(
                set.changes(&body).is_empty(),
                "{corners}: no change is left"
            );
            assert!(
                set.dropped_fold >= depth && set.dropped_fold <= 1.5 * depth,
                "{corners}: {:e} for {depth:e}",
                set.dropped_fold
            );
            let set = grazing(&body, &spin, 0.9 * depth);
            assert_eq!(
                (set.changes(&body).len(), set.dropped_fold),
                (2 * corners as usize, 0.0),
                "{corners}: folds deeper than the limit are kept"
            );
        }
    }

    #[test]
    fn a_disc_that_turns_beside_its_centre_keeps_two_changes() {
        for centre in [0.01, 0.2, 0.9, 3.0] {
            for scale in [1.0, 1.3] {
                let generator = Generator::spiral(DVec2::ZERO, 3.0, scale);
                let body = disc(400, DVec2::new(centre, 0.0));
                let exact = grazing(&body, &generator, 0.0).changes(&body).len();
                let set = grazing(&body, &generator, 2.0 * sagitta(400));
                let left = set.changes(&body).len();
                let growing_out = centre == 0.01 && scale > 1.0;
                assert_eq!(
                    left,
                    if growing_out { 0 } else { 2 },
                    "{centre} {scale}: of {exact}"
                );
            }
        }
    }

    #[test]
    fn needles_along_the_motion_keep_their_tips() {
        // Thinner than the depth that may be dropped: the tip leaves and the blunt end enters, or
        // the other way round.
        let outline = [[0.0, -1e-4], [1.0, 0.0], [0.0, 1e-4]].map(DVec2::from_array);
        let body = Polygon::new(vec![outline.to_vec()], FillRule::EvenOdd).expect("a needle");
        for turn in [0.1, -0.1] {
            let swing = Generator::spiral(DVec2::new(0.0, -100.0), turn, 1.0);
            let exact = grazing(&body, &swing, 0.0);
            let set = grazing(&body, &swing, 1e-2);
            let both_signs = set.changes(&body).len() >= 2;
            assert!(both_signs, "{turn}: {:?} of {:?}", set.edges, exact.edges);
        }
    }

    #[test]
    fn an_arc_beside_an_edge_through_the_point_at_rest_takes_one_sign() {
        // Half a disc about the point at rest: the straight side leaves on one side of it and
        // enters on the other.
        let arc = |i: u32| DVec2::from_angle(f64::from(i) / 200.0 * TAU);
        let half: Vec<DVec2> = (0..=100).map(arc).collect();
        let body = Polygon::new(vec![half], FillRule::EvenOdd).expect("half a disc");
        for (turn, scale) in [(1.0, 1.0), (-2.0, 1.0), (5.0, 1.01)] {
            let generator = Generator::spiral(DVec2::ZERO, turn, scale);
            let exact = grazing(&body, &generator, 0.0).changes(&body);
            let set = grazing(&body, &generator, 2.0 * sagitta(200));
            assert!(exact.len() > 100, "{turn}: {}", exact.len());
            assert_eq!(set.changes(&body).len(), 2, "{turn}");
            assert!(set.dropped_fold < 1.5 * sagitta(200), "{turn}");
        }
    }

    #[test]
    fn the_foot_on_a_path_is_square_to_it() {
        let generator = Generator::spiral(DVec2::new(0.3, 0.1), 2.0, 1.5);
        let flow = Flow::new(generator);
        let point = DVec2::new(1.0, 0.5);
        let from = flow.pose_at(-0.2).transform_point2(point * 1.01);
        let foot = beside(point, from, &generator, &flow, 1e-12).expect("near");
        let across = generator.velocity(foot).dot(point - foot);
        assert!(across.abs() < 1e-11, "{across:e}");
        assert!(foot.distance(point) < 0.02, "{foot}");
        // Far away from the path, and inside its bend.
        let spin = Generator::spiral(DVec2::ZERO, 1.0, 1.0);
        for radius in [0.6, 1.7] {
            let point = radius * DVec2::from_angle(0.9);
            let foot = beside(point, DVec2::X, &spin, &Flow::new(spin), 1e-12).expect("found");
            assert!(foot.distance(DVec2::from_angle(0.9)) < 1e-11, "{foot}");
        }
    }
}
