//! Bodies from files: what is read, what is written, and how each kind of bad file is refused.

use crate::support::data;
use crate::support::random::Random;
use glam::DVec3;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;
use steadysweep::body::{Mesh, ShellRole};
use steadysweep::io::{MeshFormat, parse_body, parse_motion, parse_points};
use steadysweep::io::{check_output, read_body, read_motion, read_points, write_mesh};

/// A folder for one test, removed at its end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Folder {
        // Numbered, since tests that run in parallel ask for the same name.
        static NUMBER: AtomicUsize = AtomicUsize::new(0);
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        let process = std::process::id();
        let folder =
            std::env::temp_dir().join(format!("steadysweep-bodies-{process}-{number}-{name}"));
        fs::create_dir_all(&folder).expect("a folder for temporary files");
        Folder(folder)
    }
    fn write(&self, name: &str, contents: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.join(name);
        fs::write(&path, contents).expect("our folder is writable");
        path
    }
    fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(&self.0).expect("our folder");
        let mut names: Vec<String> = entries
            .map(|entry| {
                entry
                    .expect("an entry")
                    .file_name()
                    .to_string_lossy()
                    .into_owned()
            })
            .collect();
        names.sort();
        names
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// The box from the origin to `size` as OBJ: squares, counter-clockwise from outside.
fn box_obj(size: [f64; 3]) -> String {
    let mut text = String::new();
    for i in 0..8u32 {
        let corner = [i & 1, i >> 1 & 1, i >> 2];
        let [x, y, z] = [0, 1, 2].map(|axis| size[axis] * f64::from(corner[axis]));
        text += &format!("v {x} {y} {z}\n");
    }
    text + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n"
}

/// The unit cube with each square cut into two triangles.
fn cube() -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let folder = Folder::new("cube");
    let (body, _) = read_body(&folder.write("cube.obj", box_obj([1.0; 3]))).expect("a cube");
    (body.positions().to_vec(), body.triangles().to_vec())
}

/// The same triangles as text STL.
fn stl_text(positions: &[DVec3], triangles: &[[u32; 3]]) -> String {
    let mut text = String::from("solid part\n");
    for triangle in triangles {
        text += "facet normal 0 0 0\nouter loop\n";
        for [x, y, z] in triangle.map(|v| positions[v as usize].to_array()) {
            text += &format!("vertex {x:?} {y:?} {z:?}\n");
        }
        text += "endloop\nendfacet\n";
    }
    text + "endsolid part\n"
}

/// The refusal of a file with this name and these contents, without the path of the folder.
fn refusal(name: &str, contents: impl AsRef<[u8]>) -> String {
    let folder = Folder::new(&format!("refusal-{}", name.replace('.', "-")));
    let path = folder.write(name, contents);
    let text = match path.extension().and_then(|extension| extension.to_str()) {
        Some("json") => read_motion(&path).expect_err("refused").to_string(),
        Some("csv") => read_points(&path).expect_err("refused").to_string(),
        _ => read_body(&path).expect_err("refused").to_string(),
    };
    text.strip_prefix(&format!("{}: ", path.display()))
        .expect("the file is named first")
        .to_owned()
}

fn euler_characteristic(body: &Mesh) -> i64 {
    let count = |n: usize| i64::try_from(n).expect("a length");
    count(body.positions().len()) - count(body.edges().len()) + count(body.triangles().len())
}

#[test]
fn real_parts_are_read_as_closed_bodies() {
    let Some(folder) = data::folder("") else {
        return;
    };
    // Triangles, shells and Euler characteristic, measured by another program after merging
    // vertices within 1e-8 (the characteristic is twice the number of shells minus twice the number
    // of holes).
    let expected = [
        ("cad/idler_riser.STL", 1572, 1, -4),
        ("cad/angle_block.STL", 704, 1, 0),
        ("cad/boxedSphere.stl", 65492, 2, -6),
        ("cad/naca0012.stl", 788, 1, 2),
        ("cad/cap.stl", 4496, 1, 2),
        ("cad/fandisk.obj", 5750, 1, 2),
    ];
    for (name, triangles, shells, euler) in expected {
        let start = Instant::now();
        let (body, report) =
            read_body(&folder.join(name)).unwrap_or_else(|error| panic!("{error}"));
        let seconds = start.elapsed().as_secs_f64();
        assert!(seconds < 1.0, "{name} took {seconds} s");
        assert_eq!(body.triangles().len(), triangles, "{name}");
        assert_eq!((report.faces, report.collapsed), (triangles, 0), "{name}");
        assert_eq!(body.shells().len(), shells, "{name}");
        assert_eq!(euler_characteristic(&body), euler, "{name}");
        assert!(
            body.shells()
                .iter()
                .all(|shell| shell.role == ShellRole::Outer),
            "{name}"
        );
        assert!(!body.turned(), "{name}");
        assert!(
            report.largest_move <= 1e-9 * body.diagonal(),
            "{name}: {report:?}"
        );
        // Only this part needs more than exact equality: without it, 44 edges are unmatched.
        if name.contains("idler_riser") {
            assert!(report.joined && report.welded > 0, "{report:?}");
        }
    }
}

#[test]
fn robot_links_are_read_as_closed_convex_bodies() {
    let Some(folder) = data::folder("") else {
        return;
    };
    // Number of files and triangles of each robot, from the documentation of the data.
    for (robot, files, triangles) in [("panda", 10, 2332), ("fanuc", 7, 6934), ("ur5e", 7, 7558)] {
        let mut found = (0, 0);
        for entry in fs::read_dir(folder.join(robot).join("meshes")).expect("a folder of meshes") {
            let path = entry.expect("an entry").path();
            if !path
                .extension()
                .is_some_and(|extension| extension.eq_ignore_ascii_case("stl"))
            {
                continue;
            }
            let (body, report) = read_body(&path).unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(euler_characteristic(&body), 2, "{}", path.display());
            assert_eq!(body.shells().len(), 1, "{}", path.display());
            found = (found.0 + 1, found.1 + report.faces);
        }
        assert_eq!(found, (files, triangles), "{robot}");
    }
}

#[test]
fn every_format_gives_back_the_body_that_was_written() {
    let folder = Folder::new("round-trip");
    let (mut positions, triangles) = cube();
    // Coordinates that are not exact in f32.
    positions
        .iter_mut()
        .for_each(|p| *p = *p / 3.0 + DVec3::splat(0.1));
    for (name, exact) in [
        ("cube.stl", false),
        ("cube.obj", true),
        ("cube.ply", true),
        ("CUBE.STL", false),
    ] {
        let path = folder.write(name, "old");
        write_mesh(&path, &positions, &triangles).unwrap_or_else(|error| panic!("{error}"));
        let (body, report) = read_body(&path).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(
            (report.faces, report.collapsed, report.welded),
            (12, 0, 0),
            "{name}"
        );
        assert_eq!(body.triangles().len(), 12, "{name}");
        if exact {
            assert_eq!(body.positions(), positions, "{name}");
            assert_eq!(body.triangles(), triangles, "{name}");
        } else {
            assert!(
                (body.volume() * 27.0 - 1.0).abs() < 1e-6,
                "{name} is rounded to f32"
            );
        }
    }
    assert_eq!(
        folder.names(),
        ["CUBE.STL", "cube.obj", "cube.ply", "cube.stl"],
        "no temporary file is left"
    );
}

#[test]
fn vertices_that_coincide_are_joined_and_reported() {
    let folder = Folder::new("weld");
    let (positions, triangles) = cube();
    let diagonal = 3f64.sqrt();
    // Each triangle misses its corners by an amount of its own, up to 0.9e-9 / 2 of the diagonal.
    let missed = |share: f64| {
        let mut apart = Vec::new();
        for (i, corners) in (0u32..).zip(&triangles) {
            let shift = DVec3::X * (share * diagonal * f64::from(i) / 11.0);
            apart.extend(corners.map(|v| positions[v as usize] + shift));
        }
        let list: Vec<[u32; 3]> = (0u32..12).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        stl_text(&apart, &list)
    };
    let (body, report) = read_body(&folder.write("near.stl", missed(0.9e-9)))
        .unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(
        (body.positions().len(), body.triangles().len()),
        (8, 12),
        "eight corners"
    );
    assert!(report.joined && report.welded > 0, "{report:?}");
    assert!(
        report.largest_move > 0.1e-9 * diagonal && report.largest_move <= 1.0001e-9 * diagonal,
        "{report:?}"
    );
    let text = read_body(&folder.write("far.stl", missed(1e-6)))
        .expect_err("open")
        .to_string();
    assert!(
        text.contains("has no neighbour: the mesh is not closed"),
        "{text}"
    );
}

#[test]
fn an_indexed_mesh_with_split_vertices_is_joined_only_when_it_is_open_without() {
    let folder = Folder::new("split");
    let (positions, triangles) = cube();
    let mut text = String::new();
    for p in triangles.iter().flatten().map(|&v| positions[v as usize]) {
        text += &format!("v {} {} {}\n", p.x, p.y, p.z);
    }
    for i in 0..12 {
        text += &format!("f {} {} {}\n", 3 * i + 1, 3 * i + 2, 3 * i + 3);
    }
    let (body, report) =
        read_body(&folder.write("split.obj", &text)).unwrap_or_else(|error| panic!("{error}"));
    assert!(report.joined, "{report:?}");
    assert_eq!(
        (body.positions().len(), report.welded),
        (8, 0),
        "by exact equality"
    );
    // Two cubes that share an edge by position but not by index are two shells, not a non-manifold
    // edge.
    let one = box_obj([1.0; 3]);
    let mut both = one.clone();
    for line in one.lines() {
        let numbers: Vec<f64> = line[2..]
            .split(' ')
            .map(|word| word.parse().expect("a number"))
            .collect();
        both += &match line.as_bytes()[0] {
            b'v' => format!(
                "v {} {} {}\n",
                numbers[0] - 1.0,
                numbers[1] - 1.0,
                numbers[2]
            ),
            _ => format!(
                "f {}\n",
                numbers
                    .iter()
                    .map(|n| (n + 8.0).to_string())
                    .collect::<Vec<_>>()
                    .join(" ")
            ),
        };
    }
    let (body, report) =
        read_body(&folder.write("both.obj", &both)).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(
        (body.shells().len(), report.joined),
        (2, false),
        "as the file says"
    );
}

#[test]
fn collapsed_triangles_are_left_out_and_counted() {
    let folder = Folder::new("collapsed");
    let text = box_obj([1.0; 3]) + "f 1 1 3\nf 2 4 4 2\n";
    let (body, report) =
        read_body(&folder.write("part.obj", &text)).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(
        (body.triangles().len(), report.faces, report.polygons),
        (12, 8, 7),
        "six squares and two damaged faces"
    );
    assert_eq!(report.collapsed, 2, "both damaged faces");
}

#[test]
fn a_part_inside_out_is_turned_and_cavities_are_told() {
    let folder = Folder::new("roles");
    let (positions, triangles) = cube();
    let mut all = positions.clone();
    all.extend(positions.iter().map(|p| *p * 0.5 + DVec3::splat(0.25)));
    let inward = |t: &[u32; 3]| [t[0], t[2], t[1]];
    let mut list: Vec<[u32; 3]> = triangles.iter().map(inward).collect();
    list.extend(triangles.iter().map(|t| t.map(|v| v + 8)));
    let (body, _) = read_body(&folder.write("part.stl", stl_text(&all, &list)))
        .unwrap_or_else(|error| panic!("{error}"));
    assert!(body.turned(), "the larger shell was inward");
    assert_eq!(
        body.shells()
            .iter()
            .map(|shell| shell.role)
            .collect::<Vec<_>>(),
        [ShellRole::Outer, ShellRole::Cavity]
    );
    assert!((body.volume() - 0.875).abs() < 1e-15, "{}", body.volume());
}

#[test]
fn an_open_mesh_is_refused_with_edge_triangle_and_place() {
    let (positions, mut triangles) = cube();
    let removed = triangles.pop().expect("twelve triangles");
    let text = refusal("open.stl", stl_text(&positions, &triangles));
    assert!(
        text.starts_with("not a body, 3 defects (triangles and vertices counted from 0):\n  edge "),
        "{text}"
    );
    assert_eq!(
        text.matches("has no neighbour: the mesh is not closed")
            .count(),
        3,
        "{text}"
    );
    assert!(
        text.ends_with(
            "\nfill the hole in a mesh repair tool or export the part as a closed solid"
        ),
        "{text}"
    );
    for v in removed {
        assert!(
            text.contains(&format!("{}", positions[v as usize])),
            "{v} is a corner of the hole: {text}"
        );
    }
    // In an OBJ, edges and faces have the numbers of the file: face 5 is missing, so edges 1-3,
    // 3-7, 7-5 and 5-1 are open.
    let open: String = box_obj([1.0; 3])
        .lines()
        .filter(|line| *line != "f 2 4 8 6")
        .map(|line| format!("{line}\n"))
        .collect();
    let text = refusal("open.obj", open);
    assert!(
        text.contains("edge 1-5 of triangle 2, from [1, 0, 0] to [1, 0, 1], has no neighbour"),
        "{text}"
    );
    assert!(
        text.contains("edge 3-1 of triangle 0, from [1, 1, 0] to [1, 0, 0], has no neighbour"),
        "{text}"
    );
}

#[test]
fn many_defects_are_listed_to_ten() {
    let (positions, triangles) = cube();
    let scattered: Vec<DVec3> = triangles
        .iter()
        .flatten()
        .zip(0u32..)
        .map(|(&v, i)| positions[v as usize] + f64::from(i))
        .collect();
    let list: Vec<[u32; 3]> = (0u32..12).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let text = refusal("soup.stl", stl_text(&scattered, &list));
    assert!(text.starts_with("not a body, 36 defects"), "{text}");
    assert!(text.contains("\n  and 26 more\n"), "{text}");
    assert_eq!(text.lines().count(), 13, "{text}");
}

#[test]
fn a_non_manifold_edge_is_refused_with_its_triangles() {
    let (mut positions, mut triangles) = cube();
    let (a, b) = (triangles[0][0], triangles[0][1]);
    let first = u32::try_from(positions.len()).expect("few vertices");
    positions.extend([DVec3::splat(-1.0), DVec3::new(-1.0, -1.0, -2.0)]);
    triangles.extend([
        [a, b, first],
        [b, a, first + 1],
        [a, first, first + 1],
        [b, first + 1, first],
    ]);
    let text = refusal("fin.stl", stl_text(&positions, &triangles));
    assert!(text.contains("is shared by 4 triangles ("), "{text}");
    assert!(
        text.contains(
            "12, 13), expected 2: the surface is non-manifold (counted from 0); separate the parts"
        ),
        "{text}"
    );
}

#[test]
fn neighbours_of_opposite_orientation_are_refused() {
    let (positions, mut triangles) = cube();
    triangles[7].swap(0, 1);
    let text = refusal("opposed.stl", stl_text(&positions, &triangles));
    assert_eq!(
        text.matches("run in the same sense through edge").count(),
        3,
        "{text}"
    );
    assert!(
        text.ends_with("\nmake the orientation of the triangles consistent in a mesh repair tool"),
        "{text}"
    );
}

#[test]
fn numbers_that_are_not_finite_are_refused_with_their_place() {
    let (positions, triangles) = cube();
    let text = stl_text(&positions, &triangles);
    let line = 1 + text
        .lines()
        .position(|line| line == "vertex 1.0 1.0 0.0")
        .expect("a corner of the cube");
    let found = refusal(
        "nan.stl",
        text.replacen("vertex 1.0 1.0 0.0", "vertex 1.0 NaN 0.0", 1),
    );
    assert!(
        found.starts_with(&format!(
            "line {line}: expected \"vertex\" and three finite numbers"
        )),
        "{found}"
    );
    let found = refusal(
        "inf.obj",
        box_obj([1.0; 3]).replacen("v 1 0 0", "v inf 0 0", 1),
    );
    assert_eq!(
        found,
        "line 2: expected three finite coordinates, found \"v inf 0 0\"; the file is damaged: correct the place or export it again"
    );
}

#[test]
fn an_index_out_of_range_is_refused_with_its_line() {
    let found = refusal(
        "index.obj",
        box_obj([1.0; 3]).replacen("f 5 6 8 7", "f 5 6 9 7", 1),
    );
    assert!(
        found.starts_with(
            "line 10: expected indices from 1 to 8, or from -1 to -8 here, found \"f 5 6 9 7\"; "
        ),
        "{found}"
    );
}

#[test]
fn a_flat_body_is_refused_with_its_thickness() {
    let found = refusal("flat.obj", box_obj([1.0, 1.0, 0.0]));
    assert!(
        found.starts_with("the shell of triangle 0 (12 triangles, near [0, 0, 0]) is flat: mean thickness 0.000e0, expected more than 1.414e-9"),
        "{found}"
    );
    assert!(
        found.ends_with("remove the shell or give it a thickness"),
        "{found}"
    );
}

#[test]
fn a_shell_inside_out_beside_the_body_is_refused() {
    let (positions, triangles) = cube();
    let mut all = positions.clone();
    all.extend(positions.iter().map(|p| *p * 0.5 + DVec3::splat(3.0)));
    let mut list = triangles.clone();
    list.extend(triangles.iter().map(|t| [t[0] + 8, t[2] + 8, t[1] + 8]));
    let found = refusal("inverted.stl", stl_text(&all, &list));
    assert!(
        found.starts_with("the shell of triangle 12 (12 triangles, near [3, 3, 3]) is inside out"),
        "{found}"
    );
    assert!(
        found.ends_with("turn the triangles of this shell over"),
        "{found}"
    );
}

#[test]
fn files_that_are_empty_cut_off_or_lie_about_their_size_are_refused() {
    for name in ["empty.stl", "empty.obj", "empty.ply", "empty.json"] {
        assert_eq!(
            refusal(name, ""),
            "the file is empty; export it again",
            "{name}"
        );
    }
    assert_eq!(
        refusal("empty.csv", ""),
        "expected lines x,y,z, found no point; add at least one point",
        "points are written, not exported"
    );
    let folder = Folder::new("cut");
    let (positions, triangles) = cube();
    let path = folder.0.join("cube.stl");
    write_mesh(&path, &positions, &triangles).unwrap_or_else(|error| panic!("{error}"));
    let whole = fs::read(&path).expect("just written");
    assert_eq!(
        refusal("cut.stl", &whole[..84 + 7 * 50 + 20]),
        "the header claims 12 triangles (600 bytes), but the file holds 7 (370 bytes): it is cut off or damaged; export it again"
    );
    let mut liar = whole.clone();
    liar[80..84].fill(0xff);
    assert_eq!(
        refusal("liar.stl", liar),
        "the header claims 4294967295 triangles (214748364750 bytes), but the file holds 12 (600 bytes): it is cut off or \
         damaged; export it again"
    );
    let text = stl_text(&positions, &triangles);
    let found = refusal("cut.stl", &text[..text.find("endsolid").expect("the end")]);
    assert!(
        found.contains(
            "expected \"endsolid\" at the end, found the end of the file after 12 whole triangles"
        ),
        "{found}"
    );
    let huge = "ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\nproperty float z\n\
                element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n";
    assert!(
        refusal("huge.ply", huge).starts_with("the header claims 4000000000 elements \"vertex\""),
        "a huge PLY"
    );
}

#[test]
fn names_that_lead_nowhere_are_refused() {
    let folder = Folder::new("names");
    let message = |name: &str| {
        let path = folder.0.join(name);
        let text = read_body(&path).expect_err("refused").to_string();
        text.strip_prefix(&format!("{}: ", path.display()))
            .expect("the file is named first")
            .to_owned()
    };
    assert_eq!(
        message("part.xyz"),
        "unknown extension .xyz, expected one of .stl .obj .ply; convert the file or correct its name"
    );
    assert_eq!(
        message("part"),
        "the file name has no extension, expected one of .stl .obj .ply; convert the file or correct its name"
    );
    assert_eq!(
        message("part.GLB"),
        ".glb files cannot be read yet, available are .stl .obj .ply; convert the file"
    );
    assert_eq!(message("part.stl"), "there is no such file; check the path");
    fs::create_dir(folder.0.join("folder.stl")).expect("our folder is writable");
    assert_eq!(message("folder.stl"), "is a directory, expected a file");
    let path = folder.0.join("motion.json");
    assert!(
        read_motion(&path)
            .expect_err("refused")
            .to_string()
            .ends_with("motion.json: there is no such file; check the path")
    );
}

#[test]
fn results_that_cannot_be_written_are_refused_before_the_work() {
    let folder = Folder::new("output");
    let message = |name: &str| {
        let path = folder.0.join(name);
        let text = check_output(&path).expect_err("refused").to_string();
        assert!(!path.is_file(), "{name} must not appear");
        text.strip_prefix(&format!("{}: ", path.display()))
            .expect("the file is named first")
            .to_owned()
    };
    for extension in ["svg", "dxf"] {
        let expected =
            format!(".{extension} files do not hold solids, expected one of .stl .obj .ply");
        assert_eq!(message(&format!("out.{extension}")), expected);
    }
    for extension in ["glb", "3mf", "html", "png"] {
        let expected =
            format!(".{extension} files cannot be written yet, available are .stl .obj .ply");
        assert_eq!(message(&format!("out.{extension}")), expected);
    }
    assert_eq!(
        message("out.xyz"),
        "unknown extension .xyz, expected one of .stl .obj .ply"
    );
    let missing = folder.0.join("missing");
    assert_eq!(
        message("missing/out.stl"),
        format!(
            "there is no directory {}; create it first",
            missing.display()
        )
    );
    fs::create_dir(folder.0.join("out.ply")).expect("our folder is writable");
    assert_eq!(
        message("out.ply"),
        "is a directory, expected the name of a file to write"
    );
    assert!(
        check_output(&folder.0.join("out.stl")).is_ok(),
        "a new file"
    );
    assert_eq!(folder.names(), ["out.ply"], "looking leaves no trace");
}

#[test]
#[cfg(target_os = "linux")]
fn a_directory_that_takes_no_files_is_refused() {
    // Nobody, not even the superuser, can create files in /proc.
    let text = check_output(Path::new("/proc/out.stl"))
        .expect_err("refused")
        .to_string();
    assert!(
        text.starts_with("/proc/out.stl: no file can be created in /proc: "),
        "{text}"
    );
    assert!(
        text.ends_with("; choose another place for the result"),
        "{text}"
    );
}

#[test]
fn a_failed_write_leaves_the_file_that_was_there() {
    let folder = Folder::new("failed");
    let (mut positions, triangles) = cube();
    let path = folder.write("out.stl", "old");
    positions[0].x = 1e39;
    let text = write_mesh(&path, &positions, &triangles)
        .expect_err("beyond f32")
        .to_string();
    assert!(
        text.contains("vertex 0")
            && text.contains("an earlier file of this name was left as it was"),
        "{text}"
    );
    assert_eq!(fs::read(&path).expect("still there"), b"old");
    assert_eq!(folder.names(), ["out.stl"]);
}

/// Bytes with a meaning in one of the formats.
const HOSTILE: &[u8] = b"\0\xff 0123456789.-+eE/[]{},:\n\"\\";

#[test]
fn damaged_files_never_panic() {
    let folder = Folder::new("damaged");
    let (positions, triangles) = cube();
    let mut files: Vec<(&str, Vec<u8>)> = Vec::new();
    for name in ["part.stl", "part.obj", "part.ply"] {
        let path = folder.0.join(name);
        write_mesh(&path, &positions, &triangles).unwrap_or_else(|error| panic!("{error}"));
        files.push((name, fs::read(&path).expect("just written")));
    }
    files.push(("part.stl", stl_text(&positions, &triangles).into_bytes()));
    files.push(("part.obj", box_obj([1.0; 3]).into_bytes()));
    let ply = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 4\n\
               property list uchar int vertex_index\nend_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
    files.push(("part.ply", ply.into()));
    files.push(("part.ply", ply.replace("ascii", "binary_big_endian").into()));
    let motion = "{\"keyframes\":[{\"time\":0,\"matrix\":[[1,0,0,0],[0,1,0,0],[0,0,1,0]]},{\"time\":1,\"translation\":[0,0,3],\
                  \"rotation\":[0,0,0,1],\"scale\":[1,1,1]}]}";
    files.push(("motion.json", motion.into()));
    let motion = "{\"spans\":[{\"turn_deg\":540,\"axis\":[0,0,1],\"through\":[0,0,0],\"advance\":3,\"scale\":1,\"duration\":1},\
                  {\"generator\":[[0,0,0,1],[0,0,0,0],[0,0,0,0]],\"duration\":2}]}";
    files.push(("motion.json", motion.into()));
    files.push(("points.csv", b"x,y,z\n1,2,3\n-4,5e-3,6\n".to_vec()));
    let mut random = Random::from_state(20_261_122);
    let mut accepted = 0;
    for (name, whole) in &files {
        for round in 0..3000 {
            let mut bytes = whole.clone();
            match round % 5 {
                0 => bytes.truncate(random.below(whole.len())),
                1 => {
                    let place = random.below(bytes.len());
                    bytes[place] ^= 1 << random.below(8);
                }
                2 => {
                    let place = random.below(bytes.len());
                    bytes[place] = HOSTILE[random.below(HOSTILE.len())];
                }
                3 => {
                    let (from, length) = (random.below(bytes.len()), random.below(40));
                    let piece: Vec<u8> = bytes[from..bytes.len().min(from + length)].to_vec();
                    let place = random.below(bytes.len());
                    bytes.splice(place..place, piece);
                }
                _ => {
                    let (from, length) = (random.below(bytes.len()), random.below(40));
                    bytes.drain(from..bytes.len().min(from + length));
                }
            }
            let problem = match *name {
                "motion.json" => parse_motion(&bytes).err(),
                "points.csv" => parse_points(&bytes).err(),
                "part.stl" => parse_body(MeshFormat::Stl, bytes).err(),
                "part.obj" => parse_body(MeshFormat::Obj, bytes).err(),
                _ => parse_body(MeshFormat::Ply, bytes).err(),
            };
            match problem {
                Some(problem) => assert!(!problem.to_string().is_empty(), "a message"),
                None => accepted += 1,
            }
        }
    }
    assert!(accepted > 100, "some damage does not matter: {accepted}");
}
