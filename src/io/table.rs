//! Tables: CSV files with a header line.

use super::error::{OutputError, OutputProblem};
use super::file::check_kind;
use super::replace;
use std::io::Write;
use std::path::Path;

/// Extensions of tables that can be written.
const KNOWN: &[&str] = &[".csv"];

/// Checks that a table can be written to `path`, before anything is computed: it is a `.csv` and a
/// file can be created in the directory. Leaves no trace.
///
/// # Errors
/// [`OutputError`] with what is wrong.
pub fn check_table(path: &Path) -> Result<(), OutputError> {
    check_kind(path, KNOWN).map(drop)
}

/// Writes a table as CSV (RFC 4180, but with a line feed alone): a header of `columns`, then a line
/// per row; the file appears once it is complete.
///
/// # Errors
/// [`OutputError`]; a file that was there before is then unharmed.
///
/// # Example
/// ```
/// use steadysweep::io::write_table;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let path = std::env::temp_dir().join(format!("steadysweep-{}.csv", std::process::id()));
/// let rows = [0.0, 0.5].map(|time: f64| [time.to_string(), (2.0 * time).to_string()]);
/// write_table(&path, ["time", "distance"], rows)?;
/// assert_eq!(std::fs::read_to_string(&path)?, "time,distance\n0,0\n0.5,1\n");
/// # std::fs::remove_file(&path)?;
/// # Ok(())
/// # }
/// ```
pub fn write_table<const N: usize>(
    path: &Path,
    columns: [&str; N],
    rows: impl IntoIterator<Item = [String; N]>,
) -> Result<(), OutputError> {
    check_table(path)?;
    let written = replace::replace_file(path, |out| {
        writeln!(out, "{}", columns.map(quoted).join(","))?;
        for row in rows {
            writeln!(
                out,
                "{}",
                row.each_ref().map(|field| quoted(field)).join(",")
            )?;
        }
        out.flush()
    });
    written.map_err(|error| {
        OutputError::new(
            path,
            OutputProblem::Failed {
                reason: error.to_string(),
            },
        )
    })
}

/// A field, quoted where it could be taken for more than one.
fn quoted(field: &str) -> String {
    if field.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::Folder;
    use super::*;

    #[test]
    fn fields_are_quoted_where_they_need_it() {
        let folder = Folder::new("table");
        let path = folder.path("out.CSV");
        let rows = [["0.5", "a,b.stl"], ["1", "say \"c\".stl"]];
        let rows = rows.map(|row| row.map(str::to_owned));
        write_table(&path, ["time", "file"], rows).expect("a folder of our own");
        assert_eq!(
            std::fs::read_to_string(&path).expect("there"),
            "time,file\n0.5,\"a,b.stl\"\n1,\"say \"\"c\"\".stl\"\n"
        );
        assert_eq!(folder.names(), ["out.CSV"], "nothing else is left");
    }

    #[test]
    fn a_table_never_takes_the_place_of_a_mesh() {
        let refused = check_table(Path::new("part.stl")).expect_err("no table");
        assert_eq!(
            refused.to_string(),
            "part.stl: unknown extension .stl, expected one of .csv"
        );
    }
}
