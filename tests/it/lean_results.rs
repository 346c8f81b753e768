//! Results of which edges were collapsed: the same solid within the bounds, with fewer triangles.

use crate::support::scratch::Scratch;
use crate::support::shapes;
use crate::support::sweep::{Case, agreement, corpus, mesh, motion, screw, swept, translation};
use glam::DVec3;
use std::collections::HashMap;
use std::f64::consts::PI;
use std::path::Path;
use steadysweep::bounds::SurfaceTree;
use steadysweep::io::read_body;
use steadysweep::motion::{Generator, Motion, Span};
use steadysweep::{Simplify, Sweep, SweepSettings, sweep};

/// Points of which is known whether they are swept, per case.
const POINTS: usize = 2000;

/// The sweep with all its triangles, and with fewer.
fn both(case: &Case, relative_tolerance: f64) -> [Sweep; 2] {
    let body = case.mesh();
    let diagonal = body.transformed(case.motion.start_pose()).diagonal();
    let settings = SweepSettings::default().with_tolerance(relative_tolerance * diagonal);
    [Simplify::Off, Simplify::WithinTolerance].map(|simplify| {
        let settings = settings.with_simplify(simplify);
        sweep(&body, &case.motion, &settings)
            .unwrap_or_else(|error| panic!("{}: {error}", case.name))
    })
}

fn triangles(sweep: &Sweep) -> usize {
    sweep.solid.triangles().len()
}

fn meetings(sweep: &Sweep) -> usize {
    let solid = &sweep.solid;
    SurfaceTree::new(solid.positions(), solid.triangles())
        .meetings()
        .len()
}

/// The least cosine between the normals of two triangles at an edge.
fn sharpest_fold(sweep: &Sweep) -> f64 {
    let solid = &sweep.solid;
    let mut normals = HashMap::new();
    let mut sharpest: f64 = 1.0;
    for corners in solid.triangles() {
        let [a, b, c] = corners.map(|v| solid.positions()[v as usize]);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        for k in 0..3 {
            let edge = [corners[k], corners[(k + 1) % 3]];
            if let Some(other) = normals.remove(&[edge[1], edge[0]]) {
                sharpest = sharpest.min(normal.dot(other));
            } else {
                normals.insert(edge, normal);
            }
        }
    }
    sharpest
}

#[test]
fn fewer_triangles_bound_the_same_solid() {
    let (mut raw_triangles, mut lean_triangles) = (0, 0);
    for case in corpus().iter().step_by(7) {
        let [raw, lean] = both(case, 3e-3);
        let name = case.name;
        assert_eq!(
            lean.raw_triangles,
            triangles(&raw),
            "{name}: the same sweep"
        );
        assert_eq!(
            raw.raw_triangles,
            triangles(&raw),
            "{name}: nothing collapsed"
        );
        assert!(triangles(&lean) <= triangles(&raw), "{name}");
        raw_triangles += triangles(&raw);
        lean_triangles += triangles(&lean);
        let topology = |sweep: &Sweep| {
            let measures = sweep.solid.measures();
            [measures.components, measures.voids, measures.genus]
        };
        assert_eq!(topology(&lean), topology(&raw), "{name}");
        assert!(
            meetings(&lean) <= meetings(&raw),
            "{name}: they do not cross"
        );
        let folds = [&raw, &lean].map(sharpest_fold);
        assert!(folds[1] >= folds[0].min(-0.99), "{name}: {folds:?}");
        // Both bounds hold, and stay within the tolerance.
        let defects = agreement(&case.mesh(), &case.motion, &lean, POINTS).defects(&lean);
        assert!(defects.is_empty(), "{name}: {defects}");
        let bounds = |sweep: &Sweep| [sweep.error_bound.inside, sweep.error_bound.outside];
        let mut moved: f64 = 0.0;
        for (raw, with) in bounds(&raw).into_iter().zip(bounds(&lean)) {
            assert!(
                with.length <= raw.length.max(lean.tolerance) && with.proven == raw.proven,
                "{name}: {with:?} instead of {raw:?}"
            );
            moved = moved.max(with.length - raw.length);
        }
        let [less, more] = [&raw, &lean].map(|sweep| sweep.solid.measures());
        let change = (less.volume - more.volume).abs();
        assert!(
            change <= 1.01 * less.area * moved + 1e-12 * less.volume,
            "{name}: the volume changes by {change}"
        );
    }
    assert!(
        lean_triangles * 3 < raw_triangles * 2,
        "{lean_triangles} of {raw_triangles}"
    );
}

/// What is not sampled has no error, and keeps it so.
#[test]
fn a_translation_stays_exact() {
    let body = mesh(&shapes::icosphere(2, 1.0, DVec3::ZERO));
    let along = motion(&[translation(1.0, 0.2, 0.3), translation(0.0, 1.0, -0.3)]);
    let swept = swept(&body, &along, 0.1);
    assert!(
        triangles(&swept) * 10 > swept.raw_triangles * 9,
        "it is round"
    );
    assert!(
        swept.error_bound.inside.length < 1e-12,
        "{:?}",
        swept.error_bound
    );
    assert!(
        swept.error_bound.outside.length < 1e-12,
        "{:?}",
        swept.error_bound
    );
}

#[test]
fn any_unit_of_length_gives_the_same_triangles() {
    let size = DVec3::new(1.0, 0.7, 0.4);
    let mut counts = Vec::new();
    for unit in [1.0, 1e-3, 1e6] {
        let body = mesh(&shapes::cuboid(DVec3::ZERO, unit * size));
        let turned = screw(DVec3::Z, DVec3::X * 2.0 * unit, PI, 0.5 * unit, 1.0);
        let swept = swept(&body, &motion(&[turned]), 1e-3 * unit);
        let defects = agreement(&body, &motion(&[turned]), &swept, POINTS).defects(&swept);
        assert!(defects.is_empty(), "unit {unit}: {defects}");
        counts.push((triangles(&swept), swept.raw_triangles));
    }
    let (lean, raw) = counts[0];
    assert!(lean * 3 < raw * 2, "{counts:?}");
    for (other, _) in &counts {
        let change = other.abs_diff(lean);
        assert!(change * 20 <= lean, "but for rounding: {counts:?}");
    }
}

#[test]
fn the_bracket_of_the_guide_is_lean() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/bracket.stl");
    let (body, _) = read_body(&file).expect("a body");
    let turn = Generator::screw(DVec3::Z, DVec3::new(90.0, 20.0, 0.0), PI, 60.0, 1.0);
    let span = Span::new(turn, 1.0).expect("a span");
    let motion = Motion::from_spans(vec![span]).expect("a motion");
    let swept = sweep(&body, &motion, &SweepSettings::default()).expect("it can be swept");
    assert!(swept.raw_triangles > 30_000, "{}", swept.raw_triangles);
    assert!(triangles(&swept) < 15_000, "{}", triangles(&swept));
    assert!(
        swept.error_bound.inside.length <= swept.tolerance,
        "within the tolerance"
    );
    assert!(
        swept.error_bound.outside.length <= swept.tolerance,
        "within the tolerance"
    );
}

#[test]
fn the_command_keeps_all_triangles_when_told_to() {
    let scratch = Scratch::new("simplify");
    scratch.write("cube.obj", crate::support::command::CUBE);
    let report = |more: &str| -> serde_json::Value {
        let turn = "--turn 90 --axis 1,2,3 --through 3,0,0 --json";
        let run = scratch.run(&format!("sweep cube.obj {turn}{more}"));
        assert_eq!((run.code, run.err.as_str()), (Some(0), ""), "{more}");
        serde_json::from_str(&run.out).expect("a report")
    };
    let count =
        |report: &serde_json::Value, key: &str| report["sweep"][key].as_u64().expect("a count");
    let (on, off) = (report(" --simplify on"), report(" --simplify off"));
    assert_eq!(report("")["sweep"], on["sweep"], "that is the default");
    assert_eq!(count(&on, "raw_triangles"), count(&off, "triangles"));
    assert_eq!(count(&off, "raw_triangles"), count(&off, "triangles"));
    assert!(count(&on, "triangles") < count(&off, "triangles"), "{on}");
    scratch.write(
        "square.svg",
        "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 9 9'><path d='M0 0H1V1H0Z'/></svg>",
    );
    let refused = scratch.run("sweep square.svg --translate 1,0 --simplify off");
    assert_eq!(refused.code, Some(2), "{}", refused.err);
    assert!(refused.err.contains("--simplify"), "{}", refused.err);
}
