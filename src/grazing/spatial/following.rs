//! How far above the body a point passes where faces took the sign opposite to their flux.
//!
//! In the body's frame, a point of space moves along -v. Where it enters through a face that does
//! not count as egress, or leaves through one that does, the winding number of the sweep cycle is
//! one too low until the balance is restored. Either the point was outside only briefly and both
//! ends of the gap took the same side, or a point slightly deeper in the body passes a face of the
//! right sign instead. The depth of that point is the height h over the surface, h' = |n.v|, that
//! the path gains between the wrong face and the right one: the depth of the layer that is lost.
//!
//! The path is followed on the surface instead of in space, from the wrong face away from the body:
//! backwards in time for an entry, forwards for an exit. This leaves out terms of second order in
//! the height, which stays below the tolerance, and a few points stand for a face. So the depth is
//! an estimate.

use crate::body::Mesh;
use crate::motion::Generator;
use glam::DVec3;

/// Most sides that one path may cross; a longer path counts as too deep.
const MOST_CROSSINGS: usize = 100_000;

/// A body in the velocity field of its motion.
pub(super) struct Following<'a> {
    pub(super) mesh: &'a Mesh,
    /// Positions in the world at the start of the span.
    pub(super) positions: &'a [DVec3],
    pub(super) normals: &'a [DVec3],
    pub(super) generator: &'a Generator,
}

/// A piece of a path: on one face, or along an edge into which the paths on both of its faces run.
#[derive(Debug, Clone, Copy)]
struct PathPiece {
    face: u32,
    from: DVec3,
    along: DVec3,
    /// Its length in time.
    length: f64,
    end: End,
}

#[derive(Debug, Clone, Copy)]
enum End {
    Side(usize),
    Vertex(u32),
}

impl Following<'_> {
    /// The largest height that the path from `point` on `face` gains before it is back on the
    /// surface, or passes a place where `right` says that the flux counts with its own sign, or the
    /// span is over. Ends early above `limit`.
    ///
    /// - `entering`: whether the flux is positive at `point`.
    pub(super) fn height(
        &self,
        face: u32,
        point: DVec3,
        entering: bool,
        limit: f64,
        right: impl Fn(u32, DVec3) -> bool,
    ) -> f64 {
        let sense = if entering { 1.0 } else { -1.0 };
        let mut next = self.across(face, point, sense);
        let (mut height, mut highest, mut time) = (0.0, 0.0_f64, 0.0);
        for _ in 0..MOST_CROSSINGS {
            let Some(piece) = next else {
                return f64::INFINITY;
            };
            let rate = self.rate(piece.face, piece.from, sense);
            let length = piece.length.min(1.0 - time);
            if rate > 0.0
                && piece.face != face
                && right(piece.face, piece.from + piece.along * (0.5 * length))
            {
                return highest;
            }
            let to = piece.from + piece.along * length;
            let rate_at_end = self.rate(piece.face, to, sense);
            // The rate is linear along the path, so the height is quadratic, and highest where the
            // rate becomes negative.
            if rate > 0.0 && rate_at_end < 0.0 {
                highest = highest.max(height + 0.5 * length * rate * rate / (rate - rate_at_end));
            }
            height += 0.5 * length * (rate + rate_at_end);
            highest = highest.max(height);
            time += length;
            if highest > limit || height <= 0.0 || time >= 1.0 {
                return highest;
            }
            next = match piece.end {
                End::Side(side) => self.through(piece.face, side, to, sense),
                End::Vertex(vertex) => self.past_vertex(piece.face, vertex, sense),
            };
        }
        f64::INFINITY
    }

    /// The value at a point of a face, from the values at its corners.
    pub(super) fn interpolated(&self, face: u32, values: [f64; 3], point: DVec3) -> f64 {
        let corners = self.corners(face);
        let normal = self.normals[face as usize];
        let weight = |i: usize| {
            let [b, c] = [corners[(i + 1) % 3], corners[(i + 2) % 3]];
            normal.dot((b - point).cross(c - point))
        };
        (0..3).map(|i| weight(i) * values[i]).sum()
    }

    /// The rate at which the height over the plane of a face grows.
    fn rate(&self, face: u32, point: DVec3, sense: f64) -> f64 {
        sense * self.normals[face as usize].dot(self.generator.velocity(point))
    }

    /// The direction of the path on a face.
    fn along(&self, face: u32, point: DVec3, sense: f64) -> DVec3 {
        let velocity = self.generator.velocity(point);
        let normal = self.normals[face as usize];
        sense * (velocity - normal * normal.dot(velocity))
    }

    fn corners(&self, face: u32) -> [DVec3; 3] {
        self.mesh.triangles()[face as usize].map(|v| self.positions[v as usize])
    }

    /// The inward direction in the plane of a face, at right angles to a side.
    fn inwards(&self, face: u32, side: usize) -> DVec3 {
        let corners = self.corners(face);
        self.normals[face as usize].cross(corners[(side + 1) % 3] - corners[side])
    }

    /// The piece across a face from a point of it; `None` where the point rests.
    fn across(&self, face: u32, from: DVec3, sense: f64) -> Option<PathPiece> {
        let along = self.along(face, from, sense);
        let corners = self.corners(face);
        let mut piece: Option<PathPiece> = None;
        for (side, corner) in corners.into_iter().enumerate() {
            let inwards = self.inwards(face, side);
            let rate = along.dot(inwards);
            if rate >= 0.0 {
                continue;
            }
            let length = (from - corner).dot(inwards).max(0.0) / -rate;
            if piece.is_none_or(|piece| length < piece.length) {
                piece = Some(PathPiece {
                    face,
                    from,
                    along,
                    length,
                    end: End::Side(side),
                });
            }
        }
        piece
    }

    /// The piece that follows where a path leaves a face through a side.
    fn through(&self, face: u32, side: usize, point: DVec3, sense: f64) -> Option<PathPiece> {
        let edge = self.mesh.face_edges()[face as usize][side];
        let [first, second] = self.mesh.edges()[edge as usize].faces;
        let other = if first == face { second } else { first };
        let entered = self.side_of(other, edge)?;
        if self
            .along(other, point, sense)
            .dot(self.inwards(other, entered))
            > 0.0
        {
            return self.across(other, point, sense);
        }
        self.along_side(other, entered, point, sense)
    }

    fn side_of(&self, face: u32, edge: u32) -> Option<usize> {
        self.mesh.face_edges()[face as usize]
            .iter()
            .position(|&e| e == edge)
    }

    /// The piece along a side, to one of its ends.
    fn along_side(&self, face: u32, side: usize, from: DVec3, sense: f64) -> Option<PathPiece> {
        let triangle = self.mesh.triangles()[face as usize];
        let corners = self.corners(face);
        let velocity = sense * self.generator.velocity(from);
        let direction = (corners[(side + 1) % 3] - corners[side]).normalize_or_zero();
        let speed = velocity.dot(direction);
        let end = if speed > 0.0 { (side + 1) % 3 } else { side };
        (speed != 0.0).then(|| PathPiece {
            face,
            from,
            along: direction * speed,
            length: (corners[end] - from).dot(direction) / speed,
            end: End::Vertex(triangle[end]),
        })
    }

    /// The piece that follows at a vertex of a face: across the face around it into which the path
    /// runs, or else along the edge.
    fn past_vertex(&self, face: u32, vertex: u32, sense: f64) -> Option<PathPiece> {
        let point = self.positions[vertex as usize];
        let mut steepest: Option<(f64, u32, usize)> = None;
        let mut current = face;
        loop {
            let corner = self.mesh.triangles()[current as usize]
                .iter()
                .position(|&v| v == vertex)?;
            let [next, last] = [corner, (corner + 2) % 3];
            let along = self.along(current, point, sense);
            if along.dot(self.inwards(current, next)) > 0.0
                && along.dot(self.inwards(current, last)) > 0.0
            {
                return self.across(current, point, sense);
            }
            let corners = self.corners(current);
            let ahead = along.dot((corners[(next + 1) % 3] - point).normalize_or_zero());
            if steepest.is_none_or(|(most, ..)| ahead > most) {
                steepest = Some((ahead, current, next));
            }
            let edge = self.mesh.face_edges()[current as usize][next];
            let [first, second] = self.mesh.edges()[edge as usize].faces;
            current = if first == current { second } else { first };
            if current == face {
                break;
            }
        }
        let (ahead, face, side) = steepest?;
        (ahead > 0.0)
            .then(|| self.along_side(face, side, point, sense))
            .flatten()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A block from y = 0 to y = 1 with a valley along y in its top. The walls of the valley slope
    /// at 45 degrees.
    fn valley() -> Mesh {
        let profile = [
            (0.0, 0.0),
            (-1.0, 1.0),
            (-1.0, -1.0),
            (1.0, -1.0),
            (1.0, 1.0),
        ];
        let positions = [0.0, 1.0].map(|y| profile.map(|(x, z)| DVec3::new(x, y, z)));
        let mut triangles = Vec::new();
        for i in 1..4 {
            // In the two ends, around the bottom of the valley.
            triangles.extend([[0, i, i + 1], [5, 5 + i + 1, 5 + i]]);
        }
        for i in 0..5 {
            let j = (i + 1) % 5;
            triangles.extend([[i, 5 + i, 5 + j], [i, 5 + j, j]]);
        }
        Mesh::new(positions.concat(), triangles).expect("a block is a body")
    }

    /// The height that a path over the valley gains from a point of a wall, when no face counts as
    /// it is.
    fn height(velocity: DVec3, from: DVec3, entering: bool) -> f64 {
        let mesh = valley();
        let corners = |triangle: &[u32; 3]| triangle.map(|v| mesh.positions()[v as usize]);
        let normals: Vec<DVec3> = mesh
            .triangles()
            .iter()
            .map(|triangle| {
                let [a, b, c] = corners(triangle);
                (b - a).cross(c - a).normalize()
            })
            .collect();
        let on = mesh.triangles().iter().zip(&normals).position(|(t, n)| {
            let corners = corners(t);
            (0..3).all(|i| {
                let [p, q] = [corners[i], corners[(i + 1) % 3]];
                n.dot((q - p).cross(from - p)) >= -1e-12 && n.dot(from - p).abs() < 1e-12
            })
        });
        let face = crate::numeric::index(on.expect("a point of the surface"));
        let generator = Generator::translation(velocity);
        let body = Following {
            mesh: &mesh,
            positions: mesh.positions(),
            normals: &normals,
            generator: &generator,
        };
        body.height(face, from, entering, f64::INFINITY, |_, _| false)
    }

    #[test]
    fn a_path_over_a_valley_is_highest_at_its_bottom() {
        // On a wall at 45 degrees, the path advances by 1/2 along x per unit of time, and gains a
        // height of sqrt(1/2): from x = -1/4 it takes a time of 1/2 to reach the bottom, and loses
        // as much on the other wall.
        let expected = 0.5 * 0.5_f64.sqrt();
        let left = DVec3::new(-0.25, 0.3, 0.25);
        let entering = height(DVec3::X, left, true);
        assert!((entering - expected).abs() < 1e-12, "{entering}");
        // An exit is followed forwards: the motion the other way leaves through this wall.
        let leaving = height(DVec3::NEG_X, left, false);
        assert!((leaving - expected).abs() < 1e-12, "{leaving}");
    }

    #[test]
    fn a_path_along_the_valley_gains_nothing() {
        let found = height(DVec3::Y, DVec3::new(-0.25, 0.3, 0.25), true);
        assert_eq!(found, 0.0);
    }

    #[test]
    fn a_path_that_rests_is_too_deep() {
        let found = height(DVec3::ZERO, DVec3::new(-0.25, 0.3, 0.25), true);
        assert_eq!(found, f64::INFINITY);
    }
}
