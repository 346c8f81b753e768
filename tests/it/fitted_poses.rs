//! Poses from pairs of points, and rotations by Euler angles.

use crate::support::command::{CUBE, Scratch};
use crate::support::random::Random;
use glam::{DAffine2, DAffine3, DMat3, DQuat, DVec2, DVec3};
use serde_json::Value;
use steadysweep::motion::{MotionError, from_points, planar};

fn random_pose(random: &mut Random) -> DAffine3 {
    loop {
        let pose = DAffine3 {
            matrix3: random.matrix(1.0),
            translation: random.point(3.0),
        };
        if pose.matrix3.determinant() > 0.05 {
            return pose;
        }
    }
}

fn difference(a: &DAffine3, b: &DAffine3) -> f64 {
    (a.matrix3 - b.matrix3)
        .to_cols_array()
        .iter()
        .fold((a.translation - b.translation).length(), |m, x| {
            m.max(x.abs())
        })
}

#[test]
fn an_affinity_is_found_again_from_points() {
    let mut random = Random::new(41);
    for count in [4, 5, 7, 60] {
        for _ in 0..200 {
            let pose = random_pose(&mut random);
            let sources: Vec<DVec3> = (0..count).map(|_| random.point(1.0)).collect();
            let corners = sources[1..4].iter().map(|p| *p - sources[0]);
            let edges: Vec<DVec3> = corners.collect();
            let volume = edges[0].cross(edges[1]).dot(edges[2]).abs();
            if count == 4 && volume < 0.01 {
                continue;
            }
            let pairs: Vec<[DVec3; 2]> = sources
                .iter()
                .map(|&p| [p, pose.transform_point3(p)])
                .collect();
            let fit = from_points(&pairs).expect("points in space");
            assert_eq!(fit.quality.pairs, count);
            assert!(fit.quality.largest < 4e-14, "{}", fit.quality.largest);
            let error = difference(&fit.pose, &pose);
            assert!(error < 1e-12, "{count} points: {error:e}");
        }
    }
}

#[test]
fn of_too_many_points_the_squares_are_least() {
    // At the least sum of squares, what is left has no mean and no moment along any coordinate.
    let mut random = Random::new(42);
    for _ in 0..200 {
        let pose = random_pose(&mut random);
        let far = random.point(1.0) * random.magnitude(1.0, 1e3);
        let pairs: Vec<[DVec3; 2]> = (0..9)
            .map(|_| {
                let source = far + random.point(1.0) * DVec3::new(1.0, 0.1, 10.0);
                [source, pose.transform_point3(source) + random.point(0.0005)]
            })
            .collect();
        let fit = from_points(&pairs).expect("points in space");
        let left: Vec<DVec3> = pairs
            .iter()
            .map(|[source, target]| *target - fit.pose.transform_point3(*source))
            .collect();
        let sum: DVec3 = left.iter().sum();
        assert!(sum.length() < 1e-10, "{sum}");
        let moments = pairs
            .iter()
            .zip(&left)
            .fold(DMat3::ZERO, |sum, (pair, &left)| {
                let arm = pair[0] - far;
                sum + DMat3::from_cols(left * arm.x, left * arm.y, left * arm.z)
            });
        let largest = moments
            .to_cols_array()
            .iter()
            .fold(0.0_f64, |m, x| m.max(x.abs()));
        assert!(largest < 1e-10, "{largest:e}");
        let distances: Vec<f64> = left.iter().map(|left| left.length()).collect();
        let squares: f64 = distances.iter().map(|d| d * d).sum();
        assert!((fit.quality.root_mean_square - (squares / 9.0).sqrt()).abs() < 1e-12);
        assert!(
            (fit.quality.largest - distances.iter().copied().fold(0.0, f64::max)).abs() < 1e-12
        );
    }
}

#[test]
fn the_square_with_one_corner_off_is_left_a_quarter_everywhere() {
    // An affine map of the plane can follow three corners; what the fourth is off, 0.4, remains by
    // a quarter at each, with alternating signs.
    let corners = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE];
    let mut pairs = corners.map(|corner| [corner, corner]);
    pairs[3][1] += DVec2::Y * 0.4;
    let fit = planar::from_points(&pairs).expect("a square");
    assert!((fit.quality.largest - 0.1).abs() < 1e-15);
    assert!((fit.quality.root_mean_square - 0.1).abs() < 1e-15);
    let expected = DAffine2::from_cols(
        DVec2::new(1.0, 0.2),
        DVec2::new(0.0, 1.2),
        DVec2::new(0.0, -0.1),
    );
    assert!(fit.pose.abs_diff_eq(expected, 1e-15), "{:?}", fit.pose);
}

#[test]
fn points_of_any_size_are_fitted() {
    for size in [1e-150, 1e-9, 1.0, 1e9, 1e150] {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let pairs = corners.map(|corner| [corner * size, (corner * 2.0 + DVec3::ONE) * size]);
        let fit = from_points(&pairs).expect("a corner");
        let expected = DAffine3::from_scale_rotation_translation(
            DVec3::splat(2.0),
            DQuat::IDENTITY,
            DVec3::splat(size),
        );
        let linear = (fit.pose.matrix3 - expected.matrix3).to_cols_array();
        assert!(
            linear.iter().all(|x| x.abs() < 1e-14),
            "{size:e}: {linear:?}"
        );
        assert!((fit.pose.translation / size - DVec3::ONE).length() < 1e-14);
    }
}

#[test]
fn points_that_make_no_pose_are_refused_by_name() {
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    let with = |of: &dyn Fn(DVec3) -> [DVec3; 2]| from_points(&corners.map(of));
    let mut random = Random::new(43);
    for _ in 0..100 {
        // Flat in any frame, near and far.
        let frame = random_pose(&mut random);
        let flat = |p: DVec3| frame.transform_point3(DVec3::new(p.x, p.y, 0.0)) + DVec3::splat(1e5);
        assert_eq!(
            with(&|p| [flat(p), p]),
            Err(MotionError::FlatSources { dimension: 3 })
        );
        assert_eq!(
            with(&|p| [p, flat(p)]),
            Err(MotionError::FlatTargets { dimension: 3 })
        );
        let mirrored = |p: DVec3| frame.transform_point3(p * DVec3::new(1.0, 1.0, -1.0));
        assert!(matches!(
            with(&|p| [p, mirrored(p)]),
            Err(MotionError::MirroredTargets { .. })
        ));
    }
    assert_eq!(
        from_points(&corners.map(|p| [p, p])[..3]),
        Err(MotionError::TooFewPoints {
            found: 3,
            needed: 4
        })
    );
    assert_eq!(
        with(&|p| [p, p / 0.0]),
        Err(MotionError::NonFinite { what: "points" })
    );
    let line = [0.0, 1.0, 3.0].map(|x| [DVec2::new(x, 2.0 * x), DVec2::new(x, x * x)]);
    assert_eq!(
        planar::from_points(&line),
        Err(MotionError::FlatSources { dimension: 2 })
    );
}

#[test]
fn keyframes_of_points_are_read_and_their_residual_is_told() {
    let scratch = Scratch::new("fitted_poses");
    scratch.write(
        "move.json",
        "{\"keyframes\": [{}, {\"points\": [[[0,0,0],[5,0,0]], [[1,0,0],[6,0,0]], [[0,1,0],[5,1,0]], [[0,0,1],[5,0,1]]]},
          {\"points\": [[[0,0],[5,0]], [[1,0],[6,0]], [[0,1],[5,1]]]}]}",
    );
    let run = scratch.run("motion --motion move.json");
    assert!(
        run.err
            .contains("keyframe 2: \"points\" has 2 numbers: a planar motion"),
        "{}",
        run.err
    );
    scratch.write(
        "move.json",
        "{\"keyframes\": [{\"points\": [[[0,0],[0,0]], [[1,0],[1,0]], [[0,1],[0,1]]]},
          {\"points\": [[[0,0],[5,0]], [[1,0],[6,0]], [[0,1],[5,1]], [[1,1],[6,1.4]]], \"turns\": 0}]}",
    );
    let run = scratch.run("motion --motion move.json --json");
    let report: Value = serde_json::from_str(&run.out).unwrap_or_else(|_| panic!("{}", run.err));
    let fitted = &report["fitted"];
    assert_eq!(
        (&fitted[0]["keyframe"], &fitted[0]["pairs"]),
        (&0.into(), &3.into())
    );
    assert_eq!(
        (&fitted[1]["keyframe"], &fitted[1]["pairs"]),
        (&1.into(), &4.into())
    );
    let largest = fitted[1]["largest"].as_f64().expect("a number");
    assert!((largest - 0.1).abs() < 1e-14, "{report}");
    let run = scratch.run("motion --motion move.json");
    let expected =
        "keyframe 1: fitted to 4 pairs of points, off by up to 0.1, 0.1 as the root mean square\n";
    assert!(run.out.ends_with(expected), "{}", run.out);
}

/// ADAMS gives the orientation of a marker by body-fixed 3-1-3 angles: psi about z, theta about the
/// new x, phi about the new z.
#[test]
fn euler_angles_are_those_of_their_name() {
    let scratch = Scratch::new("euler_keyframes");
    scratch.write("cube.obj", CUBE);
    let end = |rotation: &str| -> DMat3 {
        scratch.write(
            "key.json",
            format!("{{\"keyframes\": [{{}}, {{\"rotation\": {rotation}}}]}}"),
        );
        let motion = steadysweep::io::read_motion(&scratch.path().join("key.json"));
        motion.expect("a motion").pose_at_time(1.0).matrix3
    };
    // Written out by hand from the three elementary matrices, R = Rz(psi) Rx(theta) Rz(phi).
    let [(s1, c1), (s2, c2), (s3, c3)] =
        [30.0_f64, 40.0, 50.0].map(|deg| deg.to_radians().sin_cos());
    let rows = [
        [c1 * c3 - s1 * c2 * s3, -c1 * s3 - s1 * c2 * c3, s1 * s2],
        [s1 * c3 + c1 * c2 * s3, -s1 * s3 + c1 * c2 * c3, -c1 * s2],
        [s2 * s3, s2 * c3, c2],
    ];
    let expected = DMat3::from_cols_array_2d(&rows).transpose();
    let near = |found: DMat3, expected: DMat3| {
        assert!(
            found.abs_diff_eq(expected, 1e-15),
            "{found} instead of {expected}"
        );
    };
    near(end("{\"euler-zxz-deg\": [30, 40, 50]}"), expected);
    near(end("{\"fixed-zxz-deg\": [50, 40, 30]}"), expected);
    // Roll, pitch and yaw of a robot's description are about the fixed axes x, y and z.
    let [roll, pitch, yaw] = [0.1, -0.2, 0.3];
    let expected =
        DMat3::from_rotation_z(yaw) * DMat3::from_rotation_y(pitch) * DMat3::from_rotation_x(roll);
    near(end("{\"fixed-xyz-rad\": [0.1, -0.2, 0.3]}"), expected);
    near(end("{\"euler-zyx-rad\": [0.3, -0.2, 0.1]}"), expected);
}

#[test]
fn bad_points_and_angles_are_refused_with_their_key() {
    let scratch = Scratch::new("fitted_refused");
    scratch.write("cube.obj", CUBE);
    let unit = "[[0,0,0],[0,0,0]], [[1,0,0],[1,0,0]], [[0,1,0],[0,1,0]]";
    for (fields, expected) in [
        (
            format!("\"points\": [{unit}]"),
            "\"points\": 3 pairs of points are given, expected at least 4; add 1",
        ),
        (
            format!("\"points\": [{unit}, [[1,1,0],[0,0,1]]]"),
            "\"points\": the source points are on one plane, and leave the map open across it; add a pair away from it",
        ),
        (
            format!("\"points\": [{unit}, [[0,0,1],[1,1,0]]]"),
            "\"points\": the target points are on one plane: the map flattens the body; correct the targets",
        ),
        (
            format!("\"points\": [{unit}, [[0,0,1],[0,0,-1]]]"),
            "\"points\": the target points mirror the source points (determinant -1)",
        ),
        (
            format!("\"points\": [{unit}, [[0,0,1]]]"),
            "keyframe 1: invalid length 1",
        ),
        (
            format!("\"points\": [{unit}], \"scale\": 2"),
            "expected \"points\" alone",
        ),
        (
            "\"rotation\": {\"euler-zzx-deg\": [1,2,3]}".to_owned(),
            "\"rotation\": expected euler-ORDER-deg",
        ),
        (
            "\"rotation\": {\"euler-zxz-deg\": [1,2]}".to_owned(),
            "\"rotation\": expected three angles for euler-zxz-deg, found [1,2]",
        ),
        (
            "\"rotation\": 3".to_owned(),
            "\"rotation\": expected a quaternion of 4 numbers [x, y, z, w], or Euler angles",
        ),
        (
            "\"rotation\": [0,0,0,null]".to_owned(),
            "\"rotation\": expected a quaternion of 4 numbers",
        ),
    ] {
        scratch.write(
            "bad.json",
            format!("{{\"keyframes\": [{{}}, {{{fields}}}]}}"),
        );
        let run = scratch.run("sweep cube.obj --motion bad.json -o out.stl");
        assert_eq!((run.code, run.out.as_str()), (Some(2), ""), "{}", run.err);
        assert!(
            run.err.contains("bad.json: line 1") && run.err.contains("keyframe 1: "),
            "{}",
            run.err
        );
        assert!(run.err.contains(expected), "{}", run.err);
    }
}
