//! Which triangles belong together at an edge that more than two of them share.

use super::sides::edges;
use glam::DVec3;

/// The half-edges along an edge, in pairs that enclose solid, in a fixed order; the half-edge that
/// runs in the sense of the edge is the first of each pair.
///
/// - `halves`: the half-edges in either sense, ascending; equally many in each.
pub(crate) fn pairs_around(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    [a, b]: [u32; 2],
    halves: &[u32],
) -> Vec<[u32; 2]> {
    let along = (positions[b as usize] - positions[a as usize]).normalize_or_zero();
    let across = |half: u32| {
        let corners = triangles[half as usize / 3];
        let apex = corners
            .iter()
            .find(|&&v| v != a && v != b)
            .map_or(DVec3::ZERO, |&v| positions[v as usize]);
        (apex - positions[a as usize]).reject_from(along)
    };
    let start = across(halves[0]);
    let side = along.cross(start);
    let mut sorted: Vec<(f64, u32, bool)> = halves
        .iter()
        .map(|&half| {
            let direction = across(half);
            let runs_along = edges(&triangles[half as usize / 3])[half as usize % 3] == [a, b];
            let angle = direction.dot(side).atan2(direction.dot(start));
            (angle, half, runs_along)
        })
        .collect();
    sorted.sort_by(|p, q| p.0.total_cmp(&q.0));
    // Seen along the edge, the outside of a triangle that runs along it is counter-clockwise of it,
    // so the solid ends at the next triangle clockwise.
    let n = sorted.len();
    let before = |i: usize| &sorted[(i + n - 1) % n];
    if (0..n).all(|i| sorted[i].2 != before(i).2) {
        return (0..n)
            .filter(|&i| sorted[i].2)
            .map(|i| [sorted[i].1, before(i).1])
            .collect();
    }
    // For coinciding triangles, any pairs of opposite sense keep the surface closed.
    let of_sense = |sense: bool| sorted.iter().filter(move |t| t.2 == sense).map(|t| t.1);
    of_sense(true)
        .zip(of_sense(false))
        .map(|(there, back)| [there, back])
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::wedges;

    #[test]
    fn faces_with_solid_between_them_are_a_pair() {
        let (positions, triangles) = wedges();
        let found = pairs_around(&positions, &triangles, [0, 1], &[0, 3, 12, 15]);
        assert_eq!(found.len(), 2);
        assert!(found.contains(&[0, 3]), "of the first: {found:?}");
        assert!(found.contains(&[12, 15]), "of the second: {found:?}");
        let found = pairs_around(&positions, &triangles, [1, 0], &[0, 3, 12, 15]);
        assert!(found.contains(&[3, 0]), "seen against the edge: {found:?}");
        assert!(
            found.contains(&[15, 12]),
            "seen against the edge: {found:?}"
        );
    }

    #[test]
    fn inside_out_the_solid_is_on_the_other_side() {
        let (positions, mut triangles) = wedges();
        triangles.iter_mut().for_each(|t| t.swap(0, 1));
        // Now the first triangle runs in the opposite sense, and its half-edges keep their numbers.
        let found = pairs_around(&positions, &triangles, [0, 1], &[0, 3, 12, 15]);
        assert!(found.contains(&[3, 12]), "beside the wedges: {found:?}");
        assert!(found.contains(&[15, 0]), "beside the wedges: {found:?}");
    }

    #[test]
    fn triangles_on_each_other_are_paired_all_the_same() {
        // The same wedge twice, so that the senses do not alternate around the edge.
        let (mut positions, triangles) = wedges();
        positions[4] = positions[2];
        positions[5] = positions[3];
        let found = pairs_around(&positions, &triangles, [0, 1], &[0, 3, 12, 15]);
        let mut all: Vec<u32> = found.iter().flatten().copied().collect();
        all.sort_unstable();
        assert_eq!(all, [0, 3, 12, 15], "each once");
        assert!(
            found
                .iter()
                .all(|[there, back]| there % 12 == 0 && back % 12 == 3),
            "there and back: {found:?}"
        );
    }
}
