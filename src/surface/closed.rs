//! Whether a surface is closed, by its indices: what every stage of a sweep keeps, and is asked for in every build.

/// Whether every edge is run through equally often in both senses.
///
/// O(n log d) for vertices of at most d triangles: sides are sorted into those of each vertex, by counting.
pub(crate) fn is_closed(triangles: &[[u32; 3]]) -> bool {
    let sides = || {
        triangles
            .iter()
            .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
    };
    let vertices = triangles
        .iter()
        .flatten()
        .max()
        .map_or(0, |&last| last as usize + 1);
    // Sides by their smaller ends: where those of each vertex begin; one more than vertices.
    let mut starts = vec![0_u32; vertices + 1];
    sides().for_each(|[from, to]| starts[from.min(to) as usize + 1] += 1);
    (0..vertices).for_each(|vertex| starts[vertex + 1] += starts[vertex]);
    // The larger end of each side, twice, and one more for one that runs to the smaller.
    let mut next = starts.clone();
    let mut others = vec![0_u64; 3 * triangles.len()];
    for [from, to] in sides() {
        let place = &mut next[from.min(to) as usize];
        others[*place as usize] = 2 * u64::from(from.max(to)) + u64::from(from > to);
        *place += 1;
    }
    starts.windows(2).all(|ends| {
        let others = &mut others[ends[0] as usize..ends[1] as usize];
        others.sort_unstable();
        others.chunk_by(|a, b| a / 2 == b / 2).all(|run| {
            let back = run.iter().filter(|&&side| side % 2 == 1).count();
            2 * back == run.len()
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_surface_is_closed_when_every_edge_has_its_opposite() {
        let tetrahedron = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        assert!(is_closed(&tetrahedron), "closed");
        assert!(is_closed(&[]), "nothing is open");
        assert!(!is_closed(&tetrahedron[..3]), "a face is missing");
        assert!(
            !is_closed(&[[0, 1, 2], [0, 1, 2]]),
            "twice the same is not there and back"
        );
        let twice = [&tetrahedron[..], &tetrahedron[..]].concat();
        assert!(is_closed(&twice), "edges of four triangles");
    }

    #[test]
    fn one_turned_triangle_among_many_is_noticed() {
        // A double cone over a ring of many corners: two vertices of very many triangles.
        let ring = 1000;
        let mut triangles: Vec<[u32; 3]> = (0..ring)
            .flat_map(|i| {
                let [a, b] = [2 + i, 2 + (i + 1) % ring];
                [[a, b, 0], [b, a, 1]]
            })
            .collect();
        assert!(is_closed(&triangles), "closed");
        triangles[700].swap(0, 1);
        assert!(!is_closed(&triangles), "one is turned");
    }
}
