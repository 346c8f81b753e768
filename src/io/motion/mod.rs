//! Motion files: keyframes, spans or the name of a pose log, as JSON.
//!
//! In space:
//!
//! ```json
//! {"keyframes": [{"time": 0, "matrix": [[1,0,0,0], [0,1,0,0], [0,0,1,0]]},
//!                {"time": 1, "translation": [0,0,3], "rotation": [0,0,0,1], "scale": [1,1,1]}]}
//! {"spans": [{"turn_deg": 540, "axis": [0,0,1], "through": [0,0,0], "advance": 3, "scale": 1,
//!             "duration": 1},
//!            {"generator": [[0,0,0,1], [0,0,0,0], [0,0,0,0]], "duration": 2}]}
//! ```
//!
//! In the plane, with angles in degrees, from x towards y: counter-clockwise where y is up:
//!
//! ```json
//! {"keyframes": [{"time": 0, "matrix": [[1,0,0], [0,1,0]]},
//!                {"time": 1, "translation": [0,3], "rotation_deg": 90, "scale": [1,1]}]}
//! {"spans": [{"turn_deg": 540, "through": [0,0], "scale": 1, "duration": 1},
//!            {"generator": [[0,0,1], [0,0,0]], "duration": 2}]}
//! ```
//!
//! Or poses from a log, a text file whose name is relative to the folder of the motion file:
//!
//! ```json
//! {"poses": "log.txt", "columns": "t x y z qx qy qz qw"}
//! ```
//!
//! - A keyframe maps body to world: by a matrix, or by scale (a number or one per axis), rotation
//!   (in space a unit quaternion x, y, z, w, or Euler angles such as `{"euler-zxz-deg": [a,b,c]}`)
//!   and translation, in this order; what is left out is the identity. Or by `points`, pairs of
//!   source and target. Without times the keys are one unit apart.
//! - `interpolation` names what lies between keyframes, or between the poses of a log, where that is
//!   not the steady motion ([`Scheme`](crate::motion::scheme::Scheme)); `without_steady` what stands
//!   in where there is none. Such a motion is followed by steady spans over the body, within
//!   `deviation`, a length; with it, steady motions are joined, too ([`MotionFile`]).
//! - `turns` of a keyframe, a whole number, adds turns to the span that ends there.
//! - A span acts on world coordinates and is described as a whole; `duration`, 1 when left out, is
//!   its share of the clock.
//! - Unknown fields are errors. Keys of the other dimension are refused by name.

mod dimension;
mod file;
mod items;
mod planar;
mod pose_log;
mod rotation;
mod spatial;
mod words;

pub use dimension::{
    AnyMotion, Dimension, ReadMotion, motion_dimension, parse_any_motion, read_any_motion,
};
pub use file::{FittedKey, MotionFile};
pub use planar::{
    parse_planar_motion, read_planar_motion, read_planar_motion_file, read_planar_motion_turning,
};
pub use pose_log::{PoseLogFormat, PoseLogSettings, parse_planar_pose_log, parse_pose_log};
pub use spatial::{parse_motion, read_motion, read_motion_file, read_motion_turning};
