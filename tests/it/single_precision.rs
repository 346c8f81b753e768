//! Solids for files with 32-bit coordinates: a reader of the file sees what was reported.

use crate::support::sweep::{Case, case, corpus};
use glam::DVec3;
use std::collections::{HashMap, HashSet};
use steadysweep::{Precision, Simplify, Sweep, SweepSettings};

fn for_a_file(case: &Case, relative: f64) -> SweepSettings<'static> {
    SweepSettings::default()
        .with_tolerance(relative * case.mesh().diagonal())
        .with_precision(Precision::Single)
}

fn swept_for_a_file(case: &Case, relative: f64) -> Sweep {
    steadysweep::sweep(&case.mesh(), &case.motion, &for_a_file(case, relative))
        .expect("a legal sweep succeeds")
}

/// The defects that a reader finds who identifies corners only by their coordinates.
fn defects(sweep: &Sweep) -> Vec<String> {
    let mut defects = Vec::new();
    let positions = sweep.solid.positions();
    #[expect(
        clippy::cast_possible_truncation,
        reason = "the rounding is what is asked for"
    )]
    let stored: Vec<[f32; 3]> = positions
        .iter()
        .map(|p| p.to_array().map(|x| x as f32))
        .collect();
    if stored
        .iter()
        .zip(positions)
        .any(|(file, p)| DVec3::from(file.map(f64::from)) != *p)
    {
        defects.push("a position is not what the file says".to_owned());
    }
    let mut number = HashMap::<[u32; 3], usize>::new();
    let vertex: Vec<usize> = stored
        .iter()
        .map(|p| {
            let next = number.len();
            *number.entry(p.map(|x| (x + 0.0).to_bits())).or_insert(next)
        })
        .collect();
    let triangles: Vec<[usize; 3]> = sweep
        .solid
        .triangles()
        .iter()
        .map(|t| t.map(|v| vertex[v as usize]))
        .collect();
    let mut after = HashMap::<[usize; 2], usize>::new();
    let mut faces = vec![0_usize; number.len()];
    for &[a, b, c] in &triangles {
        if a == b || b == c || c == a {
            defects.push(format!("triangle {:?} has no area", [a, b, c]));
        }
        for [p, q, r] in [[a, b, c], [b, c, a], [c, a, b]] {
            faces[p] += 1;
            // At p the triangle turns from q to r.
            if after.insert([p, q], r).is_some() {
                defects.push(format!("edge {p} {q} occurs twice"));
            }
        }
    }
    let mut starts: Vec<[usize; 2]> = after.keys().copied().collect();
    starts.sort_unstable();
    let mut seen = HashSet::new();
    for [p, q] in starts {
        if !seen.insert(p) {
            continue;
        }
        let mut at = q;
        let mut turns = 0;
        while let Some(&next) = after.get(&[p, at]) {
            at = next;
            turns += 1;
            if at == q || turns > faces[p] {
                break;
            }
        }
        if at != q || turns != faces[p] {
            defects.push(format!(
                "vertex {p}: a fan of {turns} of its {} triangles",
                faces[p]
            ));
        }
    }
    let measures = sweep.solid.measures();
    let euler = i64::try_from(number.len()).unwrap() - i64::try_from(triangles.len() / 2).unwrap();
    let shells = i64::try_from(measures.components + measures.voids).unwrap();
    let reported = 2 * shells - 2 * i64::try_from(measures.genus).unwrap();
    if euler != reported {
        defects.push(format!("Euler characteristic {euler}, reported {reported}"));
    }
    defects
}

#[test]
fn a_reader_of_the_file_finds_a_manifold_of_the_reported_kind() {
    let mut found = Vec::new();
    for case in corpus() {
        let sweep = swept_for_a_file(&case, 1e-2);
        let defects = defects(&sweep);
        if !defects.is_empty() {
            found.push(format!(
                "{}: {:?}",
                case.name,
                &defects[..defects.len().min(3)]
            ));
        }
    }
    assert!(found.is_empty(), "{found:#?}");
}

#[test]
fn the_stored_solid_is_that_of_double_precision_up_to_rounding() {
    // Which edges collapse may depend on a rounding, so all triangles are kept.
    for name in ["bumpy_screw", "l_keyframes", "ball_helix"] {
        let case = case(name);
        let settings = for_a_file(&case, 1e-2).with_simplify(Simplify::Off);
        let single = steadysweep::sweep(&case.mesh(), &case.motion, &settings);
        let [single, double] = [single.expect("a legal sweep"), case.sampled(1e-2)];
        let [m, n] = [&single, &double].map(|sweep| sweep.solid.measures());
        let reach = double
            .solid
            .positions()
            .iter()
            .map(|p| p.abs().max_element());
        // Half a unit in the last place of three coordinates, over the whole surface.
        let off = n.area * reach.fold(0.0, f64::max) * f64::from(f32::EPSILON);
        assert!(
            (m.volume - n.volume).abs() <= off,
            "{name}: {} and {}",
            m.volume,
            n.volume
        );
        assert_eq!(
            [m.components, m.voids, m.genus],
            [n.components, n.voids, n.genus],
            "{name}"
        );
    }
}
