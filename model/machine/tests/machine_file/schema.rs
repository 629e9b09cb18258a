//! The JSON Schema agrees with the reader, and the committed one is that of this version.

use std::path::{Path, PathBuf};

use posicast_machine::machine_file::{self, ProblemCause};
use serde_json::Value;

use super::files::EVERYTHING;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Collects every key below a table of the schema, with the keys that lead to it.
fn keys(table: &Value, path: &[String], found: &mut Vec<(Vec<String>, Value)>) {
    for (name, key) in table["properties"].as_object().unwrap() {
        let path: Vec<String> = path.iter().cloned().chain([name.clone()]).collect();
        found.push((path.clone(), key.clone()));
        let inner = if key["type"] == "array" { &key["items"] } else { key };
        if inner["type"] == "object" {
            keys(inner, &path, found);
        }
    }
}

fn all_keys() -> Vec<(Vec<String>, Value)> {
    let mut found = Vec::new();
    keys(&machine_file::schema(), &[], &mut found);
    assert!(found.len() > 80, "{} keys", found.len());
    found
}

/// Returns the file with every block, with one key replaced; of several axes or modes, the first.
fn everything_with(path: &[String], value: toml::Value) -> toml::Table {
    let mut file: toml::Table = toml::from_str(EVERYTHING).unwrap();
    let (last, tables) = path.split_last().unwrap();
    let mut table = &mut file;
    for name in tables {
        let inner = table
            .entry(name.as_str())
            .or_insert_with(|| toml::Value::Table(toml::Table::new()));
        table = match inner {
            toml::Value::Array(tables) => tables[0].as_table_mut().unwrap(),
            other => other.as_table_mut().unwrap(),
        };
    }
    if last == "damped_frequency_hz" {
        table.remove("frequency_hz");
    }
    table.insert(last.clone(), value);
    file
}

/// Returns values that the schema refuses for a key.
fn refused(key: &Value) -> Vec<toml::Value> {
    if let Some(forms) = key["anyOf"].as_array() {
        return forms.iter().flat_map(refused).collect();
    }
    let number = |name: &str| key[name].as_f64();
    let mut values = match key["type"].as_str().unwrap() {
        "boolean" => vec![toml::Value::Integer(1)],
        _ => vec![toml::Value::Boolean(true)],
    };
    match key["type"].as_str().unwrap() {
        "number" => {
            let outside = [
                number("minimum").map(|low| low - 1e-3 * low.abs().max(1e-6)),
                number("exclusiveMinimum"),
                number("maximum").map(|high| high + 1e-3 * high.abs().max(1e-6)),
                number("exclusiveMaximum"),
            ];
            let outside: Vec<f64> = outside.into_iter().flatten().collect();
            assert_eq!(outside.len(), 2, "a range has two ends: {key}");
            values.extend(outside.into_iter().map(toml::Value::Float));
        }
        "integer" => {
            values.push(toml::Value::Float(8.5));
            let ends = number("minimum").zip(number("maximum"));
            let (low, high) = ends.unwrap_or((0.0, 1e6));
            values.extend([low - 1.0, high + 1.0].map(|end| toml::Value::Integer(end as i64)));
        }
        "string" => values.push(toml::Value::String("No such word!".to_owned())),
        "array" if key["items"]["type"] == "object" => values.push(toml::Value::Array(Vec::new())),
        "array" => values.push(toml::Value::Array(vec![toml::Value::String("no such word".to_owned())])),
        _ => {}
    }
    values
}

#[test]
fn what_the_schema_refuses_the_reader_refuses_at_the_same_key() {
    let validator = jsonschema::validator_for(&machine_file::schema()).unwrap();
    for (path, key) in all_keys() {
        let dotted = path.join(".");
        for value in refused(&key) {
            let file = everything_with(&path, value.clone());
            let json = serde_json::to_value(&file).unwrap();
            assert!(!validator.is_valid(&json), "{dotted} = {value}: the schema takes it");
            let error = machine_file::parse("m.toml", &toml::to_string(&file).unwrap()).unwrap_err();
            let at_key = |p: &&machine_file::Problem| p.key == dotted;
            let problem = error.problems().iter().find(at_key);
            let problem = problem.unwrap_or_else(|| panic!("{dotted} = {value}: {error}"));
            let unknown = matches!(problem.cause, ProblemCause::UnknownKey { .. });
            assert!(!unknown, "{dotted}: the reader does not know it");
        }
    }
}

#[test]
fn each_table_of_the_reader_allows_the_keys_of_the_schema() {
    let mut tables = vec![(Vec::new(), machine_file::schema())];
    tables.extend(all_keys().into_iter().filter_map(|(path, key)| {
        let table = if key["type"] == "array" {
            key["items"].clone()
        } else {
            key
        };
        table["properties"].is_object().then_some((path, table))
    }));
    assert_eq!(tables.len(), 26);
    for (path, table) in tables {
        let unknown: Vec<String> = path.iter().cloned().chain(["no_such_key".to_owned()]).collect();
        let file = everything_with(&unknown, toml::Value::Boolean(true));
        let error = machine_file::parse("m.toml", &toml::to_string(&file).unwrap()).unwrap_err();
        let found = error.problems().iter().find_map(|problem| match &problem.cause {
            ProblemCause::UnknownKey { allowed, .. } => Some(allowed.clone()),
            _ => None,
        });
        let names: Vec<&str> = table["properties"]
            .as_object()
            .unwrap()
            .keys()
            .map(String::as_str)
            .collect();
        assert_eq!(found, Some(names.join(", ")), "{path:?}");
    }
}

#[test]
fn the_examples_and_the_templates_are_valid() {
    let validator = jsonschema::validator_for(&machine_file::schema()).unwrap();
    let mut files = 0;
    for folder in ["examples", "cli/src/new", "model/machine/tests/machine_file"] {
        for entry in std::fs::read_dir(root().join(folder)).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_none_or(|extension| extension != "toml") {
                continue;
            }
            let file: toml::Table = toml::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
            let json = serde_json::to_value(file).unwrap();
            let errors: Vec<String> = validator.iter_errors(&json).map(|error| error.to_string()).collect();
            assert!(errors.is_empty(), "{}: {errors:?}", path.display());
            files += 1;
        }
    }
    assert!(files >= 11, "{files} files");
}

#[test]
fn the_speed_of_a_line_goes_with_its_kind() {
    let text = std::fs::read_to_string(root().join("examples/xy-stage.toml")).unwrap();
    let validator = jsonschema::validator_for(&machine_file::schema()).unwrap();
    for (link, is_right) in [
        ("baud = 3_000_000", true),
        ("line = \"uart\"\nbaud = 3_000_000", true),
        ("line = \"spi\"\nsck_hz = 1_000_000", true),
        ("line = \"spi\"\nbaud = 3_000_000", false),
        ("sck_hz = 1_000_000", false),
        ("line = \"spi\"\nsck_hz = 1_000_000\nbaud = 3_000_000", false),
        ("line = \"spi\"", false),
    ] {
        let text = format!("{text}[link]\n{link}\n");
        let json = serde_json::to_value(toml::from_str::<toml::Table>(&text).unwrap()).unwrap();
        assert_eq!(validator.is_valid(&json), is_right, "{link}");
        assert_eq!(machine_file::parse("m.toml", &text).is_ok(), is_right, "{link}");
    }
}

#[test]
fn golden_the_committed_schema_is_what_the_keys_say() {
    let written = serde_json::to_string_pretty(&machine_file::schema()).unwrap() + "\n";
    let path = root().join("docs/machine-file.schema.json");
    if std::env::var_os("POSICAST_REGENERATE").is_some() {
        std::fs::write(&path, &written).unwrap();
    }
    let committed = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        committed == written,
        "docs/machine-file.schema.json is not what the keys say; if the change is meant: scripts/regenerate"
    );
}
