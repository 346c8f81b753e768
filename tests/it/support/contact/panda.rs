//! A robot arm from published data: its links for any angles of the joints, and the shelf in front
//! of it.

use super::scene::{brick, moved};
use crate::support::shapes::{self, Shape};
use glam::{DAffine3, DQuat, DVec2, DVec3};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::path::Path;
use steadysweep::io::read_body;
use steadysweep::motion::Generator;

pub(crate) const JOINTS: usize = 7;

pub(crate) struct Link {
    pub(crate) name: String,
    /// The shape in its own frame.
    pub(crate) shape: Shape,
    /// Number of joints between it and the base.
    pub(crate) joints: usize,
    /// Its pose relative to its last joint.
    from_joint: DAffine3,
}

pub(crate) struct Arm {
    pub(crate) links: Vec<Link>,
    /// Poses of the joints relative to the joint before, at zero.
    origins: Vec<DAffine3>,
}

/// A shelf, a start, a goal, and the result of a published program for the straight path between
/// them.
pub(crate) struct Problem {
    pub(crate) boxes: BTreeMap<String, Shape>,
    pub(crate) start: Vec<f64>,
    pub(crate) goal: Vec<f64>,
    /// Link, obstacle, time from 0 to 1.
    pub(crate) contacts: Vec<(String, String, f64)>,
}

/// The numbers of an attribute in the first line after `from` that has it.
fn attribute(text: &str, name: &str) -> DVec3 {
    let from = text.find(&format!("{name}=\"")).expect("an attribute") + name.len() + 2;
    let value = text[from..].split('"').next().expect("quoted");
    let numbers: Vec<f64> = value
        .split_whitespace()
        .map(|word| word.parse().expect("a number"))
        .collect();
    DVec3::from_slice(&numbers)
}

fn origin(joint: &str) -> DAffine3 {
    let turn = attribute(joint, "rpy");
    let rotation = DQuat::from_rotation_z(turn.z)
        * DQuat::from_rotation_y(turn.y)
        * DQuat::from_rotation_x(turn.x);
    DAffine3::from_rotation_translation(rotation, attribute(joint, "xyz"))
}

impl Arm {
    pub(crate) fn read(folder: &Path) -> Arm {
        let text = std::fs::read_to_string(folder.join("panda.urdf")).expect("the arm");
        let joint = |name: &str| {
            let from = text.find(&format!("name=\"{name}\"")).expect("a joint");
            let end = text[from..].find("</joint>").expect("its end");
            origin(&text[from..from + end])
        };
        let origins = (1..=JOINTS)
            .map(|k| joint(&format!("panda_joint{k}")))
            .collect();
        let shape = |name: &str| -> Shape {
            let (mesh, _) = read_body(&folder.join(format!("meshes/{name}.stl"))).expect("a link");
            (mesh.positions().to_vec(), mesh.triangles().to_vec())
        };
        let mut links: Vec<Link> = (0..=JOINTS)
            .map(|k| Link {
                name: format!("panda_link{k}"),
                shape: shape(&format!("link{k}")),
                joints: k,
                from_joint: DAffine3::IDENTITY,
            })
            .collect();
        let hand = joint("panda_joint8") * joint("panda_hand_joint");
        let fingers = hand * joint("panda_finger_joint1");
        let open = |side: f64| {
            let half_turn = if side < 0.0 { TAU / 2.0 } else { 0.0 };
            DAffine3::from_translation(DVec3::Y * 0.04 * side)
                * DAffine3::from_rotation_z(half_turn)
        };
        for (name, file, pose) in [
            ("panda_hand", "hand", hand),
            ("panda_leftfinger", "finger", fingers * open(1.0)),
            ("panda_rightfinger", "finger", fingers * open(-1.0)),
        ] {
            links.push(Link {
                name: name.into(),
                shape: shape(file),
                joints: JOINTS,
                from_joint: pose,
            });
        }
        Arm { links, origins }
    }

    /// The frame of a joint, after its own turn.
    fn frame(&self, joints: usize, angles: &[f64]) -> DAffine3 {
        (0..joints).fold(DAffine3::IDENTITY, |frame, k| {
            frame * self.origins[k] * DAffine3::from_rotation_z(angles[k])
        })
    }

    pub(crate) fn pose(&self, link: &Link, angles: &[f64]) -> DAffine3 {
        self.frame(link.joints, angles) * link.from_joint
    }

    /// The motion in the world of all links behind joint number `joint`, from 0, when it alone
    /// turns by `turn`.
    pub(crate) fn turn(&self, joint: usize, angles: &[f64], turn: f64) -> Generator {
        let frame = self.frame(joint + 1, angles);
        let axis = frame.transform_vector3(DVec3::Z).normalize();
        Generator::screw(axis, frame.translation, turn, 0.0, 1.0)
    }
}

#[derive(Deserialize)]
struct Published {
    problems: Vec<PublishedProblem>,
}
#[derive(Deserialize)]
struct PublishedProblem {
    q_start: Vec<f64>,
    q_goal: Vec<f64>,
    first_contacts: Vec<PublishedContact>,
}
#[derive(Deserialize)]
struct PublishedContact {
    link: String,
    obstacle: String,
    first_contact_t: f64,
}

pub(crate) fn problems(folder: &Path) -> Vec<Problem> {
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).expect("the problems");
    let published: Published =
        serde_json::from_str(&read("bookshelf_trajectories_with_fcl_reference.json"))
            .expect("as described");
    let shelves = read("robometrics_demo_set.yaml");
    // The first piece is the title.
    let shelves = shelves.split("\n- collision_buffer_ik").skip(1).map(boxes);
    let problem = |(published, boxes): (PublishedProblem, _)| Problem {
        boxes,
        start: published.q_start,
        goal: published.q_goal,
        contacts: published
            .first_contacts
            .into_iter()
            .map(|contact| (contact.link, contact.obstacle, contact.first_contact_t))
            .collect(),
    };
    published
        .problems
        .into_iter()
        .zip(shelves)
        .map(problem)
        .collect()
}

/// The obstacles of one problem: a name that ends in a colon, then lists of numbers by key.
fn boxes(text: &str) -> BTreeMap<String, Shape> {
    let mut found: BTreeMap<String, BTreeMap<String, Vec<f64>>> = BTreeMap::new();
    let (mut name, mut key) = (String::new(), String::new());
    for line in text.lines().map(str::trim) {
        if let Some((word, value)) = line.split_once(':') {
            if word.starts_with("cube") || (word.starts_with("cylinder") && word != "cylinder") {
                name = word.into();
            }
            key = word.into();
            if let (false, Ok(number)) = (name.is_empty(), value.trim().parse()) {
                found
                    .entry(name.clone())
                    .or_default()
                    .insert(key.clone(), vec![number]);
            }
            if word == "start" {
                name.clear();
            }
        } else if let (false, Some(Ok(number))) =
            (name.is_empty(), line.strip_prefix("- ").map(str::parse))
        {
            let lists = found.entry(name.clone()).or_default();
            lists.entry(key.clone()).or_default().push(number);
        }
    }
    let shape = |lists: &BTreeMap<String, Vec<f64>>| {
        let numbers = &lists["pose"];
        let rotation = DQuat::from_xyzw(numbers[4], numbers[5], numbers[6], numbers[3]);
        let pose = DAffine3::from_rotation_translation(
            rotation.normalize(),
            DVec3::from_slice(&numbers[..3]),
        );
        let shape = match lists.get("dims") {
            Some(sizes) => brick(DVec3::from_slice(sizes)),
            None => {
                let (radius, height) = (lists["radius"][0], lists["height"][0]);
                let outline: Vec<DVec2> = (0..128)
                    .map(|k| DVec2::from_angle(TAU * f64::from(k) / 128.0) * radius)
                    .collect();
                moved(shapes::prism(&outline, height), DVec3::Z * (-height / 2.0))
            }
        };
        shapes::mapped(shape, |p| pose.transform_point3(p))
    };
    found
        .iter()
        .map(|(name, lists)| (name.clone(), shape(lists)))
        .collect()
}
