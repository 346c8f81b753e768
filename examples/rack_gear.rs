//! Cuts an involute gear with a rack of straight teeth, and compares the flanks with the involute.
//!
//! You learn how a motion that is not steady becomes a chain of steady spans with a known error,
//! and how to subtract what a body sweeps from a blank. The rack rolls on the pitch circle: it
//! turns about the point of contact, which itself moves, so that no single steady motion describes
//! it for long.
//!
//! Run: `cargo run --example rack_gear`.
//!
//! You should see that the flanks differ from the involute by less than the two errors that are
//! stated before: that of the chain, r d^2 / 8 for steps of d radians at the pitch radius r, and
//! that of the sweep.

use std::error::Error;
use std::f64::consts::{PI, TAU};

use glam::{DAffine2, DVec2};
use steadysweep::body::{FillRule, Polygon};
use steadysweep::motion::planar::{Keyframe, Motion};
use steadysweep::planar::{SweepSettings, sweep};
use steadysweep::solid::planar::{Arrangement, subtract};

const MODULE: f64 = 2.0;
const TEETH: f64 = 24.0;
const PRESSURE_ANGLE_DEG: f64 = 20.0;
/// Height of the rack's teeth above and below its pitch line.
const TOOTH: f64 = 1.25 * MODULE;
const STEPS: u32 = 720;

fn main() -> Result<(), Box<dyn Error>> {
    let pitch_radius = MODULE * TEETH / 2.0;
    let rack = Polygon::new(vec![rack(pitch_radius)], FillRule::NonZero)?;
    let blank = disc(pitch_radius + MODULE, 1440);

    // While the gear turns by an angle, the rack advances by as much of the pitch circle; relative
    // to the gear, the rack does both.
    let rolled = |angle: f64| {
        DAffine2::from_angle(angle) * DAffine2::from_translation(DVec2::X * pitch_radius * angle)
    };
    let step = TAU / f64::from(STEPS);
    let keys: Vec<Keyframe> = (0..=STEPS)
        .map(|key| Keyframe {
            time: f64::from(key) * step,
            pose: rolled(f64::from(key) * step),
        })
        .collect();
    let motion = Motion::from_keyframes(&keys)?;
    let chain_error = chain_error(&motion, &rolled, step);
    println!(
        "chain: {chain_error:.2e} from rolling, r d^2 / 8 is {:.2e}",
        pitch_radius * step * step / 8.0
    );

    let tolerance = Some(1e-3);
    let swept = sweep(
        &rack,
        &motion,
        &SweepSettings::default().with_tolerance(tolerance),
    )?;
    let bound = swept.error_bound;
    let sweep_error = bound.inside.length.max(bound.outside.length);
    println!("sweep: within {sweep_error:.2e}");

    let loops: Vec<Vec<DVec2>> = swept.loops().collect();
    let gear = subtract(&Polygon::new(vec![blank], FillRule::NonZero)?, &loops)?;
    let measures = gear.measures(&gear.outlines());
    println!("area: {:.4} in {} piece", measures.area, measures.pieces);

    let (flank_error, corners) = flank_error(&gear, pitch_radius);
    println!("flank: {flank_error:.2e} from the involute at {corners} corners");
    if flank_error > chain_error + sweep_error {
        return Err("the flanks are not where they should be".into());
    }
    Ok(())
}

/// Straight teeth that point down at the gear, one of them right above its centre; enough for a
/// full turn.
fn rack(pitch_radius: f64) -> Vec<DVec2> {
    let slope = PRESSURE_ANGLE_DEG.to_radians().tan();
    let half = PI * MODULE / 4.0;
    let (tip, root) = (pitch_radius - TOOTH, pitch_radius + TOOTH);
    let mut corners = Vec::new();
    let mut tooth = -(TEETH + 2.0);
    while tooth <= 2.0 {
        let middle = tooth * PI * MODULE;
        corners.extend([
            DVec2::new(middle - half - TOOTH * slope, root),
            DVec2::new(middle - half + TOOTH * slope, tip),
            DVec2::new(middle + half - TOOTH * slope, tip),
            DVec2::new(middle + half + TOOTH * slope, root),
        ]);
        tooth += 1.0;
    }
    // Its back, clear of the gear.
    let [left, right] = [corners[0], corners[corners.len() - 1]];
    corners.extend([right, left].map(|end| end + DVec2::Y * MODULE));
    corners
}

fn disc(radius: f64, corners: u32) -> Vec<DVec2> {
    let angle = |corner: u32| TAU * f64::from(corner) / f64::from(corners);
    (0..corners)
        .map(|corner| radius * DVec2::from_angle(angle(corner)))
        .collect()
}

/// Largest distance between a point of the rack and its place by exact rolling, in the middle of
/// steps, where it is largest.
fn chain_error(motion: &Motion, rolled: &dyn Fn(f64) -> DAffine2, step: f64) -> f64 {
    (0..STEPS)
        .map(|key| {
            let middle = (f64::from(key) + 0.5) * step;
            // It is the same for all points, since both turn by the same angle.
            let [found, expected] = [motion.pose_at_time(middle), rolled(middle)];
            found.translation.distance(expected.translation)
        })
        .fold(0.0, f64::max)
}

/// Largest distance from the involute among the corners of the gear that lie on its flanks, and
/// their number.
fn flank_error(gear: &Arrangement, pitch_radius: f64) -> (f64, usize) {
    let pressure_angle = PRESSURE_ANGLE_DEG.to_radians();
    let base_radius = pitch_radius * pressure_angle.cos();
    let involute = |angle: f64| angle.tan() - angle;
    let pitch = TAU / TEETH;
    let outlines = gear.outlines();
    let (mut largest, mut count) = (0.0_f64, 0);
    for &corner in outlines.loops().flat_map(|outline| &outline.vertices) {
        let place = gear.positions()[corner as usize];
        let radius = place.length();
        // Below this range, the corners of the rack's teeth round the feet of the gear's; above it
        // are its tips.
        if radius < base_radius + 0.1 * MODULE || radius > pitch_radius + 0.95 * MODULE {
            continue;
        }
        // The angle from the middle of the nearest tooth; a gap is right above the centre.
        let angle = (place.to_angle() - PI / 2.0 - pitch / 2.0).rem_euclid(pitch);
        let from_middle = angle.min(pitch - angle);
        let half_tooth =
            pitch / 4.0 + involute(pressure_angle) - involute((base_radius / radius).acos());
        // Involutes of one circle have the same distance everywhere as on that circle.
        largest = largest.max((base_radius * (from_middle - half_tooth)).abs());
        count += 1;
    }
    (largest, count)
}
