//! Motions from pose logs: the same poses as in keyframes, and refusals that name the line.

use crate::support::command::{CUBE, Scratch};
use crate::support::random::Random;
use glam::{DAffine2, DAffine3, DQuat, DVec2, DVec3};
use serde_json::Value;
use std::fmt::Write;
use std::fs;
use steadysweep::io::{self, PoseLogSettings, parse_pose_log};
use steadysweep::motion::{HalfTurns, Motion};

fn read(scratch: &Scratch, file: &str) -> Motion {
    io::read_motion(&scratch.path().join(file)).unwrap_or_else(|error| panic!("{error}"))
}

/// A walk of poses, each turned and moved a little from the one before.
fn walk(count: usize) -> Vec<(f64, DVec3, DQuat)> {
    let mut random = Random::new(7);
    let (mut time, mut place, mut turn) = (1_403_636_579.25, DVec3::ZERO, DQuat::IDENTITY);
    (0..count)
        .map(|_| {
            time += random.between(0.01, 0.1);
            place += random.point(0.1);
            let step = DQuat::from_axis_angle(random.direction(), 0.1 * random.unit());
            turn = (step * turn).normalize();
            (time, place, turn)
        })
        .collect()
}

#[test]
fn the_lines_of_a_recorder_are_keyframes() {
    let scratch = Scratch::new("pose_logs_tum");
    let mut log = "# timestamp tx ty tz qx qy qz qw\n".to_owned();
    let mut table = "\"qw\",qx,qy,qz,Time,z,y,x\r\n".to_owned();
    let poses = walk(50);
    for (time, p, q) in &poses {
        writeln!(
            log,
            "{time} {} {}\t{}  {} {} {} {}",
            p.x, p.y, p.z, q.x, q.y, q.z, q.w
        )
        .expect("text");
        write!(
            table,
            "{},{},{},{},{time}, {} ,{},{}\r\n",
            q.w, q.x, q.y, q.z, p.z, p.y, p.x
        )
        .expect("text");
        log.push_str("\n# a remark\n");
    }
    fs::create_dir(scratch.path().join("logs")).expect("our folder");
    scratch.write("logs/walk.txt", &log);
    scratch.write("logs/walk.csv", &table);
    scratch.write(
        "logs/tum.json",
        "{\"poses\": \"walk.txt\", \"columns\": \"t x y z qx qy qz qw\"}",
    );
    scratch.write("csv.json", "{\"poses\": \"logs/walk.csv\"}");
    for file in ["logs/tum.json", "csv.json"] {
        let motion = read(&scratch, file);
        assert_eq!(motion.joint_times().len(), 50);
        for (time, place, turn) in &poses {
            let expected = DAffine3::from_rotation_translation(*turn, *place);
            let found = motion.pose_at_time(*time);
            assert!(found.abs_diff_eq(expected, 1e-15), "{file}: {found:?}");
        }
    }
    // Times from elsewhere: other names for the columns of the table, and one that is not read.
    scratch.write(
        "without.json",
        "{\"poses\": \"logs/walk.csv\", \"columns\": \"qw qx qy qz - z y x\"}",
    );
    let motion = read(&scratch, "without.json");
    assert_eq!(motion.joint_times()[..3], [0.0, 1.0, 2.0]);
    assert_eq!(motion.start_pose(), read(&scratch, "csv.json").start_pose());
}

#[test]
fn rows_of_matrices_are_kitti() {
    let scratch = Scratch::new("pose_logs_kitti");
    scratch.write(
        "poses.txt",
        "1 0 0 0 0 1 0 0 0 0 1 0\n0 -1 0 5 1 0 0 6 0 0 2 7\n",
    );
    scratch.write(
        "kitti.json",
        "{\"poses\": \"poses.txt\", \"format\": \"kitti\"}",
    );
    let motion = read(&scratch, "kitti.json");
    assert_eq!(motion.joint_times(), [0.0, 1.0]);
    let end = motion
        .pose_at_time(1.0)
        .transform_point3(DVec3::new(1.0, 2.0, 3.0));
    assert_eq!(end, DVec3::new(3.0, 7.0, 13.0));
}

#[test]
fn euler_angles_of_a_log_are_read_as_their_name_says() {
    let scratch = Scratch::new("pose_logs_euler");
    scratch.write("log.csv", "0,0,0,0,0,0,0\n2,1,2,3,90,90,0\n");
    let end = |rotation: &str| {
        scratch.write(
            "log.json",
            format!("{{\"poses\": \"log.csv\", \"columns\": \"t x y z a b c\", \"rotation\": \"{rotation}\"}}"),
        );
        read(&scratch, "log.json").pose_at_time(2.0)
    };
    let near = |found: DVec3, expected: DVec3| assert!(found.distance(expected) < 1e-15, "{found}");
    // About z, then about the x axis of the body, which points along y by then.
    near(end("euler-zxz-deg").transform_vector3(DVec3::Y), DVec3::Z);
    // About z, then about the x axis of the world.
    near(end("fixed-zxz-deg").transform_vector3(DVec3::X), DVec3::Z);
    near(end("euler-zxz-deg").translation, DVec3::new(1.0, 2.0, 3.0));
}

#[test]
fn a_log_of_the_plane_moves_a_drawing() {
    let scratch = Scratch::new("pose_logs_plane");
    scratch.write("log.txt", "t x y deg\n0 0 0 0\n1 2 0 90\n3 2 0 120\n");
    scratch.write("log.json", "{\"poses\": \"log.txt\"}");
    let motion = io::read_planar_motion(&scratch.path().join("log.json")).expect("a motion");
    let expected = DAffine2::from_angle_translation(90.0_f64.to_radians(), DVec2::new(2.0, 0.0));
    assert_eq!(motion.pose_at_time(1.0), expected);
    let run = scratch.run("motion --motion log.json");
    assert!(
        run.out.starts_with("span 1: rotation in the plane"),
        "{}{}",
        run.out,
        run.err
    );
    scratch.write(
        "named.json",
        "{\"poses\": \"log.txt\", \"columns\": \"t x y rad\"}",
    );
    let run = scratch.run("motion --motion named.json --json");
    let report: Value = serde_json::from_str(&run.out).unwrap_or_else(|_| panic!("{}", run.err));
    let turn = report["spans"][1]["turn_deg"].as_f64().expect("a turn");
    // 30 radians and 5 turns are less than half a turn apart.
    let expected = (30.0 - 10.0 * std::f64::consts::PI).to_degrees();
    assert!((turn - expected).abs() < 1e-9, "{turn}");
    scratch.write(
        "plate.svg",
        "<svg xmlns=\"http://www.w3.org/2000/svg\"><rect width=\"1\" height=\"2\"/></svg>",
    );
    scratch.write("cube.obj", CUBE);
    let run = scratch.run("sweep plate.svg --motion log.json");
    assert_eq!(run.code, Some(0), "{}", run.err);
    let run = scratch.run("sweep cube.obj --motion log.json");
    assert!(
        run.err
            .contains("log.txt: line 1: the column \"deg\" belongs to a planar motion"),
        "{}",
        run.err
    );
}

#[test]
fn a_sweep_along_a_log_is_the_sweep_along_its_keyframes() {
    let scratch = Scratch::new("pose_logs_sweep");
    scratch.write("cube.obj", CUBE);
    scratch.write(
        "log.txt",
        "0 0 0 0 0 0 0 1\n1 3 0 0 0 0 0.6 0.8\n2 3 0 4 0 0 0.6 0.8\n",
    );
    scratch.write(
        "log.json",
        "{\"poses\": \"log.txt\", \"columns\": \"t x y z qx qy qz qw\"}",
    );
    scratch.write(
        "keys.json",
        "{\"keyframes\": [{}, {\"translation\": [3,0,0], \"rotation\": [0,0,0.6,0.8]}, {\"translation\": [3,0,4], \"rotation\": [0,0,0.6,0.8]}]}",
    );
    let sweep = |motion: &str| {
        let run = scratch.run(&format!("sweep cube.obj --motion {motion} --json"));
        let report: Value =
            serde_json::from_str(&run.out).unwrap_or_else(|_| panic!("{}", run.err));
        report["sweep"].clone()
    };
    assert_eq!(sweep("log.json"), sweep("keys.json"));
}

#[test]
fn a_hundred_thousand_poses_are_read() {
    let poses = walk(100_000);
    let mut log = String::new();
    for (time, p, q) in &poses {
        writeln!(
            log,
            "{time} {} {} {} {} {} {} {}",
            p.x, p.y, p.z, q.x, q.y, q.z, q.w
        )
        .expect("text");
    }
    let settings = PoseLogSettings {
        columns: Some("t x y z qx qy qz qw".to_owned()),
        ..PoseLogSettings::default()
    };
    let keys = parse_pose_log(log.as_bytes(), &settings).expect("poses");
    let motion = Motion::from_keyframes_turning(&keys, &HalfTurns::Refused).expect("a motion");
    assert_eq!(motion.spans().len(), 99_999);
}

#[test]
fn bad_logs_are_refused_with_their_line() {
    let scratch = Scratch::new("pose_logs_refused");
    scratch.write("cube.obj", CUBE);
    let tum = "\"columns\": \"t x y z qx qy qz qw\"";
    let start = "# a recorder\n0 0 0 0 0 0 0 1\n\n";
    let cases = [
        (
            format!("{start}1 2 3\n"),
            tum,
            "log.txt: line 4: expected 8 finite numbers t x y z qx qy qz qw, found \"1 2 3\"",
        ),
        (
            format!("{start}1 0 0 0 0 0 0 1 5\n"),
            tum,
            "line 4: expected 8 finite numbers",
        ),
        (
            format!("{start}1 0 0 0 0 0 0 nan\n"),
            tum,
            "line 4: expected 8 finite numbers",
        ),
        (
            format!("{start}1 0 0 0 0 0 x 1\n"),
            tum,
            "correct or remove the line, or the names of the columns",
        ),
        (
            "0;0;0;0;0;0;0;1\n".to_owned(),
            tum,
            "separate the numbers by commas or blanks, not by semicolons",
        ),
        (
            format!("{start}1 0 0 0 0 0 0 1.1\n"),
            tum,
            "log.txt: line 4: \"rotation\": expected a unit quaternion, length 1 within 1e-6, found length 1.1",
        ),
        (
            format!("{start}0 0 0 0 0 0 0 1\n"),
            tum,
            "log.txt: line 4: keyframe 1 is at time 0, expected a time above 0",
        ),
        (
            format!("{start}1 0 0 0 0 0 1 0\n"),
            tum,
            "log.txt: line 4: between keyframes 0 and 1: they are half a turn apart about the axis (0, 0, 1)",
        ),
        (
            start.to_owned(),
            tum,
            "log.txt: the motion has 1 keyframe, expected at least two",
        ),
        (String::new(), tum, "log.txt: the motion has 0 keyframes"),
        (format!("{start}\u{fffd}\n"), tum, "line 4"),
        (
            "0 0 0 0\n".to_owned(),
            "",
            "log.txt: line 1: expected a header with the names of the columns, found \"0 0 0 0\"; name them",
        ),
        (
            "time,x,y,depth\n".to_owned(),
            "",
            "log.txt: line 1: unknown column \"depth\"; columns are t x y z, qx qy qz qw or",
        ),
        (
            "t,x,y,z,qx,qy,qz\n".to_owned(),
            "",
            "line 1: the columns \"t x y z qx qy qz\" give no pose",
        ),
        (
            "t,x,y,z,a,b,c\n".to_owned(),
            "",
            "the angles a, b, c need \"rotation\"",
        ),
        (
            "t,x,y,z,x\n".to_owned(),
            "",
            "the column \"x\" is named twice",
        ),
        (
            String::new(),
            "\"columns\": \"t x y z a b c\", \"rotation\": \"zxz\"",
            "\"rotation\": expected euler-ORDER-deg",
        ),
        (
            String::new(),
            "\"columns\": \"t x y z\", \"rotation\": \"euler-zxz-deg\"",
            "\"rotation\" says how the angles a, b, c are read, but the columns are \"t x y z\"",
        ),
        (
            String::new(),
            "\"columns\": \"t x y z\", \"format\": \"kitti\"",
            "expected \"columns\" or the format kitti, found both",
        ),
        (
            String::new(),
            "\"format\": \"tum\"",
            "\"format\": expected \"kitti\", found \"tum\"",
        ),
        (
            "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 -1 0\n".to_owned(),
            "\"format\": \"kitti\"",
            "log.txt: line 2: keyframe 1: a reflection (determinant -1)",
        ),
    ];
    let refused = |arguments: &str, expected: &str| {
        let run = scratch.run(arguments);
        assert_eq!((run.code, run.out.as_str()), (Some(2), ""), "{}", run.err);
        assert!(run.err.contains(expected), "{expected}: {}", run.err);
        assert!(!scratch.files().contains(&"out.stl".to_owned()), "no file");
    };
    for (log, fields, expected) in cases {
        scratch.write("log.txt", &log);
        let fields = if fields.is_empty() {
            String::new()
        } else {
            format!(", {fields}")
        };
        scratch.write("log.json", format!("{{\"poses\": \"log.txt\"{fields}}}"));
        refused("sweep cube.obj --motion log.json -o out.stl", expected);
    }
    scratch.write("log.txt", b"0 0 0 0 0 0 0 1\n\xff\xfe\n");
    scratch.write("log.json", format!("{{\"poses\": \"log.txt\", {tum}}}"));
    refused(
        "sweep cube.obj --motion log.json",
        "log.txt: line 2: expected text",
    );
    scratch.write(
        "log.json",
        "{\"poses\": \"none.txt\", \"columns\": \"t x y z\"}",
    );
    refused(
        "sweep cube.obj --motion log.json",
        "log.json: none.txt: there is no such file",
    );
    scratch.write("log.json", "{\"poses\": \".\", \"columns\": \"t x y z\"}");
    refused("sweep cube.obj --motion log.json", "is a directory");
    scratch.write(
        "log.json",
        "{\"keyframes\": [{}, {}], \"columns\": \"t x y z\"}",
    );
    refused(
        "sweep cube.obj --motion log.json",
        "\"columns\" says how a pose log is read, but there is none: add \"poses\"",
    );
    scratch.write(
        "log.json",
        "{\"keyframes\": [{}, {}], \"poses\": \"log.txt\"}",
    );
    refused(
        "sweep cube.obj --motion log.json",
        "found more than one; give one of them",
    );
    let error = io::parse_motion(b"{\"poses\": \"log.txt\"}").expect_err("no folder");
    assert!(
        error.to_string().contains("\"poses\" names another file"),
        "{error}"
    );
}
