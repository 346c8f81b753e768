//! The pieces of a planar body, each with its holes, as bodies of their own.

use super::polygon::{Polygon, bounds_of};
use super::sides::sides;
use crate::numeric::index;
use glam::DVec2;

impl Polygon {
    /// The loops of each piece: the one around it, and those around its holes.
    ///
    /// Where rounding has made edges cross ([`Polygon::transformed`]), all loops count as one
    /// piece.
    ///
    /// # Cost
    /// O(n log n).
    pub(crate) fn loops_of_pieces(&self) -> Vec<Vec<u32>> {
        let all = || vec![(0..index(self.loops().len())).collect()];
        self.owners().map_or_else(all, |owners| {
            let mut loops = vec![Vec::new(); self.pieces()];
            for (outline, owner) in (0u32..).zip(owners) {
                loops[owner as usize].push(outline);
            }
            loops
        })
    }

    /// The piece that each loop bounds.
    ///
    /// The edge right below the leftmost corner of a hole (the lowest of several) bounds the same
    /// piece from below: it belongs to the outline around the piece, or to another hole, whose
    /// leftmost corner comes earlier.
    fn owners(&self) -> Option<Vec<u32>> {
        let places = |outline: &Vec<u32>| -> Vec<DVec2> {
            outline
                .iter()
                .map(|&corner| self.positions()[corner as usize])
                .collect()
        };
        let corners: Vec<Vec<DVec2>> = self.loops().iter().map(places).collect();
        let found = sides(&corners, &vec![1; corners.len()]).ok()?;
        let loop_of = |edge: u32| self.loops().partition_point(|outline| outline[0] <= edge) - 1;
        let leftmost = |outline: &Vec<u32>| {
            let places = outline
                .iter()
                .map(|&corner| found.place_of[corner as usize]);
            places.min().unwrap_or_default()
        };
        let mut order: Vec<(u32, usize)> = self.loops().iter().map(leftmost).zip(0..).collect();
        order.sort_unstable();
        let mut owners = vec![None; corners.len()];
        let mut pieces = 0;
        for (place, outline) in order {
            owners[outline] = if self.is_hole(&self.loops()[outline]) {
                let below = found.under[place as usize]?;
                owners[loop_of(found.pieces[below as usize].edges[0])]
            } else {
                pieces += 1;
                Some(pieces - 1)
            };
        }
        owners.into_iter().collect()
    }

    /// The body bounded by some of the loops, which are those of whole pieces.
    pub(crate) fn of_loops(&self, loops: impl Iterator<Item = u32>) -> Polygon {
        let mut part = Polygon::empty();
        for outline in loops {
            let corners = self.loops()[outline as usize].iter();
            part.push_loop(corners.map(|&c| (self.positions()[c as usize], self.given_edge(c))));
        }
        part.measure();
        part
    }

    /// The smallest box around some loops.
    pub(crate) fn box_of_loops(&self, loops: &[u32]) -> [DVec2; 2] {
        let corners = loops
            .iter()
            .flat_map(|&outline| &self.loops()[outline as usize]);
        bounds_of(corners.map(|&corner| self.positions()[corner as usize]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::FillRule;

    fn square(x: f64, y: f64, size: f64) -> Vec<DVec2> {
        [[0.0, 0.0], [size, 0.0], [size, size], [0.0, size]]
            .map(|corner| DVec2::new(x, y) + DVec2::from_array(corner))
            .to_vec()
    }

    fn pieces(loops: Vec<Vec<DVec2>>) -> (Polygon, Vec<Vec<u32>>) {
        let body = Polygon::new(loops, FillRule::EvenOdd).expect("a body");
        let mut found = body.loops_of_pieces();
        found.sort_unstable();
        (body, found)
    }

    #[test]
    fn holes_belong_to_the_piece_around_them() {
        // A plate with two holes, one above the other and a ring in the upper one, and a square
        // beside the plate.
        let loops = vec![
            square(0.0, 0.0, 100.0),
            square(10.0, 1.0, 9.0),
            square(10.0, 20.0, 70.0),
            square(20.0, 30.0, 50.0),
            square(30.0, 40.0, 20.0),
            square(200.0, 0.0, 1.0),
        ];
        let (body, found) = pieces(loops);
        assert_eq!(found, [vec![0, 1, 2], vec![3, 4], vec![5]]);
        let areas: Vec<f64> = found
            .iter()
            .map(|loops| body.of_loops(loops.iter().copied()))
            .inspect(|part| assert_eq!(part.pieces(), 1))
            .map(|part| part.area())
            .collect();
        assert_eq!(areas, [10_000.0 - 81.0 - 4_900.0, 2_500.0 - 400.0, 1.0]);
        let ring = body.of_loops([3, 4].into_iter());
        assert_eq!(ring.bounds(), body.box_of_loops(&[3, 4]));
        assert_eq!((ring.holes(), ring.given_edge(4)), (1, body.given_edge(16)));
    }

    #[test]
    fn pieces_that_touch_in_corners_are_told_apart() {
        // A square whose hole is touched by a square in it, at the leftmost corner of the hole; and
        // one that touches from outside.
        let diamond = |x: f64, size: f64| {
            [[0.0, 0.0], [size, -size], [2.0 * size, 0.0], [size, size]]
                .map(|corner| DVec2::new(x, 0.0) + DVec2::from_array(corner))
                .to_vec()
        };
        let (body, found) = pieces(vec![
            diamond(-5.0, 10.0),
            diamond(0.0, 4.0),
            [[0.0, 0.0], [2.0, -1.0], [4.0, 0.0], [2.0, 1.0]]
                .map(DVec2::from_array)
                .to_vec(),
            diamond(15.0, 1.0),
        ]);
        assert_eq!((body.pieces(), body.holes()), (3, 1));
        assert_eq!(found.len(), 3);
        let mut areas: Vec<f64> = found
            .iter()
            .map(|loops| body.of_loops(loops.iter().copied()).area())
            .collect();
        areas.sort_by(f64::total_cmp);
        assert_eq!(areas, [2.0, 4.0, 200.0 - 32.0]);
    }

    #[test]
    fn a_body_is_all_its_pieces() {
        let rings = (0..40).flat_map(|i| {
            let (x, size) = (10.0 * f64::from(i % 7), 9.0 - f64::from(i / 7));
            let at = f64::from(i / 7) / 2.0;
            [square(x + at, at, size), square(100.0 + x, 50.0 * at, 3.0)]
        });
        let (body, found) = pieces(rings.collect());
        let total: f64 = found
            .iter()
            .map(|loops| body.of_loops(loops.iter().copied()).area())
            .sum();
        assert!(
            (total - body.area()).abs() < 1e-9,
            "{total} of {}",
            body.area()
        );
        assert_eq!(found.len(), body.pieces());
    }
}
