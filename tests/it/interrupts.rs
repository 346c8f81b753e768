//! Runs that are watched: what the observer is told, and how they end when their flag goes up.

use crate::support::planar;
use crate::support::shapes::{bumpy_sphere, icosphere, mapped, torus};
use glam::{DVec2, DVec3};
use std::f64::consts::PI;
use std::fmt::Debug;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use steadysweep::body::{FillRule, Mesh, Polygon, Surface};
use steadysweep::collision::{self, CheckError, CheckSettings, CheckStage, ContactRule, Obstacle};
use steadysweep::membership::{Membership, ProbeSettings, ProbeStage};
use steadysweep::motion::{Generator, Motion, Span};
use steadysweep::planar as plane;
use steadysweep::{Interrupted, Stage, SweepError, SweepSettings, sweep};

type Observer<'a, S> = &'a (dyn Fn(S, f64) + Sync);

/// Watches a run: once to its end, and then with the flag up at some of the notices.
///
/// - `run`: whether it ended with `Interrupted`.
fn watch<S: Copy + PartialEq + Debug + Send>(run: impl Fn(Observer<S>, &AtomicBool) -> bool) {
    let heard = |stop: usize| {
        let (told, flag) = (Mutex::new(Vec::new()), AtomicBool::new(false));
        let tell = |stage: S, share: f64| {
            let mut told = told.lock().expect("nothing panics");
            flag.store(told.len() >= stop, Ordering::Relaxed);
            told.push((stage, share));
        };
        let is_stopped = run(&tell, &flag);
        (told.into_inner().expect("nothing panics"), is_stopped)
    };
    let (whole, is_stopped) = heard(usize::MAX);
    assert!(!is_stopped, "nobody stops it");
    assert_eq!(whole[0].1, 0.0, "a stage begins");
    for pair in whole.windows(2) {
        let [(stage, share), (next, further)] = [pair[0], pair[1]];
        assert!(
            further == 0.0 || (stage == next && further > share && further <= 1.0),
            "{next:?} at {further} after {stage:?} at {share}"
        );
    }
    for stage in whole.chunk_by(|_, next| next.1 != 0.0) {
        assert!(stage.len() <= 101, "{}", stage.len());
    }
    // Near the end nothing may be left to do.
    for eighth in 0..7 {
        let stop = eighth * whole.len() / 8;
        let (told, is_stopped) = heard(stop);
        assert!(is_stopped, "up at notice {stop}: {:?}", told.last());
        let more = told.len() - stop - 1;
        let threads = rayon::current_num_threads();
        assert!(more <= threads, "{more} notices with the flag up");
    }
}

fn screw(degrees: f64, through: DVec3) -> Motion {
    let generator = Generator::screw(DVec3::Z, through, degrees.to_radians(), 1.0, 1.0);
    Motion::from_spans(vec![Span::new(generator, 1.0).expect("finite")]).expect("one span")
}

fn body((positions, triangles): (Vec<DVec3>, Vec<[u32; 3]>)) -> Mesh {
    Mesh::new(positions, triangles).expect("a body")
}

#[test]
fn sweeps_in_space_tell_their_shares_and_stop() {
    let body = body(torus(3.0, 1.0, 60, 30));
    let step = |degrees: f64| {
        let through = DVec3::new(9.0, degrees, 0.0);
        Generator::screw(DVec3::Z, through, degrees.to_radians(), 1.0, 1.0)
    };
    let span = |degrees| Span::new(step(degrees), 1.0).expect("finite");
    let chain = Motion::from_spans((1..9).map(|i| span(f64::from(5 * i))).collect());
    for (motion, tolerance) in [
        (screw(180.0, 9.0 * DVec3::X), 0.01),
        (chain.expect("spans follow each other"), 0.05),
    ] {
        watch(|tell: Observer<Stage>, flag| {
            let settings = SweepSettings::default()
                .with_tolerance(tolerance)
                .with_sources()
                .with_observer(tell)
                .with_interrupt(flag);
            let swept = sweep(&body, &motion, &settings);
            matches!(swept, Err(SweepError::Interrupted))
        });
    }
}

#[test]
fn sweeps_of_many_pieces_in_the_plane_tell_their_shares_and_stop() {
    let places = (0..400_u32).map(|i| DVec2::new(f64::from(i % 20), f64::from(i / 20)));
    let discs = places.map(|place| planar::disc(24, 3.0 * place, 1.0));
    let body = Polygon::new(discs.collect(), FillRule::NonZero).expect("discs");
    let turn = plane::Generator::spiral(DVec2::new(-5.0, -5.0), PI / 6.0, 1.2);
    let motion = planar::motion(&[turn]);
    watch(|tell: Observer<Stage>, flag| {
        let settings = plane::SweepSettings::default()
            .with_tolerance(1e-3)
            .with_observer(tell)
            .with_interrupt(flag);
        let swept = plane::sweep(&body, &motion, &settings);
        matches!(swept, Err(plane::SweepError::Interrupted))
    });
}

#[test]
fn checks_tell_their_shares_and_stop() {
    let body = body(bumpy_sphere(5_000));
    let wall = |x: f64| {
        let (positions, triangles) = mapped(icosphere(4, 1.0, DVec3::ZERO), |p| p + x * DVec3::X);
        Surface::new(positions, triangles).expect("a ball")
    };
    let (far, near) = (wall(8.5), wall(7.0));
    let motion = screw(180.0, 3.0 * DVec3::X);
    for (obstacle, rule) in [
        (&far, ContactRule::Touch),
        (&near, ContactRule::Touch),
        (&near, ContactRule::Enter { depth: Some(0.05) }),
    ] {
        watch(|tell: Observer<CheckStage>, flag| {
            let settings = CheckSettings::default()
                .with_all_intervals()
                .with_rules(vec![rule])
                .with_observer(tell)
                .with_interrupt(flag);
            let obstacle = Obstacle {
                surface: obstacle,
                motion: None,
            };
            let found = collision::check(&body, &motion, &[obstacle], &settings);
            matches!(found, Err(CheckError::Interrupted))
        });
    }
}

#[test]
fn probes_tell_their_shares_and_stop() {
    let body = body(bumpy_sphere(2_000));
    let membership = Membership::new(&body, &screw(180.0, 3.0 * DVec3::X));
    let points: Vec<DVec3> = (0..20_000)
        .map(|i| {
            DVec3::new(
                f64::from(i % 100) * 0.1 - 2.0,
                f64::from(i / 100) * 0.05,
                0.3,
            )
        })
        .collect();
    watch(|tell: Observer<ProbeStage>, flag| {
        let settings = ProbeSettings::default()
            .with_observer(tell)
            .with_interrupt(flag);
        membership.probe(&points, &settings) == Err(Interrupted)
    });
    let unwatched = membership.probe(&points, &ProbeSettings::default());
    assert_eq!(unwatched, Ok(membership.intervals_of(&points)));
}
