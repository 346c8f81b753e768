//! Files: bytes in, validated values out. Knows no geometry beyond what makes a body or a motion
//! from a file.
//!
//! Every refusal is an [`InputError`] or [`OutputError`] that names the file, the place in it, what
//! was expected and what was found, and what to do. No file makes a reader panic or allocate more
//! than its size warrants.

mod drawing;
mod drawing_error;
mod drawing_file;
mod dxf;
mod error;
mod file;
mod mesh;
mod motion;
mod picture;
mod points;
mod replace;
mod svg;
mod table;
mod units;

pub use drawing::{Drawing, DrawingFormat, DrawingSettings, LineDrawing};
pub use drawing_error::{DrawingError, FigurePlace, OpenEnd, UnsupportedKind};
pub use drawing_file::{drawing_format, parse_drawing, parse_lines, read_drawing, read_lines};
pub use error::{InputError, InputProblem, OutputError, OutputProblem, Place};
#[cfg(feature = "cli")]
pub(crate) use file::{check_kind, written};
pub use mesh::{
    FileNumbers, MeshFormat, ReadReport, check_output, parse_body, parse_surface, read_body,
    read_surface, write_mesh,
};
pub use motion::{
    AnyMotion, Dimension, FittedKey, MotionFile, PoseLogFormat, PoseLogSettings, ReadMotion,
    motion_dimension, parse_any_motion, parse_motion, parse_planar_motion, parse_planar_pose_log,
    parse_pose_log, read_any_motion, read_motion, read_motion_file, read_motion_turning,
    read_planar_motion, read_planar_motion_file, read_planar_motion_turning,
};
pub use picture::{
    RegionFormat, RegionPicture, RegionSubject, VerticalAxis, check_region_output, write_region,
    write_region_triangles,
};
pub use points::{parse_planar_points, parse_points, read_planar_points, read_points};
#[cfg(feature = "cli")]
pub(crate) use replace::remove_unfinished;
pub use table::{check_table, write_table};
pub use units::{DeclaredUnit, Unit};

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use std::fs;
    use std::path::PathBuf;

    /// Positions and triangles of a tetrahedron: bottom first, then front.
    pub(super) fn tetrahedron() -> (Vec<DVec3>, Vec<[u32; 3]>) {
        (
            vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z],
            vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
        )
    }

    /// A folder for one test, removed at its end.
    pub(super) struct Folder(PathBuf);

    impl Folder {
        pub(super) fn new(name: &str) -> Folder {
            let folder =
                std::env::temp_dir().join(format!("steadysweep-{}-{name}", std::process::id()));
            fs::create_dir_all(&folder).expect("a folder for temporary files");
            Folder(folder)
        }
        pub(super) fn path(&self, name: &str) -> PathBuf {
            self.0.join(name)
        }
        pub(super) fn names(&self) -> Vec<String> {
            let entries = fs::read_dir(&self.0).expect("our folder");
            let mut names: Vec<String> = entries
                .map(|e| {
                    e.expect("an entry")
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
}
