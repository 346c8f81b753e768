//! First steps: the one steady motion that leads from one pose to another.
//!
//! You learn that an affine map A has a logarithm G, that the motion A^t = exp(tG) passes through A
//! at t = 1, and that its velocity field v(p) = M p + tau does not depend on time.
//!
//! Run: `cargo run --example first_motion`.
//!
//! You should see the pose halfway, A^1/2: it turns by 60 degrees and scales by sqrt(2), half of
//! what A does, and two such steps give A again.

use std::error::Error;

use glam::{DAffine3, DQuat, DVec3};
use steadysweep::motion::{describe, logarithm};

fn main() -> Result<(), Box<dyn Error>> {
    let turn = DQuat::from_axis_angle(DVec3::Z, 120_f64.to_radians());
    let a = DAffine3::from_scale_rotation_translation(
        DVec3::splat(2.0),
        turn,
        DVec3::new(4.0, 0.0, 3.0),
    );

    let log = logarithm(&a)?;
    let what = describe(log.flow.generator());
    println!(
        "A is a {} of {:.3} degrees",
        what.kind.name(),
        what.turn_deg.unwrap_or(0.0)
    );

    let half = log.flow.pose_at(0.5);
    println!("A^1/2 =");
    for row in 0..3 {
        let [x, y, z] = half.matrix3.row(row).to_array();
        println!("  {x:8.4} {y:8.4} {z:8.4} {:8.4}", half.translation[row]);
    }
    println!("scale     {:.6}", half.matrix3.determinant().cbrt());

    let twice = half * half;
    let error = (0..4).map(|i| (twice.to_cols_array_2d()[i], a.to_cols_array_2d()[i]));
    let error = error
        .flat_map(|(p, q)| (0..3).map(move |k| (p[k] - q[k]).abs()))
        .fold(0.0, f64::max);
    println!("error     {error:.1e} of A^1/2 A^1/2 against A");

    // Steady: a point that is carried along has the same velocity in the moving frame at all times.
    let point = DVec3::new(1.0, 2.0, 3.0);
    let field = log.flow.generator();
    let carried = half.transform_vector3(field.velocity(point));
    let there = field.velocity(half.transform_point3(point));
    println!(
        "steady    {:.1e} difference of the carried velocity",
        (carried - there).length()
    );
    Ok(())
}
