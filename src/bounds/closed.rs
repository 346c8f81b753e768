//! Whether a surface is closed, by its indices: what every stage of a sweep keeps.

use std::collections::HashMap;

/// Whether every edge is run through equally often in both senses. O(n).
pub(crate) fn is_closed(triangles: &[[u32; 3]]) -> bool {
    let mut balance = HashMap::<(u32, u32), i32>::new();
    for t in triangles {
        for i in 0..3 {
            let (a, b) = (t[i], t[(i + 1) % 3]);
            *balance.entry((a.min(b), a.max(b))).or_default() += if a < b { 1 } else { -1 };
        }
    }
    balance.values().all(|&count| count == 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_surface_is_closed_when_every_edge_has_its_opposite() {
        let tetrahedron = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        assert!(is_closed(&tetrahedron), "closed");
        assert!(!is_closed(&tetrahedron[..3]), "a face is missing");
        assert!(
            !is_closed(&[[0, 1, 2], [0, 1, 2]]),
            "twice the same is not there and back"
        );
    }
}
