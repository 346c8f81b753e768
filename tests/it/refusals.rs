//! Bad input: one clear message that names the file, the place and the remedy; exit code 2, nothing
//! on stdout, no file.

use crate::support::command::{CUBE, Scratch};

/// Runs the binary, which must refuse, and returns its message, which must contain all of `parts`.
fn refused(scratch: &Scratch, arguments: &str, parts: &[&str]) -> String {
    let before = scratch.files();
    let run = scratch.run(arguments);
    assert_eq!(
        run.code,
        Some(2),
        "{arguments}: bad input has exit code 2: {}{}",
        run.out,
        run.err
    );
    assert_eq!(run.out, "", "{arguments}: nothing on stdout");
    assert!(run.err.starts_with("error: "), "{arguments}: {}", run.err);
    assert_eq!(
        run.err.matches("error: ").count(),
        1,
        "{arguments}: one message: {}",
        run.err
    );
    for part in parts {
        assert!(
            run.err.contains(part),
            "{arguments}: {part:?} is missing: {}",
            run.err
        );
    }
    assert_eq!(scratch.files(), before, "{arguments}: no file appears");
    run.err
}

/// Checks that a body file with these contents is refused.
fn body_refused(test: &str, name: &str, contents: impl AsRef<[u8]>, parts: &[&str]) {
    let scratch = Scratch::new(test);
    scratch.write(name, contents);
    let message = refused(
        &scratch,
        &format!("sweep {name} --translate 1,0,0 -o out.stl"),
        parts,
    );
    assert!(
        message.contains(name),
        "the message names the file: {message}"
    );
    // The other command that reads a body refuses it for the same reason.
    scratch.write("points.csv", "0,0,0\n");
    let again = refused(
        &scratch,
        &format!("probe {name} --translate 1,0,0 --points points.csv"),
        &[],
    );
    assert_eq!(again, message, "one reader, one message");
}

/// Checks that a motion file with these contents is refused.
fn motion_refused(test: &str, contents: &str, parts: &[&str]) {
    let scratch = Scratch::new(test);
    scratch.write("cube.obj", CUBE);
    scratch.write("path.json", contents);
    let message = refused(&scratch, "motion --motion path.json", parts);
    assert!(
        message.contains("path.json"),
        "the message names the file: {message}"
    );
    let again = refused(
        &scratch,
        "sweep cube.obj --motion path.json -o out.stl",
        &[],
    );
    assert_eq!(again, message, "one reader, one message");
}

/// The triangles of the unit cube with corner i at the binary digits of i.
const TRIANGLES: [[usize; 3]; 12] = [
    [0, 2, 3],
    [0, 3, 1],
    [4, 5, 7],
    [4, 7, 6],
    [0, 1, 5],
    [0, 5, 4],
    [2, 6, 7],
    [2, 7, 3],
    [0, 4, 6],
    [0, 6, 2],
    [1, 3, 7],
    [1, 7, 5],
];

/// A binary STL of these triangles, with the number of triangles that its header claims.
fn binary_stl(triangles: &[[[f32; 3]; 3]], claimed: u32) -> Vec<u8> {
    let mut bytes = vec![0; 80];
    bytes.extend(claimed.to_le_bytes());
    for triangle in triangles {
        bytes.extend([0; 12]);
        bytes.extend(
            triangle
                .iter()
                .flatten()
                .flat_map(|value| value.to_le_bytes()),
        );
        bytes.extend([0; 2]);
    }
    bytes
}

fn cube_corners() -> Vec<[[f32; 3]; 3]> {
    let corner =
        |i: usize| [i & 1, i >> 1 & 1, i >> 2].map(|digit| if digit == 0 { 0.0 } else { 1.0 });
    TRIANGLES
        .iter()
        .map(|triangle| triangle.map(corner))
        .collect()
}

#[test]
fn the_cubes_of_these_tests_are_bodies_as_long_as_nothing_is_wrong_with_them() {
    let scratch = Scratch::new("good_cubes");
    scratch.write("cube.obj", CUBE);
    scratch.write("cube.stl", binary_stl(&cube_corners(), 12));
    for name in ["cube.obj", "cube.stl"] {
        let run = scratch.run(&format!("sweep {name} --translate 0,0,1"));
        assert_eq!((run.code, run.err.as_str()), (Some(0), ""), "{name}");
    }
}

#[test]
fn an_open_mesh_is_refused_with_edge_and_triangle() {
    // Face 5 of the file, next to the missing last one, shares the edge from vertex 4 to vertex 8.
    let open = CUBE.replace("f 4 1 5 8\n", "");
    body_refused(
        "open_mesh",
        "open.obj",
        open,
        &[
            "edge",
            "triangle",
            "has no neighbour",
            "not closed",
            "fill the hole",
        ],
    );
    let open = &cube_corners()[1..];
    body_refused(
        "open_stl",
        "open.stl",
        binary_stl(open, 11),
        &["edge", "triangle", "has no neighbour", "fill the hole"],
    );
}

#[test]
fn an_edge_of_three_triangles_is_refused() {
    let fin = format!("{CUBE}v 0.5 -1 0.5\nf 1 2 9\nf 2 1 9\nf 1 2 9\n");
    body_refused("non_manifold", "fin.obj", fin, &["edge"]);
}

#[test]
fn numbers_that_are_not_finite_are_refused_with_their_place() {
    body_refused(
        "nan_obj",
        "nan.obj",
        CUBE.replace("v 1 1 1", "v 1 NaN 1"),
        &["7"],
    );
    let mut corners = cube_corners();
    corners[3][1][2] = f32::INFINITY;
    body_refused("inf_stl", "inf.stl", binary_stl(&corners, 12), &["3"]);
}

#[test]
fn an_index_out_of_range_is_refused_with_its_line() {
    body_refused(
        "index",
        "index.obj",
        CUBE.replace("f 4 1 5 8", "f 4 1 5 80"),
        &["80", "line 14"],
    );
    body_refused(
        "negative_index",
        "negative.obj",
        CUBE.replace("f 4 1 5 8", "f 4 1 5 -80"),
        &["-80", "line 14"],
    );
}

#[test]
fn a_flat_body_is_refused() {
    let flat = CUBE.lines().map(|line| {
        if line.starts_with('v') {
            format!("{} 0\n", &line[..5])
        } else {
            format!("{line}\n")
        }
    });
    body_refused(
        "flat",
        "flat.obj",
        flat.collect::<String>(),
        &["flat", "thickness"],
    );
}

#[test]
fn a_body_lost_in_the_rounding_of_its_coordinates_is_refused_with_a_remedy() {
    // In single precision, neighbouring numbers near 1e9 are 64 apart.
    let far = cube_corners()
        .into_iter()
        .map(|triangle| triangle.map(|corner| corner.map(|x| x + 1e9)));
    body_refused(
        "lost",
        "lost.stl",
        binary_stl(&far.collect::<Vec<_>>(), 12),
        &["12 faces", "rounding", "nearer to the origin"],
    );
    body_refused(
        "repeated",
        "repeated.obj",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 1\nf 3 3 3\n",
        &["2 faces", "two corners at one place"],
    );
}

#[test]
fn an_empty_file_is_refused() {
    for name in ["empty.stl", "empty.obj", "empty.ply"] {
        body_refused(&format!("empty_{}", &name[6..]), name, "", &["empty"]);
    }
}

#[test]
fn a_truncated_binary_stl_is_refused_with_both_counts() {
    let bytes = binary_stl(&cube_corners(), 12);
    body_refused(
        "truncated",
        "cut.stl",
        &bytes[..bytes.len() - 120],
        &["12", "9", "cut off", "export it again"],
    );
}

#[test]
fn a_claim_of_four_billion_triangles_is_refused_without_allocating_them() {
    body_refused(
        "claims",
        "huge.stl",
        binary_stl(&cube_corners(), u32::MAX),
        &["4294967295", "12"],
    );
    let ply = "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\n\
               property float z\nelement face 4000000000\nproperty list uchar int vertex_indices\nend_header\n";
    body_refused("claims_ply", "huge.ply", ply, &["4000000000"]);
}

#[test]
fn an_unknown_extension_is_refused_with_those_that_are_known() {
    for (test, name) in [("extension", "cube.xyz"), ("no_extension", "cube")] {
        body_refused(test, name, CUBE, &[".stl", ".obj", ".ply"]);
    }
    let scratch = Scratch::new("out_extension");
    scratch.write("cube.obj", CUBE);
    for output in ["out.xyz", "out", "out.glb", "out.png", "out.svg"] {
        refused(
            &scratch,
            &format!("sweep cube.obj --translate 1,0,0 -o {output}"),
            &[output, ".stl", ".obj", ".ply"],
        );
    }
}

#[test]
fn a_missing_body_is_refused() {
    let scratch = Scratch::new("missing");
    refused(
        &scratch,
        "sweep nowhere.stl --translate 1,0,0 -o out.stl",
        &["nowhere.stl", "no such file"],
    );
    scratch.write("cube.obj", CUBE);
    refused(
        &scratch,
        "probe cube.obj --translate 1,0,0 --points nowhere.csv",
        &["nowhere.csv", "no such file"],
    );
    refused(
        &scratch,
        "sweep cube.obj --motion nowhere.json",
        &["nowhere.json", "no such file"],
    );
}

/// Two keyframes, the second with this matrix.
fn keys(matrix: &str) -> String {
    format!(
        r#"{{"keyframes":[{{"matrix":[[1,0,0,0],[0,1,0,0],[0,0,1,0]]}},{{"matrix":{matrix}}}]}}"#
    )
}

#[test]
fn an_unknown_field_is_refused_by_name() {
    motion_refused(
        "field",
        r#"{"spans":[{"turn":90,"axis":[0,0,1]}]}"#,
        &["turn", "turn_deg"],
    );
    motion_refused(
        "top_field",
        r#"{"frames":[]}"#,
        &["frames", "keyframes", "spans"],
    );
    motion_refused(
        "key_field",
        r#"{"keyframes":[{"when":0}]}"#,
        &["when", "time"],
    );
}

#[test]
fn a_motion_file_that_is_no_json_is_refused_with_line_and_column() {
    motion_refused("syntax", "{\n  \"spans\": [\n", &["line"]);
    motion_refused("empty_motion", "", &["empty"]);
    motion_refused(
        "no_object",
        "[]",
        &["line 1", "expected an object", "found a list"],
    );
}

#[test]
fn a_matrix_of_another_shape_is_refused() {
    motion_refused("rows", &keys("[[1,0,0,0],[0,1,0,0]]"), &["3"]);
    motion_refused("columns", &keys("[[1,0,0],[0,1,0],[0,0,1]]"), &["4"]);
    motion_refused(
        "generator",
        r#"{"spans":[{"generator":[[0,0,0],[0,0,0],[0,0,0]]}]}"#,
        &["4"],
    );
}

#[test]
fn poses_without_a_steady_motion_between_them_are_refused_by_name() {
    motion_refused(
        "reflection",
        &keys("[[-1,0,0,0],[0,1,0,0],[0,0,1,0]]"),
        &["reflection", "keyframe 1"],
    );
    motion_refused(
        "singular",
        &keys("[[1,0,0,0],[0,1,0,0],[0,0,0,0]]"),
        &["keyframe 1"],
    );
    // The eigenvalues are -1 and -2, once each: no real matrix has them in its exponential.
    motion_refused(
        "no_logarithm",
        &keys("[[-1,0,0,0],[0,-2,0,0],[0,0,1,0]]"),
        &["logarithm", "keyframe"],
    );
}

#[test]
fn a_scale_that_is_not_positive_is_refused() {
    for (test, scale) in [("scale_zero", "0"), ("scale_negative", "-0.5")] {
        let file = format!(r#"{{"spans":[{{"turn_deg":90,"axis":[0,0,1],"scale":{scale}}}]}}"#);
        motion_refused(test, &file, &["scale", scale, "span 0"]);
        let scratch = Scratch::new(&format!("{test}_option"));
        refused(
            &scratch,
            &format!("motion --turn 90 --axis 0,0,1 --scale {scale}"),
            &["--scale", scale, "above 0"],
        );
    }
}

#[test]
fn a_zero_axis_is_refused() {
    motion_refused(
        "axis_file",
        r#"{"spans":[{"turn_deg":90,"axis":[0,0,0]}]}"#,
        &["axis", "span 0"],
    );
    motion_refused(
        "axis_missing",
        r#"{"spans":[{"turn_deg":90}]}"#,
        &["expected \"axis\"", "found none", "span 0"],
    );
    let scratch = Scratch::new("axis_option");
    refused(
        &scratch,
        "motion --turn 90 --axis 0,0,0",
        &["--axis 0,0,0", "0,0,1"],
    );
}

#[test]
fn a_single_keyframe_is_refused() {
    motion_refused(
        "one_key",
        r#"{"keyframes":[{"matrix":[[1,0,0,0],[0,1,0,0],[0,0,1,0]]}]}"#,
        &["keyframe", "1", "two"],
    );
}

#[test]
fn a_time_that_does_not_increase_is_refused() {
    let key = |time: &str| {
        format!(r#"{{"time":{time},"translation":[0,0,0],"rotation":[0,0,0,1],"scale":[1,1,1]}}"#)
    };
    for (test, times) in [
        ("time_equal", ["0", "2", "2"]),
        ("time_back", ["0", "2", "1"]),
    ] {
        let file = format!(r#"{{"keyframes":[{}]}}"#, times.map(key).join(","));
        motion_refused(test, &file, &["time", "keyframe 2"]);
    }
}

#[test]
fn a_tolerance_that_cannot_be_met_is_refused() {
    let scratch = Scratch::new("tolerances");
    scratch.write("cube.obj", CUBE);
    for tolerance in ["0", "-0.1", "NaN", "inf", "small"] {
        refused(
            &scratch,
            &format!("sweep cube.obj --translate 1,0,0 -o out.stl --tolerance {tolerance}"),
            &["--tolerance"],
        );
    }
    refused(
        &scratch,
        "sweep cube.obj --turn 90 --axis 0,0,1 -o out.stl --tolerance 1e-8",
        &[
            "coordinates up to 1.4",
            "write .obj or .ply",
            "nearer to the origin",
        ],
    );
    for output in ["out.stl", "out.obj"] {
        let sweep = format!("sweep cube.obj --turn 90 --axis 0,0,1 -o {output} --tolerance");
        let message = refused(
            &scratch,
            &format!("{sweep} 1e-17"),
            &["tolerance 1e-17", "smallest usable value"],
        );
        // The value that the message names is usable as far as rounding is concerned.
        let smallest: f64 = message
            .trim()
            .rsplit(' ')
            .next()
            .and_then(|word| word.parse().ok())
            .expect("a number at the end");
        let below = refused(
            &scratch,
            &format!("{sweep} {:e}", smallest * 0.99),
            &["smallest usable value"],
        );
        assert!(
            below.trim().ends_with(&format!("{smallest:e}")),
            "the same value again: {below}"
        );
    }
}

#[test]
fn an_output_directory_that_cannot_be_written_is_refused_before_the_work() {
    let scratch = Scratch::new("directories");
    scratch.write("cube.obj", CUBE);
    let sweep = "sweep cube.obj --translate 1,0,0 -o";
    refused(
        &scratch,
        &format!("{sweep} nowhere/out.stl"),
        &["nowhere", "create it"],
    );
    refused(
        &scratch,
        &format!("{sweep} cube.obj/out.stl"),
        &["cube.obj"],
    );

    let locked = scratch.path().join("locked.stl");
    std::fs::create_dir(&locked).expect("the scratch directory must be writable");
    refused(
        &scratch,
        &format!("{sweep} locked.stl"),
        &["locked.stl", "directory"],
    );

    let mut permissions = std::fs::metadata(&locked)
        .expect("the directory is there")
        .permissions();
    permissions.set_readonly(true);
    std::fs::set_permissions(&locked, permissions).expect("the permissions can be changed");
    // The superuser may write anywhere but in the file system of the kernel.
    let is_superuser = std::fs::write(locked.join("probe"), "").is_ok();
    let directory = if is_superuser { "/proc" } else { "locked.stl" };
    refused(
        &scratch,
        &format!("{sweep} {directory}/out.stl"),
        &[directory, "another place"],
    );
}

#[test]
fn motion_options_that_do_not_fit_are_refused_by_name() {
    let scratch = Scratch::new("motion_options");
    let cases: [(&str, &[&str]); 9] = [
        ("", &["--motion", "--turn", "--translate"]),
        ("--turn 90", &["--turn", "--axis"]),
        (
            "--turn 90 --axis 0,0,1 --translate 1,0,0",
            &["--turn", "--translate"],
        ),
        ("--axis 0,0,1 --advance 3", &["--axis", "--turn"]),
        ("--translate 1,0,0 --scale 2", &["--translate", "--scale"]),
        ("--turn NaN --axis 0,0,1", &["--turn", "finite"]),
        ("--turn 90 --axis 0,0,inf", &["--axis", "finite"]),
        (
            "--translate 1",
            &["--translate", "three numbers", "two X,Y"],
        ),
        ("--turn 90 --axis 0,0,1 --frobnicate", &["--frobnicate"]),
    ];
    for (options, parts) in cases {
        refused(&scratch, &format!("motion {options}"), parts);
    }
}

#[test]
fn points_that_are_no_points_are_refused_with_their_line() {
    let scratch = Scratch::new("points");
    scratch.write("cube.obj", CUBE);
    for (points, place) in [
        ("0,0,0\n1,2\n", "line 2"),
        ("x,y,z\n0,0,0\n\n1,b,2\n", "line 4"),
        ("1,2,inf\n", "line 1"),
    ] {
        scratch.write("points.csv", points);
        refused(
            &scratch,
            "probe cube.obj --translate 1,0,0 --points points.csv",
            &["points.csv", place],
        );
    }
}
