//! The union of many regions, each bounded by curves of its own.

use super::{Arrangement, ArrangementError, Loop, Segment, arrange_as};
use crate::bounds::SurfaceTree;
use crate::numeric::index;
use crate::watch::Work;
use glam::DVec2;

/// Closed curves: points, and the segments between them.
#[derive(Debug, Clone, Default)]
pub(crate) struct Curves {
    /// The points: finite, in any unit.
    pub points: Vec<DVec2>,
    /// The segments: closed, with their ends among the points.
    pub segments: Vec<Segment>,
}

/// A union of regions.
#[derive(Debug, Clone)]
pub(crate) struct Union {
    /// The arrangement whose region is the union.
    pub arrangement: Arrangement,
    /// Pieces of curves with their region on neither side: those of [`Arrangement::idle`], for all
    /// regions.
    pub idle: Vec<[DVec2; 2]>,
    /// Largest distance by which a point of the curves may have been moved.
    pub rounding: f64,
}

/// The union of the regions in which the curves of each set wind at least once.
///
/// Halves of the list are united first, and only the boundaries of their unions are processed
/// further: where the regions overlap much, and neighbours in the list are near each other, most
/// crossings of their curves need not be found. Pieces that meet no piece of the other half stay as
/// they are. With one set, it is [`arrange`](super::arrange).
///
/// # Guarantee
/// As for [`arrange`](super::arrange), at each of the log2(n) levels: points move by no more than
/// the rounding, which is the sum over the levels.
///
/// # Errors
/// As for [`arrange`](super::arrange).
pub(crate) fn unite(sets: &[Curves], work: Work) -> Result<Union, ArrangementError> {
    if let [Curves { points, segments }] = sets {
        let arrangement = arrange_as(points, segments, work)?;
        return Ok(Union {
            idle: arrangement.idle(),
            rounding: arrangement.rounding(),
            arrangement,
        });
    }
    // Each set, one less of pairs, and the whole.
    let part = work.part(1, 2 * sets.len() as u64);
    let Pieces {
        pieces,
        mut idle,
        rounding,
    } = united(sets, part)?;
    let arrangement = arranged(&pieces, part)?;
    idle.extend(arrangement.idle());
    Ok(Union {
        idle,
        rounding: rounding + arrangement.rounding(),
        arrangement,
    })
}

/// A partial union.
#[derive(Debug, Default)]
struct Pieces {
    /// The pieces, disjoint.
    pieces: Vec<RegionPiece>,
    idle: Vec<[DVec2; 2]>,
    rounding: f64,
}

/// A connected part of a region.
#[derive(Debug)]
struct RegionPiece {
    /// Its outline and those of its holes, with the region on their left.
    loops: Vec<Vec<DVec2>>,
    /// The smallest box around the outline.
    bounds: [DVec2; 2],
}

/// - `part`: the work of one arrangement.
fn united(sets: &[Curves], part: Work) -> Result<Pieces, ArrangementError> {
    if let [] | [_] = sets {
        let mut found = Pieces::default();
        for Curves { points, segments } in sets {
            found.add(&arrange_as(points, segments, part)?);
        }
        return Ok(found);
    }
    let (first, second) = sets.split_at(sets.len() / 2);
    let (first, second) = rayon::join(|| united(first, part), || united(second, part));
    let [first, second] = [first?, second?];
    let mut found = Pieces {
        pieces: Vec::new(),
        idle: [first.idle, second.idle].concat(),
        rounding: first.rounding.max(second.rounding),
    };
    let meets = meeting([&first.pieces, &second.pieces]);
    let mut met = Vec::new();
    for (pieces, meets) in [first.pieces, second.pieces].into_iter().zip(meets) {
        for (piece, meets) in pieces.into_iter().zip(meets) {
            if meets {
                met.push(piece);
            } else {
                found.pieces.push(piece);
            }
        }
    }
    if met.is_empty() {
        part.done();
    } else {
        found.add(&arranged(&met, part)?);
    }
    Ok(found)
}

impl Pieces {
    /// Adds the region of an arrangement, which is disjoint from the others, and the pieces that
    /// bound nothing of it.
    fn add(&mut self, arrangement: &Arrangement) {
        let outlines = arrangement.outlines();
        let places = |outline: &Loop| -> Vec<DVec2> {
            let vertices = outline.vertices.iter();
            vertices
                .map(|&vertex| arrangement.positions[vertex as usize])
                .collect()
        };
        let first = self.pieces.len();
        for outline in &outlines.pieces {
            let corners = places(outline);
            let empty = [DVec2::INFINITY, DVec2::NEG_INFINITY];
            let around = |[low, high]: [DVec2; 2], &p: &DVec2| [low.min(p), high.max(p)];
            self.pieces.push(RegionPiece {
                bounds: corners.iter().fold(empty, around),
                loops: vec![corners],
            });
        }
        for hole in &outlines.holes {
            self.pieces[first + hole.piece as usize]
                .loops
                .push(places(hole));
        }
        self.idle.extend(arrangement.idle());
        self.rounding += arrangement.rounding();
    }
}

/// Per piece of two regions, whether its box meets that of a piece of the other region.
fn meeting(pieces: [&[RegionPiece]; 2]) -> [Vec<bool>; 2] {
    let mut meets = pieces.map(|pieces| vec![false; pieces.len()]);
    // These segments have the boxes of the pieces.
    let corners: Vec<DVec2> = pieces[0].iter().flat_map(|piece| piece.bounds).collect();
    let diagonals: Vec<[u32; 2]> = (0..index(pieces[0].len()))
        .map(|i| [2 * i, 2 * i + 1])
        .collect();
    let tree = SurfaceTree::of_segments(&corners, &diagonals);
    for (place, piece) in pieces[1].iter().enumerate() {
        let bounds = piece.bounds.map(|corner| corner.extend(0.0));
        tree.for_each_in_box(bounds, |other| {
            meets[0][other as usize] = true;
            meets[1][place] = true;
        });
    }
    meets
}

fn arranged(pieces: &[RegionPiece], work: Work) -> Result<Arrangement, ArrangementError> {
    let (mut points, mut segments) = (Vec::new(), Vec::new());
    for corners in pieces.iter().flat_map(|piece| &piece.loops) {
        let (first, count) = (index(points.len()), index(corners.len()));
        points.extend(corners);
        segments.extend((0..count).map(|corner| Segment {
            ends: [first + corner, first + (corner + 1) % count],
            weight: 1,
        }));
    }
    arrange_as(&points, &segments, work)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square, clockwise when its size is negative.
    fn square(x: f64, y: f64, size: f64) -> Curves {
        let corners = [
            [0.0, 0.0],
            [size, 0.0],
            [size, size.abs()],
            [0.0, size.abs()],
        ];
        Curves {
            points: corners
                .map(|c| DVec2::new(x, y) + DVec2::from_array(c))
                .to_vec(),
            segments: (0..4)
                .map(|i| Segment {
                    ends: [i, (i + 1) % 4],
                    weight: 1,
                })
                .collect(),
        }
    }

    /// The area, and the numbers of pieces and holes.
    fn measures(union: &Union) -> (f64, usize, usize) {
        let outlines = union.arrangement.outlines();
        let measures = union.arrangement.measures(&outlines);
        (measures.area, measures.pieces, measures.holes)
    }

    #[test]
    fn the_union_of_many_is_that_of_all_at_once() {
        let mut state = 3u64;
        let mut random = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            f64::from(u32::try_from(state >> 40).expect("24 bits")) / f64::from(1 << 24)
        };
        for count in [1, 2, 3, 7, 60, 200] {
            let sets: Vec<Curves> = (0..count)
                .map(|_| square(16.0 * random(), 16.0 * random(), 0.2 + random()))
                .collect();
            let mut together = Curves::default();
            for set in &sets {
                let first = index(together.points.len());
                together.points.extend(&set.points);
                together
                    .segments
                    .extend(set.segments.iter().map(|segment| Segment {
                        ends: segment.ends.map(|end| first + end),
                        ..*segment
                    }));
            }
            let at_once = unite(&[together], Work::UNWATCHED).expect("arranged");
            let united = unite(&sets, Work::UNWATCHED).expect("arranged");
            let (expected, found) = (measures(&at_once), measures(&united));
            assert!(
                (expected.0 - found.0).abs() < 1e-9,
                "{expected:?} {found:?}"
            );
            assert_eq!((expected.1, expected.2), (found.1, found.2), "{count}");
            // Each set is arranged once by itself, at most once per level, and once at the end; all
            // within the same square.
            let times = f64::from(sets.len().next_power_of_two().ilog2()) + 2.0;
            assert!(
                united.rounding <= times * at_once.rounding,
                "{} against {}",
                united.rounding,
                at_once.rounding
            );
        }
    }

    #[test]
    fn what_bounds_nothing_of_its_region_stays_known() {
        // A curve that winds the other way round bounds nothing, even inside the other region.
        let union = unite(
            &[square(0.0, 0.0, 4.0), square(3.0, 1.0, -2.0)],
            Work::UNWATCHED,
        )
        .expect("arranged");
        assert_eq!(measures(&union), (16.0, 1, 0), "the union with nothing");
        assert_eq!(union.idle.len(), 4, "{:?}", union.idle);
    }
}
