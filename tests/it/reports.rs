//! Every JSON report as a strict reader sees it: no duplicate keys, and times that add up.

use crate::support::command::{CUBE, Scratch};
use serde::Deserialize;
use serde::de::{Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Value};
use std::fmt;

/// A JSON value without duplicate keys.
struct Strict(Value);

impl<'de> Deserialize<'de> for Strict {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Strict, D::Error> {
        deserializer.deserialize_any(StrictVisitor).map(Strict)
    }
}

struct StrictVisitor;

impl<'de> Visitor<'de> for StrictVisitor {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("JSON without duplicate keys")
    }

    fn visit_unit<E>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_bool<E>(self, value: bool) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_i64<E>(self, value: i64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_u64<E>(self, value: u64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_f64<E>(self, value: f64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_str<E>(self, value: &str) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Value, A::Error> {
        let mut values = Vec::new();
        while let Some(Strict(value)) = list.next_element()? {
            values.push(value);
        }
        Ok(values.into())
    }

    fn visit_map<A: MapAccess<'de>>(self, mut object: A) -> Result<Value, A::Error> {
        let mut values = Map::new();
        while let Some(key) = object.next_key::<String>()? {
            let Strict(value) = object.next_value()?;
            if values.insert(key.clone(), value).is_some() {
                return Err(A::Error::custom(format!("the key {key:?} stands twice")));
            }
        }
        Ok(values.into())
    }
}

#[test]
fn a_strict_reader_refuses_a_key_that_stands_twice() {
    let read = |text| serde_json::from_str::<Strict>(text).map(|strict| strict.0);
    let text = r#"{"a": [1, -2, 0.5, null, true, "x"], "b": {"a": {}}}"#;
    assert_eq!(
        read(text).expect("no key twice in one object"),
        serde_json::from_str::<Value>(text).expect("JSON")
    );
    let twice = read(r#"{"a": {"b": 1, "c": 2, "b": 1}}"#);
    assert!(
        twice.is_err_and(|error| error.to_string().contains("\"b\" stands twice")),
        "refused with the key"
    );
}

/// The report of a run, read strictly, whose times are numbers that add up to the total.
fn report(scratch: &Scratch, arguments: &str) -> Value {
    let run = scratch.run(&format!("{arguments} --json"));
    assert!(
        run.err.is_empty() && matches!(run.code, Some(0 | 1)),
        "{arguments}: {:?}, {}",
        run.code,
        run.err
    );
    let Strict(report) = serde_json::from_str(&run.out)
        .unwrap_or_else(|error| panic!("{arguments}: {error}: {}", run.out));
    if let Some(seconds) = report.get("seconds") {
        let seconds = seconds.as_object().expect("an object");
        let time = |value: &Value| value.as_f64().expect("numbers only");
        let total = time(&seconds["total"]);
        let stages: f64 = seconds.values().map(time).sum::<f64>() - total;
        assert!(
            (stages - total).abs() <= 0.1 * total,
            "{arguments}: the stages add up to {stages}, the total is {total}"
        );
    }
    report
}

/// A plate much thinner than the tolerance of the tests.
const PLATE: &str = "\
v 0 0 0
v 1 0 0
v 1 0.5 0
v 0 0.5 0
v 0 0 0.00037
v 1 0 0.00037
v 1 0.5 0.00037
v 0 0.5 0.00037
f 4 3 2 1
f 5 6 7 8
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8
";

/// A screw under which the plate is sampled twice: the first attempt loses more than the tolerance.
const TWICE: &str =
    "--turn 127 --axis -0.89,-0.66,0.83 --through -0.42,-0.09,-0.69 --advance -0.29";

const PATH: &str = r#"{"keyframes": [
    {"translation": [0, 0, 0]},
    {"translation": [2, 0, 1], "rotation": [0, 0, 0.6, 0.8]},
    {"translation": [2, 1, 1], "rotation": [0.6, 0, 0, 0.8]}
]}"#;

const PLANAR_PATH: &str = r#"{"keyframes": [
    {"translation": [0, 0]}, {"translation": [2, 1], "rotation_deg": 50}, {"translation": [0, 1]}
]}"#;

fn svg(path: &str) -> String {
    format!(r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 9 9"><path d="{path}"/></svg>"#)
}

#[test]
fn no_report_in_space_has_a_key_twice() {
    let scratch = Scratch::new("strict_reports");
    scratch.write("cube.obj", CUBE);
    scratch.write("plate.obj", PLATE);
    scratch.write("path.json", PATH);
    scratch.write("points.csv", "0.5,0.5,0.5\n9,9,9\n");
    for (motion, attempts) in [("--motion path.json", 1), (TWICE, 2)] {
        for body in ["cube", "plate"] {
            let sweep = format!("sweep {body}.obj {motion} --tolerance 0.03");
            let found = report(&scratch, &format!("{sweep} -o {body}_swept.obj"));
            let expected = if body == "plate" { attempts } else { 1 };
            assert_eq!(found["sweep"]["attempts"], expected, "{sweep}");
            let against = format!("--against {body}_swept.obj cube.obj");
            for more in ["", "--intervals", "--clearance 0.1 --csv out.csv"] {
                report(
                    &scratch,
                    &format!("check {body}.obj {motion} {against} {more}"),
                );
            }
            report(
                &scratch,
                &format!("probe {body}.obj {motion} --points points.csv"),
            );
        }
        report(&scratch, &format!("motion {motion}"));
    }
    assert!(
        scratch.files().contains(&"plate_swept.obj".to_owned()),
        "solids are written"
    );
}

#[test]
fn no_report_in_the_plane_has_a_key_twice() {
    let scratch = Scratch::new("strict_planar_reports");
    scratch.write("square.svg", svg("M 0 0 H 1 V 1 H 0 Z"));
    scratch.write("needle.svg", svg("M 0 0 L 1 0.1 V 0.1001 L 0 0.0001 Z"));
    scratch.write("blank.svg", svg("M 0 0 H 3 V 3 H 0 Z"));
    scratch.write("path.json", PLANAR_PATH);
    scratch.write("points.csv", "0.5,0.5\n9,9\n");
    for body in ["square", "needle"] {
        for motion in ["--motion path.json", "--turn 90 --through 1,2"] {
            let sweep = format!("sweep {body}.svg {motion} --tolerance 0.01");
            let found = report(&scratch, &format!("{sweep} -o out.svg"));
            assert!(
                found["sweep"]["attempts"].as_u64() >= Some(1),
                "{sweep}: a count"
            );
            report(&scratch, &format!("{sweep} --subtract-from blank.svg"));
            report(
                &scratch,
                &format!("probe {body}.svg {motion} --points points.csv"),
            );
            report(&scratch, &format!("motion {motion}"));
        }
    }
}
