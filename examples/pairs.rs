//! First contact of single pairs, many at once: for comparison with other programs.
//!
//! You learn the smallest question that the library answers: when does a moving vertex, edge or
//! triangle first meet one at rest? The answer is a bracket in time that certainly contains the
//! contact, or a proof that there is none.
//!
//! Run: `cargo run --example pairs [IN.csv [OUT.csv]]`; without names, the pairs of the repository
//! are read and the answers go to the terminal. Each line of IN: the kind (`vertex_face`,
//! `face_vertex`, `edge_edge`), the generator of the motion (3 rows of 4 numbers), the corners of
//! the moving feature, then those of the resting one (12 numbers), and optionally a window of time
//! between 0 and 1. Each line of OUT: the outcome (`contact`, `touch`, `none`, `undecided`), the
//! bracket or the undecided window, and microseconds. At the end you should see how many pairs
//! meet, and the longest time that one pair took.

use glam::DVec3;
use std::error::Error;
use std::fmt::Write;
use std::path::PathBuf;
use std::time::Instant;
use steadysweep::collision::pair::{PairOutcome, edge_edge, face_vertex, vertex_face};
use steadysweep::motion::Generator;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args_os().skip(1).map(PathBuf::from);
    let shipped = || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/pairs.csv"));
    let input = std::fs::read_to_string(arguments.next().unwrap_or_else(shipped))?;
    let (mut output, mut contacts) = (String::from("outcome,from,to,microseconds\n"), 0);
    let (mut pairs, mut worst, mut total) = (0, 0.0_f64, 0.0);
    for (number, line) in (1..).zip(input.lines()) {
        if line.trim().is_empty() || line.starts_with('#') {
            continue;
        }
        let (kind, pair) = parse(line).map_err(|what| format!("line {number}: {what}"))?;
        let clock = Instant::now();
        let outcome = solve(kind, &pair).ok_or_else(|| format!("line {number}: kind {kind:?}"))?;
        let microseconds = clock.elapsed().as_secs_f64() * 1e6;
        (pairs, total, worst) = (pairs + 1, total + microseconds, worst.max(microseconds));
        let (word, bracket) = match outcome {
            PairOutcome::None => ("none", None),
            PairOutcome::First { bracket, touch } => {
                contacts += 1;
                (if touch { "touch" } else { "contact" }, Some(bracket))
            }
            PairOutcome::Undecided { window } => ("undecided", Some(window)),
        };
        let times = bracket.map_or(",".into(), |[from, to]| format!("{from},{to}"));
        writeln!(output, "{word},{times},{microseconds:.2}")?;
    }
    let summary = format!(
        "pairs     {pairs}\nmeet      {contacts}\nmean us   {:.2}\nworst us  {worst:.2}",
        total / f64::from(pairs.max(1))
    );
    if let Some(path) = arguments.next() {
        std::fs::write(path, output)?;
        println!("{summary}");
    } else {
        print!("{output}");
        eprintln!("{summary}");
    }
    Ok(())
}

struct Pair {
    generator: Generator,
    points: [DVec3; 4],
    window: [f64; 2],
}

fn parse(line: &str) -> Result<(&str, Pair), Box<dyn Error>> {
    let (kind, rest) = line.split_once(',').ok_or("no numbers")?;
    let fields = rest.split(',').map(|field| field.trim().parse::<f64>());
    let numbers = fields.collect::<Result<Vec<f64>, _>>()?;
    let window = match numbers[..] {
        [.., start, end] if numbers.len() == 26 => [start, end],
        _ if numbers.len() == 24 => [0.0, 1.0],
        _ => return Err(format!("{} numbers, expected 24 or 26", numbers.len()).into()),
    };
    let row = |k: usize| [0, 1, 2, 3].map(|j| numbers[4 * k + j]);
    let generator = Generator::from_rows([row(0), row(1), row(2)])?;
    let points = [12, 15, 18, 21].map(|k| DVec3::from_slice(&numbers[k..]));
    let pair = Pair {
        generator,
        points,
        window,
    };
    Ok((kind.trim(), pair))
}

fn solve(kind: &str, pair: &Pair) -> Option<PairOutcome> {
    let Pair {
        generator, window, ..
    } = pair;
    let [a, b, c, d] = pair.points;
    Some(match kind {
        "vertex_face" => vertex_face(generator, a, [b, c, d], *window),
        "face_vertex" => face_vertex(generator, [a, b, c], d, *window),
        "edge_edge" => edge_edge(generator, [a, b], [c, d], *window),
        _ => return None,
    })
}
