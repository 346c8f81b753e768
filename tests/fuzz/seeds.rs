//! Valid files from which the targets start: small ones, so that most changes hit something.

use std::fs;
use std::path::Path;

fn example(name: &str) -> Vec<u8> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    fs::read(folder.join(name)).expect("an example")
}

const CORNERS: [[f32; 3]; 4] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.5, 0.0],
    [0.0, 0.0, 2.0],
];
const FACES: [[usize; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

pub(crate) fn stl() -> Vec<Vec<u8>> {
    let mut text = "solid tetra hedron\n".to_owned();
    let mut binary = vec![b' '; 80];
    binary.extend(4_u32.to_le_bytes());
    for face in FACES {
        text += "  facet normal 0 0 0\n    outer loop\n";
        binary.extend([0; 12]);
        for corner in face {
            let [x, y, z] = CORNERS[corner];
            text += &format!("      vertex {x} {y} {z}\n");
            binary.extend([x, y, z].iter().flat_map(|x| x.to_le_bytes()));
        }
        text += "    endloop\n  endfacet\n";
        binary.extend([0; 2]);
    }
    text += "endsolid tetra hedron\n";
    vec![text.into_bytes(), binary, example("bracket.stl")]
}

pub(crate) fn obj() -> Vec<Vec<u8>> {
    let quads = "# a box\no box\nmtllib box.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1 1.0\n\
                 v 1 0 1\nv 1 1 1\nv 0 1 1\nvt 0 0\nvn 0 0 1\ng sides\ns 1\nusemtl red\n\
                 f 4 3 2 1\nf 5/1 6/1 7/1 8/1\nf 1//1 2//1 6//1 5//1\nf 2/1/1 3/1/1 7/1/1 6/1/1\n\
                 f -6 -5 -1 -2\nf 4 1 5 \\\n 8\nl 1 2\np 3\n";
    vec![
        quads.into(),
        example("plate.obj"),
        example("post.obj"),
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n".into(),
    ]
}

pub(crate) fn ply() -> Vec<Vec<u8>> {
    let header = |format: &str, number: &str, count: &str| {
        format!(
            "ply\nformat {format} 1.0\ncomment a tetrahedron\nelement vertex 4\nproperty {number} x\n\
             property {number} y\nproperty {number} z\nelement face 4\nproperty list {count} int vertex_indices\n\
             property uchar red\nelement note 1\nproperty list uchar short words\nend_header\n"
        )
    };
    let mut text = header("ascii", "float", "uchar");
    for [x, y, z] in CORNERS {
        text += &format!("{x} {y} {z}\n");
    }
    for [a, b, c] in FACES {
        text += &format!("3 {a} {b} {c} 200\n");
    }
    text += "2 5 -6\n";
    let mut little = header("binary_little_endian", "double", "uchar").into_bytes();
    let mut big = header("binary_big_endian", "float", "uint").into_bytes();
    for x in CORNERS.as_flattened() {
        little.extend(f64::from(*x).to_le_bytes());
        big.extend(x.to_be_bytes());
    }
    for face in FACES {
        little.push(3);
        big.extend(3_u32.to_be_bytes());
        for corner in face {
            let corner = i32::try_from(corner).expect("small");
            little.extend(corner.to_le_bytes());
            big.extend(corner.to_be_bytes());
        }
        little.push(9);
        big.push(9);
    }
    little.extend([1, 7, 0]);
    big.extend([1, 0, 7]);
    vec![text.into_bytes(), little, big]
}

pub(crate) fn svg() -> Vec<Vec<u8>> {
    let open = "<svg xmlns='http://www.w3.org/2000/svg' xmlns:xlink='http://www.w3.org/1999/xlink' \
                width='10cm' height='50mm' viewBox='0 0 100 50'>";
    let styled = "<style>.a { fill: none; stroke: red } #b, g > rect:first-child { fill-rule: evenodd }</style>";
    let shapes = "<rect x='1' y='1' width='8' height='6' rx='2'/><circle cx='20' cy='10' r='4'/>\
                  <ellipse cx='40' cy='10' rx='6' ry='3' transform='rotate(30 40 10)'/>\
                  <polygon points='60,5 70,5 65,12'/><polyline points='80 5 90 5 85 12 80 5'/>\
                  <text x='3' y='40'>a word</text><line x1='1' y1='2' x2='3' y2='4'/>";
    let paths = "<g transform='translate(2 20) scale(1.5,-1) skewX(10)'><path class='a' d='M0 0h10v5q-5 3 -10 0z'/>\
                 <path id='b' d='M20,0 C22,5 28,5 30,0 S38-5 40 0 T 42 8 A 3 4 20 1 0 20 8 Z m5 3l2 0 0 2-2 0z'/></g>";
    let used = "<defs><path id='p' d='M0,0L4,0 4,4z'/><symbol id='s'><rect width='3' height='2'/></symbol></defs>\
                <use xlink:href='#p' x='50' y='30'/><use href='#s' transform='matrix(1 0 .5 1 70 30)'/>";
    let whole = |inside: &str| format!("{open}{inside}</svg>").into_bytes();
    vec![
        whole(shapes),
        whole(&format!("{styled}{paths}")),
        whole(used),
        example("lever.svg"),
        example("blank.svg"),
    ]
}

/// A DXF with these entities, as pairs of a code and a value.
fn drawing(entities: &str) -> Vec<u8> {
    let head = "0 SECTION 2 HEADER 9 $INSUNITS 70 4 0 ENDSEC 0 SECTION 2 BLOCKS 0 BLOCK 2 hole 70 0 10 0 20 0 30 0 \
                0 CIRCLE 8 0 10 0 20 0 30 0 40 1 0 ENDBLK 0 ENDSEC 0 SECTION 2 ENTITIES";
    format!("{head} {entities} 0 ENDSEC 0 EOF")
        .split(' ')
        .map(|word| word.to_owned() + "\n")
        .collect::<String>()
        .into_bytes()
}

pub(crate) fn dxf() -> Vec<Vec<u8>> {
    let square = "0 LINE 8 0 10 0 20 0 11 9 21 0 0 LINE 8 0 10 9 20 0 11 9 21 9 0 LINE 8 0 10 9 20 9 11 0 21 9 \
                  0 LINE 8 0 10 0 20 9 11 0 21 0";
    let curves = "0 LWPOLYLINE 8 0 90 3 70 1 10 20 20 0 42 0.5 10 30 20 0 10 25 20 8 \
                  0 CIRCLE 8 0 10 50 20 5 40 3 0 ELLIPSE 8 0 10 70 20 5 11 4 21 1 40 0.5 41 0 42 6.283185307179586 \
                  0 ARC 8 0 10 90 20 5 40 3 50 0 51 180 0 LINE 8 0 10 87 20 5 11 93 21 5";
    let spline = "0 SPLINE 8 0 70 11 71 3 72 11 73 7 74 0 40 0 40 1 40 2 40 3 40 4 40 5 40 6 40 7 40 8 40 9 40 10 \
                  10 0 20 20 10 9 20 20 10 9 20 29 10 0 20 29 10 0 20 20 10 9 20 20 10 9 20 29";
    let inserted = "0 INSERT 8 0 2 hole 10 4 20 4 41 1.5 42 1.5 50 30 0 TEXT 8 0 10 1 20 1 40 2 1 word \
                    0 POLYLINE 8 0 66 1 70 1 0 VERTEX 8 0 10 40 20 20 0 VERTEX 8 0 10 50 20 20 42 1 \
                    0 VERTEX 8 0 10 45 20 30 0 SEQEND";
    vec![
        drawing(square),
        drawing(curves),
        drawing(spline),
        drawing(&format!("{square} {inserted}")),
    ]
}

pub(crate) fn motions() -> Vec<Vec<u8>> {
    let screw = r#"{"axis": [0, 0, 2], "through": [1, 2, 3], "turn_deg": 90, "advance": 4, "scale": 1.5, "duration": 2}"#;
    let rows = r#"{"generator": [[0, -1, 0, 3], [1, 0, 0, 4], [0, 0, 0.5, 5]]}"#;
    let matrices = r#"{"matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]},
                      {"matrix": [[0, -1, 0, 3], [1, 0, 0, 4], [0, 0, 2, 5]]}"#;
    let planar = r#"{"time": 0, "translation": [0, 0], "rotation_deg": 0, "scale": 1},
                    {"time": 1, "translation": [3, 4], "rotation_deg": 90, "scale": [2, 2]}"#;
    let spirals = r#"{"turn_deg": 30, "through": [1, 2], "scale": 0.5}, {"generator": [[0, 1, 2], [-1, 0, 3]]}"#;
    let file = |list: &str, items: &str| format!("{{\"{list}\": [\n{items}\n]}}\n").into_bytes();
    vec![
        example("path.json"),
        file("spans", &format!("{screw},\n{rows}")),
        file("keyframes", matrices),
        file("keyframes", planar),
        file("spans", spirals),
    ]
}

pub(crate) fn pose_logs() -> Vec<Vec<u8>> {
    vec![
        example("recorded.txt"),
        "t,x,y,z,qx,qy,qz,qw\r\n0,0,0.5,1e-3,0,0,0,1\r\n\r\n1, -1 , 2,3,0,0,0.6,0.8\r\n".into(),
        "t x y deg\n0 0 0 0\n1 3 4 90\n".into(),
        "m11 m12 m13 m14 m21 m22 m23 m24 m31 m32 m33 m34\n1 0 0 0 0 1 0 0 0 0 1 0\n".into(),
    ]
}

pub(crate) fn points() -> Vec<Vec<u8>> {
    vec![
        example("points.csv"),
        "x,y,z\r\n0,0.5,1e-3\r\n\r\n -1 , 2,3\r\n".into(),
        "# place\n1,2,3\n".into(),
        "\"x\",\"y\"\n1,2\n3,4\n".into(),
    ]
}
