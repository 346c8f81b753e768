//! Scenes with a published first contact, in files beside the repository, and more scenes of the
//! same families.

use super::super::random::Random;
use super::families::{beside_the_path, rigid};
use super::scene::{self, Known, Scene, moved, steady};
use crate::support::shapes::{self, Shape};
use glam::{DMat3, DVec3};
use serde::Deserialize;
use std::f64::consts::PI;
use std::path::Path;
use steadysweep::motion::{Generator, Motion, Span};

/// One entry of a file: moving mesh, resting mesh, motion, result.
#[derive(Deserialize)]
struct Entry {
    id: u64,
    family: String,
    #[serde(rename = "V")]
    moving: Vec<[f64; 3]>,
    #[serde(rename = "F")]
    moving_faces: Vec<[u32; 3]>,
    #[serde(rename = "W")]
    resting: Vec<[f64; 3]>,
    #[serde(rename = "G")]
    resting_faces: Vec<[u32; 3]>,
    #[serde(flatten)]
    motion: Way,
    ref_toi: Option<f64>,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Way {
    /// p(t) = c + R(u, theta t)(p - c) + d t u.
    Screw {
        c: [f64; 3],
        u: [f64; 3],
        theta: f64,
        d: f64,
    },
    /// p(t) = q + exp(t M)(p - q) + t v, with M v = 0.
    Affine {
        #[serde(rename = "M")]
        rows: [[f64; 3]; 3],
        q: [f64; 3],
        v: [f64; 3],
    },
}

impl Way {
    fn generator(&self) -> Generator {
        match self {
            Way::Screw { c, u, theta, d } => {
                Generator::screw(DVec3::from(*u), DVec3::from(*c), *theta, *d, 1.0)
            }
            Way::Affine { rows, q, v } => {
                let linear = DMat3::from_cols_array_2d(rows).transpose();
                Generator {
                    linear,
                    offset: DVec3::from(*v) - linear * DVec3::from(*q),
                }
            }
        }
    }
}

/// The scenes of a file, with time from 0 to 1.
pub(crate) fn scenes(path: &Path) -> Vec<Scene> {
    let text = std::fs::read_to_string(path).expect("the file can be read");
    let entries: Vec<Entry> = serde_json::from_str(&text).expect("the file is as described");
    let shape = |positions: Vec<[f64; 3]>, faces: Vec<[u32; 3]>| -> Shape {
        (positions.into_iter().map(DVec3::from).collect(), faces)
    };
    let scene = |entry: Entry| {
        let span = Span::new(entry.motion.generator(), 1.0).expect("finite");
        let motion = Motion::from_spans(vec![span]).expect("a motion");
        let body = shape(entry.moving, entry.moving_faces);
        let obstacle = shape(entry.resting, entry.resting_faces);
        // There, a distance of up to 1e-8 counts as contact: early by up to 1e-5.
        let known = entry
            .ref_toi
            .map_or(Known::Clear, |time| Known::Contact { time, early: 1e-5 });
        Scene {
            family: entry.family.leak(),
            seed: entry.id,
            ..Scene::new(body, motion, obstacle).known(known)
        }
    };
    entries.into_iter().map(scene).collect()
}

/// Bodies as in the files: up to 120 triangles.
fn mesh(random: &mut Random) -> Shape {
    let shape = match random.below(8) {
        0 => scene::tetrahedron(),
        1 => scene::brick(DVec3::new(1.0, 0.7, 0.5)),
        2 => scene::brick(DVec3::new(2.0, 0.3, 0.02)),
        3 => shapes::icosphere(1, 0.7, DVec3::ZERO),
        4 => scene::star(random, 1),
        5 => shapes::torus(0.7, 0.25, 10, 6),
        6 => shapes::mapped(shapes::l_prism(0.3, 0.4), |p| p - DVec3::new(0.4, 0.4, 0.2)),
        _ => scene::comb(5),
    };
    let size = random.between(0.4, 1.0);
    shapes::mapped(scene::turned(random, shape), |p| p * size)
}

fn thin(random: &mut Random) -> Shape {
    let shape = match random.below(3) {
        0 => scene::sheet(2.0, 2.0),
        1 => scene::brick(DVec3::new(2.0, 2.0, 0.01)),
        _ => scene::comb(5),
    };
    scene::turned(random, shape)
}

/// Another scene of one of the families of the files.
pub(crate) fn alike(seed: u64) -> Scene {
    let mut random = Random::new(seed ^ 0x00c0_ffee);
    let random = &mut random;
    let degrees = |random: &mut Random, low: f64, high: f64| random.between(low, high) * PI / 180.0;
    let placed = |random: &mut Random, generator: Generator, obstacle: Shape| {
        let body = mesh(random);
        beside_the_path(random, body, steady(generator), &obstacle, 1.5)
    };
    let (family, scene) = match seed % 10 {
        0 => {
            let turn = degrees(random, 10.0, 90.0);
            let (generator, obstacle) = (rigid(random, turn), mesh(random));
            ("slow", placed(random, generator, obstacle))
        }
        1 => {
            let turn = degrees(random, 180.0, 1080.0);
            let (generator, obstacle) = (rigid(random, turn), mesh(random));
            ("fast", placed(random, generator, obstacle))
        }
        2 => {
            let turn = degrees(random, 45.0, 200.0);
            let (generator, obstacle) = (rigid(random, turn), thin(random));
            ("thin", placed(random, generator, obstacle))
        }
        3 => {
            let size = random.between(0.01, 0.03);
            let body = shapes::mapped(mesh(random), |p| p * size);
            let turn = degrees(random, 90.0, 360.0);
            let mut generator = rigid(random, turn);
            generator.offset *= 2.0;
            let obstacle = thin(random);
            let motion = steady(generator);
            (
                "bullet",
                beside_the_path(random, body, motion, &obstacle, 30.0),
            )
        }
        4 => {
            let generator = Generator::screw(
                random.direction(),
                random.point(1.0),
                degrees(random, -400.0, 400.0),
                random.between(-1.0, 1.0),
                random.between(0.3, 2.0),
            );
            let obstacle = mesh(random);
            ("spiral", placed(random, generator, obstacle))
        }
        5 => {
            // A turn in a skewed frame: points move on elliptic spirals.
            let basis = DMat3::IDENTITY + random.matrix(0.4);
            let turn = Generator::screw(
                DVec3::Z,
                DVec3::ZERO,
                degrees(random, 60.0, 500.0),
                random.between(-1.0, 1.0),
                random.between(0.4, 1.5),
            );
            let linear = basis * turn.linear * basis.inverse();
            let offset = linear * -random.point(1.0) + random.point(0.3);
            let obstacle = mesh(random);
            (
                "ellspiral",
                placed(random, Generator { linear, offset }, obstacle),
            )
        }
        6 => {
            let turn = DMat3::from_quat(random.rotation());
            let linear = turn * DMat3::from_diagonal(random.point(1.5)) * turn.transpose();
            let offset = linear * -random.point(2.0);
            let obstacle = mesh(random);
            (
                "scale3",
                placed(random, Generator { linear, offset }, obstacle),
            )
        }
        7 => {
            let along = random.direction();
            let across = along.any_orthonormal_vector() * random.between(0.5, 2.0);
            let linear = DMat3::from_cols(along * across.x, along * across.y, along * across.z);
            let offset = random.point(1.5);
            let obstacle = mesh(random);
            (
                "shear",
                placed(random, Generator { linear, offset }, obstacle),
            )
        }
        8 => ("graze", super::exact::grazing(random)),
        _ => {
            // The body stands on a sheet, or a hair above it, and turns about some axis.
            let body = mesh(random);
            let lowest = body.0.iter().map(|p| p.z).fold(f64::INFINITY, f64::min);
            let gap = random.one_of(&[0.0, 1e-9, 1e-6, 1e-4]);
            let turn = degrees(random, 10.0, 60.0);
            let motion = steady(rigid(random, turn));
            let body = moved(body, DVec3::Z * (gap - lowest));
            ("touch", Scene::new(body, motion, scene::sheet(4.0, 4.0)))
        }
    };
    Scene {
        family,
        seed,
        ..scene
    }
}
