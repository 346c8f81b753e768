//! Finds when points are inside a moving body, without computing the swept solid.
//!
//! You learn that membership is exact (roots of one function of time per face, no sampling), and
//! that the answer is a list of time intervals on the motion's clock.
//!
//! Run: `cargo run --example probe_points`.
//!
//! You should see three visits at the first point: the foot of the bracket passes it once, and its
//! two holes leave the point free for a moment. The second point is met in both revolutions, the
//! third one in neither.

use std::error::Error;
use std::path::Path;

use glam::DVec3;
use steadysweep::io::read_body;
use steadysweep::membership::Membership;
use steadysweep::motion::{Motion, Screw, Span};

fn main() -> Result<(), Box<dyn Error>> {
    let (bracket, _) = read_body(Path::new(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/examples/bracket.stl"
    )))?;
    let screw = Screw {
        axis: DVec3::Z,
        through: DVec3::new(90.0, 20.0, 0.0),
        turn: 720_f64.to_radians(),
        advance: 6.0,
        ..Screw::default()
    };
    // The clock runs from 0 to 2: one unit per revolution.
    let motion = Motion::from_spans(vec![Span::new(screw.generator()?, 2.0)?])?;
    let membership = Membership::new(&bracket, &motion);

    for point in [
        DVec3::new(90.0, 69.0, 4.0),
        DVec3::new(90.0, 69.0, 7.0),
        DVec3::new(90.0, 20.0, 5.0),
    ] {
        let intervals = membership.intervals(point);
        print!("{point}: {} visits", intervals.len());
        for [enters, leaves] in intervals {
            print!(", from {enters:.6} to {leaves:.6}");
        }
        println!();
    }
    Ok(())
}
