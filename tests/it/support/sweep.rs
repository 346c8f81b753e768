//! Bodies and motions whose sweeps are known, and what is checked about every sweep.

use super::random::pseudo_random;
use super::shapes::{self, Shape};
use glam::{DAffine3, DMat3, DVec3};
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};
use steadysweep::body::Mesh;
use steadysweep::bounds::{Location, SurfaceTree};
use steadysweep::membership::Membership;
use steadysweep::motion::{Generator, Keyframe, Motion, Span};
use steadysweep::{Precision, Simplify, Sweep, SweepSettings};

/// A body, its motion and what is known about the solid.
pub(crate) struct Case {
    pub(crate) name: &'static str,
    pub(crate) shape: Shape,
    pub(crate) motion: Motion,
    /// Components, voids, genus.
    pub(crate) topology: [usize; 3],
}

impl Case {
    fn new(name: &'static str, shape: Shape, motion: Motion, topology: [usize; 3]) -> Case {
        Case {
            name,
            shape,
            motion,
            topology,
        }
    }

    pub(crate) fn mesh(&self) -> Mesh {
        mesh(&self.shape)
    }

    /// The sweep at a tolerance relative to the diagonal of the body at the start.
    pub(crate) fn sweep(&self, relative_tolerance: f64) -> Sweep {
        self.sweep_with(SweepSettings::default(), relative_tolerance)
    }

    /// [`Case::sweep`] with settings, apart from their tolerance.
    pub(crate) fn sweep_with(&self, settings: SweepSettings, relative_tolerance: f64) -> Sweep {
        let mesh = self.mesh();
        let diagonal = mesh.transformed(self.motion.start_pose()).diagonal();
        let settings = settings.with_tolerance(relative_tolerance * diagonal);
        steadysweep::sweep(&mesh, &self.motion, &settings).expect("a legal sweep succeeds")
    }

    /// The same with all triangles of the sampling: edges that collapse may move a surface by as much
    /// as the sampling did, at one tolerance more of that than at another.
    pub(crate) fn sampled(&self, relative_tolerance: f64) -> Sweep {
        let mesh = self.mesh();
        let diagonal = mesh.transformed(self.motion.start_pose()).diagonal();
        let settings = SweepSettings::default()
            .with_tolerance(relative_tolerance * diagonal)
            .with_simplify(Simplify::Off);
        steadysweep::sweep(&mesh, &self.motion, &settings).expect("a legal sweep succeeds")
    }

    /// The defects of the structure of a solid; empty when there are none.
    pub(crate) fn topology_defects(&self, sweep: &Sweep) -> String {
        let m = sweep.solid.measures();
        let mut defects = String::new();
        if [m.components, m.voids, m.genus] != self.topology {
            defects += &format!(
                "components, voids, genus {:?} instead of {:?}; ",
                [m.components, m.voids, m.genus],
                self.topology
            );
        }
        if !m.watertight {
            defects += "not watertight; ";
        }
        if !m.manifold {
            defects += &format!("not manifold, {} touching edges; ", m.touching_edges);
        }
        defects
    }

    pub(crate) fn agreement(&self, sweep: &Sweep, count: usize) -> Agreement {
        agreement(&self.mesh(), &self.motion, sweep, count)
    }
}

/// The sweep of `mesh` at `tolerance`, a length, which must succeed.
pub(crate) fn swept(mesh: &Mesh, motion: &Motion, tolerance: f64) -> Sweep {
    let settings = SweepSettings::default()
        .with_tolerance(tolerance)
        .with_precision(Precision::Double);
    steadysweep::sweep(mesh, motion, &settings).expect("a legal sweep succeeds")
}

pub(crate) fn mesh(shape: &Shape) -> Mesh {
    Mesh::new(shape.0.clone(), shape.1.clone()).expect("the shapes are bodies")
}

/// A chain of spans of duration 1.
pub(crate) fn motion(generators: &[Generator]) -> Motion {
    let spans = generators
        .iter()
        .map(|&generator| Span::new(generator, 1.0).expect("finite"))
        .collect();
    Motion::from_spans(spans).expect("a legal motion")
}

pub(crate) fn screw(axis: DVec3, through: DVec3, turn: f64, advance: f64, scale: f64) -> Generator {
    Generator::screw(axis.normalize(), through, turn, advance, scale)
}

pub(crate) fn translation(x: f64, y: f64, z: f64) -> Generator {
    Generator::translation(DVec3::new(x, y, z))
}

/// Rotation, strain and shear of comparable size.
pub(crate) fn general_affine() -> Generator {
    let linear = DMat3::from_cols(
        DVec3::new(0.3, 1.2, -0.4),
        DVec3::new(-0.9, -0.3, 0.5),
        DVec3::new(0.2, -0.6, 0.1),
    );
    Generator {
        linear,
        offset: DVec3::new(1.0, -0.7, 0.5),
    }
}

/// Four poses of a body, not equally spaced in time.
pub(crate) fn four_keyframes() -> Motion {
    let pose = |turn: f64, axis: DVec3, scale: f64, at: DVec3| {
        DAffine3::from_scale_rotation_translation(
            DVec3::splat(scale),
            glam::DQuat::from_axis_angle(axis.normalize(), turn),
            at,
        )
    };
    let keys = [
        (0.0, pose(0.0, DVec3::Z, 1.0, DVec3::ZERO)),
        (
            0.5,
            pose(
                0.7,
                DVec3::new(0.0, 0.2, 1.0),
                1.0,
                DVec3::new(1.0, 0.2, 0.1),
            ),
        ),
        (
            2.0,
            pose(
                1.2,
                DVec3::new(0.3, 0.0, 1.0),
                0.8,
                DVec3::new(1.9, 1.1, 0.4),
            ),
        ),
        (
            3.0,
            pose(
                1.9,
                DVec3::new(0.3, -0.3, 1.0),
                0.9,
                DVec3::new(1.7, 2.3, 1.0),
            ),
        ),
    ];
    let keys = keys.map(|(time, pose)| Keyframe { time, pose });
    Motion::from_keyframes(&keys).expect("a legal chain")
}

fn cube() -> Shape {
    shapes::cuboid(DVec3::splat(-0.5), DVec3::splat(0.5))
}

fn moved(shape: Shape, x: f64, y: f64, z: f64) -> Shape {
    shapes::mapped(shape, |p| p + DVec3::new(x, y, z))
}

fn ball(subdivisions: u32, radius: f64, x: f64) -> Shape {
    shapes::icosphere(subdivisions, radius, DVec3::X * x)
}

fn hollow_torus() -> Shape {
    let inner = shapes::reversed(shapes::torus(1.0, 0.2, 40, 16));
    shapes::united(&[shapes::torus(1.0, 0.4, 48, 20), inner])
}

/// Sweeps whose topology is known.
pub(crate) fn corpus() -> Vec<Case> {
    let (o, x, z) = (DVec3::ZERO, DVec3::X, DVec3::Z);
    let one = |generator: Generator| motion(&[generator]);
    let turn = |angle: f64| one(screw(z, o, angle, 0.0, 1.0));
    let tilted = |shape: Shape, angle: f64| {
        let rotation = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, 0.5).normalize(), angle);
        shapes::mapped(shape, |p| rotation * p)
    };
    let hole = || shapes::box_with_hole(DVec3::ONE, 0.2);
    let slit = || shapes::box_with_hole(DVec3::new(1.0, 1.0, 2.0), 0.1);
    let hollow = || shapes::hollow_box(DVec3::ONE, DVec3::splat(0.5));
    vec![
        Case::new(
            "cube_skew_translation",
            cube(),
            one(translation(1.5, 0.6, 0.3)),
            [1, 0, 0],
        ),
        Case::new(
            "cube_along_its_edge",
            cube(),
            one(translation(0.7, 0.0, 0.0)),
            [1, 0, 0],
        ),
        Case::new(
            "cube_at_rest",
            cube(),
            one(translation(0.0, 0.0, 0.0)),
            [1, 0, 0],
        ),
        Case::new("cube_quarter_turn", cube(), turn(PI / 2.0), [1, 0, 0]),
        Case::new("cube_full_turn", cube(), turn(TAU), [1, 0, 0]),
        Case::new("cube_two_turns", cube(), turn(2.0 * TAU), [1, 0, 0]),
        Case::new("cube_five_radians", cube(), turn(5.0), [1, 0, 0]),
        Case::new(
            "tilted_cube_full_turn",
            tilted(cube(), 0.8),
            turn(TAU),
            [1, 0, 0],
        ),
        Case::new(
            "cube_off_axis_full_turn",
            moved(cube(), 1.5, 0.0, 0.0),
            turn(TAU),
            [1, 0, 1],
        ),
        Case::new(
            "cube_on_its_edges",
            shapes::reversed(shapes::mapped(cube(), |p| DVec3::new(p.y, p.x, p.z))),
            one(screw(DVec3::new(1.0, 1.0, 0.0), o, PI / 3.0, 0.0, 1.0)),
            [1, 0, 0],
        ),
        Case::new(
            "cube_on_its_corners",
            cube(),
            one(screw(DVec3::ONE, o, 3.5, 0.0, 1.0)),
            [1, 0, 0],
        ),
        Case::new(
            "l_on_its_corner",
            shapes::l_prism(0.3, 0.5),
            one(screw(DVec3::new(1.0, 1.0, 0.0), o, 3.5, 0.0, 1.0)),
            [1, 0, 0],
        ),
        Case::new(
            "l_on_a_tilted_axis",
            shapes::l_prism(0.3, 0.5),
            one(screw(DVec3::new(0.2, -0.1, 1.0), o, 1.5, 0.0, 1.0)),
            [1, 0, 0],
        ),
        Case::new(
            "cone_on_an_axis_through_its_base",
            shapes::cone(0.5, 1.0, 24),
            one(screw(DVec3::new(0.2, -0.1, 1.0), o, PI / 3.0, 0.0, 1.0)),
            [1, 0, 0],
        ),
        Case::new(
            "bumpy_on_the_spot",
            shapes::bumpy_sphere(1000),
            one(screw(x, o, PI / 3.0, 0.0, 1.0)),
            [1, 0, 0],
        ),
        Case::new(
            "cube_square_path",
            shapes::cuboid(DVec3::ZERO, DVec3::ONE),
            motion(&[
                translation(2.0, 0.0, 0.0),
                translation(0.0, 2.0, 0.0),
                translation(-2.0, 0.0, 0.0),
                translation(0.0, -2.0, 0.0),
            ]),
            [1, 0, 1],
        ),
        Case::new(
            "cube_there_and_back",
            moved(cube(), 1.5, 0.0, 0.0),
            motion(&[screw(z, o, 1.5, 0.4, 1.0), screw(z, o, -1.5, -0.4, 1.0)]),
            [1, 0, 0],
        ),
        Case::new(
            "cube_rest_in_the_middle",
            moved(cube(), 1.5, 0.0, 0.0),
            motion(&[
                screw(z, o, 1.0, 0.2, 1.0),
                translation(0.0, 0.0, 0.0),
                screw(z, o, 1.0, 0.2, 1.0),
            ]),
            [1, 0, 0],
        ),
        Case::new(
            "ball_helix",
            ball(3, 0.3, 1.0),
            one(screw(z, o, 3.0 * PI, 3.0, 1.0)),
            [1, 0, 0],
        ),
        Case::new(
            "ball_log_spiral",
            ball(3, 0.3, 1.0),
            one(screw(z, o, 3.0, 0.0, 0.6)),
            [1, 0, 0],
        ),
        Case::new("ball_full_turn", ball(3, 0.3, 1.0), turn(TAU), [1, 0, 1]),
        Case::new(
            "ball_two_turns",
            ball(2, 0.3, 1.0),
            turn(2.0 * TAU),
            [1, 0, 1],
        ),
        Case::new(
            "ball_through_itself",
            ball(3, 0.3, 0.1),
            one(screw(z, o, 5.0, 0.2, 1.0)),
            [1, 0, 0],
        ),
        Case::new("ball_own_axis", ball(3, 0.3, 0.0), turn(5.0), [1, 0, 0]),
        Case::new(
            "ball_own_axis_advancing",
            ball(3, 0.3, 0.0),
            one(screw(z, o, 5.0, 0.2, 1.0)),
            [1, 0, 0],
        ),
        Case::new(
            "ball_growing",
            ball(3, 0.3, 1.0),
            one(screw(z, o, 0.0, 0.0, 1.7)),
            [1, 0, 0],
        ),
        Case::new(
            "cone_on_its_axis",
            shapes::cone(0.5, 1.0, 24),
            turn(5.0),
            [1, 0, 0],
        ),
        Case::new(
            "cone_on_a_tilted_axis",
            tilted(shapes::cone(0.5, 1.0, 24), 0.3),
            turn(2.0),
            [1, 0, 0],
        ),
        Case::new(
            "cone_spiral",
            moved(shapes::cone(0.5, 1.0, 24), 1.0, 0.0, 0.0),
            one(screw(z, o, 2.0, 0.5, 0.6)),
            [1, 0, 0],
        ),
        Case::new(
            "hole_kept",
            hole(),
            one(translation(0.2, 0.1, 0.7)),
            [1, 0, 1],
        ),
        Case::new(
            "hole_swept_shut",
            hole(),
            one(translation(0.5, 0.1, 0.0)),
            [1, 0, 0],
        ),
        Case::new(
            "hole_swept_shut_by_a_screw",
            moved(hole(), 0.8, 0.0, 0.0),
            one(screw(z, o, 1.0, 0.3, 1.0)),
            [1, 0, 0],
        ),
        Case::new(
            "hole_becomes_a_void",
            slit(),
            one(screw(x, o, 0.5, 0.0, 1.0)),
            [1, 1, 0],
        ),
        Case::new(
            "cavity_kept",
            hollow(),
            one(translation(0.2, 0.1, 0.15)),
            [1, 1, 0],
        ),
        Case::new(
            "cavity_swept_shut",
            hollow(),
            one(translation(0.2, 0.1, 0.6)),
            [1, 0, 0],
        ),
        Case::new(
            "cavity_kept_by_a_turn",
            tilted(hollow(), 0.5),
            turn(2.0),
            [1, 1, 0],
        ),
        Case::new(
            "cup_closes_round_a_cavity",
            shapes::cup(0.2),
            turn(PI),
            [1, 1, 0],
        ),
        Case::new(
            "ring_closes",
            shapes::c_prism(0.4, 0.8, 0.6, 24, 0.5),
            turn(1.0),
            [1, 0, 1],
        ),
        Case::new("hollow_torus", hollow_torus(), turn(2.0), [1, 1, 2]),
        Case::new(
            "hollow_torus_screw",
            hollow_torus(),
            one(screw(z, o, 2.0, 0.15, 1.0)),
            [1, 1, 2],
        ),
        Case::new(
            "torus_translated",
            shapes::torus(1.0, 0.3, 24, 12),
            one(translation(0.4, 0.3, 1.0)),
            [1, 0, 1],
        ),
        Case::new(
            "torus_affine",
            shapes::torus(1.0, 0.3, 24, 12),
            one(general_affine().scaled(0.3)),
            [1, 0, 1],
        ),
        Case::new(
            "bumpy_screw",
            moved(shapes::bumpy_sphere(1000), 2.0, 0.0, 0.0),
            one(screw(z, o, PI, 1.0, 1.0)),
            [1, 0, 0],
        ),
        Case::new(
            "bumpy_spiral",
            moved(shapes::bumpy_sphere(1000), 2.0, 0.0, 0.0),
            one(screw(z, o, 2.0, 0.0, 0.6)),
            [1, 0, 0],
        ),
        Case::new(
            "bumpy_affine",
            shapes::bumpy_sphere(1000),
            one(general_affine()),
            [1, 0, 0],
        ),
        Case::new(
            "u_in_its_plane",
            tilted(shapes::u_prism(0.25, 0.5), 0.4),
            one(screw(
                DMat3::from_axis_angle(DVec3::new(1.0, 2.0, 0.5).normalize(), 0.4) * z,
                o,
                1.5,
                0.0,
                1.0,
            )),
            [1, 0, 0],
        ),
        Case::new(
            "u_tilted_screw",
            shapes::u_prism(0.25, 0.5),
            one(screw(
                DVec3::new(0.3, 0.1, 1.0),
                DVec3::new(2.0, 0.3, 0.0),
                1.5,
                0.8,
                1.0,
            )),
            [1, 0, 0],
        ),
        Case::new(
            "l_shear",
            shapes::l_prism(0.3, 0.5),
            one(general_affine()),
            [1, 0, 0],
        ),
        Case::new("box_keyframes", cube(), four_keyframes(), [1, 0, 0]),
        Case::new(
            "ball_keyframes",
            ball(3, 0.5, 0.0),
            four_keyframes(),
            [1, 0, 0],
        ),
        Case::new(
            "l_keyframes",
            shapes::l_prism(0.3, 0.5),
            four_keyframes(),
            [1, 0, 0],
        ),
    ]
}

/// The case of that name.
pub(crate) fn case(name: &str) -> Case {
    let mut corpus = corpus().into_iter();
    corpus
        .find(|case| case.name == name)
        .unwrap_or_else(|| panic!("no case {name}"))
}

/// Share of the largest coordinate up to which membership may count a point outside as touching:
/// its slack is 16 u of it for a generator of norm 1, and the motions here have norms up to 13.
const MEMBERSHIP_SLACK: f64 = 1e-13;

/// How well `Membership` and a solid agree.
#[derive(Debug, Default, Clone, Copy)]
pub(crate) struct Agreement {
    /// Number of points on which they differ.
    pub(crate) differing: usize,
    /// The largest distance of a point of the exact sweep outside the solid, and the point.
    pub(crate) shortfall: (f64, DVec3),
    /// The same for a point of the solid outside the exact sweep: distance to the solid's boundary
    /// or, where that is more than the bound, to the nearest point found in the sweep.
    pub(crate) excess: (f64, DVec3),
    /// Bound on the error of the comparison itself.
    slack: f64,
}

impl Agreement {
    /// What exceeds the bounds that the sweep states; empty when nothing does.
    pub(crate) fn defects(&self, sweep: &Sweep) -> String {
        let bound = sweep.error_bound;
        let mut defects = String::new();
        for (what, (found, at), stated) in [
            ("short", self.shortfall, bound.inside),
            ("over", self.excess, bound.outside),
        ] {
            if found > stated.length + self.slack {
                defects += &format!("{what} by {found:e} at {at}, stated {:e}; ", stated.length);
            }
        }
        defects
    }
}

/// Compares on `count` points: half of them anywhere in the box of the solid, half near its
/// surface.
pub(crate) fn agreement(mesh: &Mesh, motion: &Motion, sweep: &Sweep, count: usize) -> Agreement {
    let (membership, solid) = (Membership::new(mesh, motion), &sweep.solid);
    let tree = SurfaceTree::new(solid.positions(), solid.triangles());
    agreement_at(&membership, &tree, sweep, test_points(sweep, count))
}

/// Compares on given points. `tree`: of the solid, which may have been read from a file.
pub(crate) fn agreement_at(
    membership: &Membership,
    tree: &SurfaceTree,
    sweep: &Sweep,
    points: Vec<DVec3>,
) -> Agreement {
    let bound = sweep.error_bound;
    let [min, max] = sweep.solid.measures().bounds;
    let slack = MEMBERSHIP_SLACK * min.abs().max(max.abs()).max_element();
    let reach = bound.inside.length.max(bound.outside.length) + slack;
    let compared: Vec<Agreement> = points
        .into_par_iter()
        .map(|point| {
            let mut found = Agreement::default();
            let location = tree.locate(point);
            let is_swept = membership.is_ever_inside(point);
            if location == Location::On || (location == Location::Inside) == is_swept {
                return found;
            }
            found.differing = 1;
            let distance = tree.distance_to_surface(point);
            if is_swept {
                found.shortfall = (distance, point);
            } else if distance <= bound.outside.length + slack {
                found.excess = (distance, point);
            } else {
                found.excess = (distance_to_sweep(membership, point, 2.0 * reach), point);
            }
            found
        })
        .collect();
    let farther = |a: (f64, DVec3), b: (f64, DVec3)| if b.0 > a.0 { b } else { a };
    compared
        .into_iter()
        .fold(Agreement::default(), |a, b| Agreement {
            differing: a.differing + b.differing,
            shortfall: farther(a.shortfall, b.shortfall),
            excess: farther(a.excess, b.excess),
            slack,
        })
}

fn test_points(sweep: &Sweep, count: usize) -> Vec<DVec3> {
    let mut numbers = pseudo_random(count as u64);
    let mut number = || numbers.next().expect("endless");
    let solid = &sweep.solid;
    let [min, max] = solid.measures().bounds;
    let bound = sweep.error_bound;
    // Not nearer than 1e-9 of the size, for the exact solids.
    let layer = 4.0
        * bound
            .inside
            .length
            .max(bound.outside.length)
            .max(1e-9 * min.distance(max));
    (0..count)
        .map(|k| {
            let at = DVec3::new(number(), number(), number());
            if k % 2 == 0 {
                min + (max - min) * at
            } else {
                let triangle = solid.triangles()
                    [(number() * solid.triangles().len() as f64) as usize]
                    .map(|v| solid.positions()[v as usize]);
                let normal = (triangle[1] - triangle[0])
                    .cross(triangle[2] - triangle[0])
                    .normalize_or_zero();
                let on = triangle[0].lerp(triangle[1], at.x).lerp(triangle[2], at.y);
                on + normal * (layer * (2.0 * at.z - 1.0))
            }
        })
        .collect()
}

/// The distance from a point to the nearest of many points around it that are in the exact sweep;
/// infinite if none is nearer than `reach`.
fn distance_to_sweep(membership: &Membership, point: DVec3, reach: f64) -> f64 {
    let mut numbers = pseudo_random(7);
    let mut number = || 2.0 * numbers.next().expect("endless") - 1.0;
    let mut nearest = f64::INFINITY;
    for _ in 0..4000 {
        let way = DVec3::new(number(), number(), number());
        let distance = reach * way.length();
        if distance < nearest && membership.is_ever_inside(point + reach * way) {
            nearest = distance;
        }
    }
    nearest
}

/// Volume of the swept region without any envelope: points are counted by how often they are
/// inside.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Reference {
    pub(crate) volume: f64,
    /// Standard error of the volume.
    pub(crate) deviation: f64,
}

impl Reference {
    /// The integral of the number of visits is V + sum over the spans of the flux out of the egress
    /// part, integrated over time; the flux of a steady field through a carried face grows as det
    /// A^t. The surplus visits are subtracted, as the mean over `samples` random points.
    pub(crate) fn new(mesh: &Mesh, motion: &Motion, samples: usize) -> Reference {
        let start = mesh.transformed(motion.start_pose());
        let [min, max] = path_box(&start, motion);
        let membership = Membership::new(mesh, motion);
        let mut numbers = pseudo_random(samples as u64 + 1);
        let mut number = || numbers.next().expect("endless");
        let points: Vec<DVec3> = (0..samples)
            .map(|_| min + (max - min) * DVec3::new(number(), number(), number()))
            .collect();
        let surplus: Vec<f64> = points
            .par_iter()
            .map(|&point| membership.intervals(point).len().saturating_sub(1) as f64)
            .collect();
        let n = samples as f64;
        let mean = surplus.iter().sum::<f64>() / n;
        let variance = surplus.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / n;
        let size = (max - min).element_product();
        Reference {
            volume: visits(&start, motion) - size * mean,
            // At least that of a single visit: finding none does not mean that there is none.
            deviation: size * (variance.max(1.0 / n) / n).sqrt(),
        }
    }

    /// How far the volume of a sweep is off beyond its bounds; empty when it is within them.
    pub(crate) fn volume_defects(&self, sweep: &Sweep) -> String {
        let (measures, bound) = (sweep.solid.measures(), sweep.error_bound);
        let difference = measures.volume - self.volume;
        let noise = 4.0 * self.deviation;
        if difference > bound.outside.length * measures.area + noise
            || -difference > bound.inside.length * measures.area + noise
        {
            return format!("volume off by {difference:e}, noise {noise:e}; ");
        }
        String::new()
    }
}

/// Integral of the number of visits over space.
fn visits(start: &Mesh, motion: &Motion) -> f64 {
    let mut visits = start.volume();
    for (span, frame) in motion.spans().iter().zip(motion.joints()) {
        let generator = span.flow().generator();
        let at_joint = start.transformed(frame);
        let flux: f64 = at_joint
            .triangles()
            .iter()
            .map(|t| outward_flux(t.map(|v| at_joint.positions()[v as usize]), generator))
            .sum();
        let columns = generator.linear;
        let rate = columns.x_axis.x + columns.y_axis.y + columns.z_axis.z;
        // Mean of det A^t = e^(rate t) over the span.
        let growth = if rate.abs() < 1e-9 {
            1.0
        } else {
            rate.exp_m1() / rate
        };
        visits += flux * growth;
    }
    visits
}

/// The integral of the positive part of n . v over a triangle: v is linear, so it is the area of a
/// polygon times its mean.
fn outward_flux(corners: [DVec3; 3], generator: &Generator) -> f64 {
    let twice_area = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a);
    let normal = twice_area(corners).normalize_or_zero();
    let flux = |p: DVec3| normal.dot(generator.velocity(p));
    let mut kept = Vec::new();
    for i in 0..3 {
        let (from, to) = (corners[i], corners[(i + 1) % 3]);
        let (g, h) = (flux(from), flux(to));
        if g >= 0.0 {
            kept.push(from);
        }
        if (g > 0.0 && h < 0.0) || (g < 0.0 && h > 0.0) {
            kept.push(from.lerp(to, g / (g - h)));
        }
    }
    (2..kept.len())
        .map(|i| {
            let part = [kept[0], kept[i - 1], kept[i]];
            let mean = part.map(flux).iter().sum::<f64>() / 3.0;
            twice_area(part).dot(normal) / 2.0 * mean
        })
        .sum()
}

/// A box around the moving body, sampled and widened.
pub(crate) fn path_box(start: &Mesh, motion: &Motion) -> [DVec3; 2] {
    let end = *motion.joint_times().last().expect("there is a clock");
    let back = motion.start_pose().inverse();
    let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for i in 0..=200 {
        let pose = motion.pose_at_time(end * f64::from(i) / 200.0) * back;
        for &p in start.positions() {
            let p = pose.transform_point3(p);
            (min, max) = (min.min(p), max.max(p));
        }
    }
    let margin = (max - min) * 0.01;
    [min - margin, max + margin]
}
