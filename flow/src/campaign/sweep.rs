//! `posicast campaign sweep`: designs a machine at every combination of values, one combination per unit.

use super::{REFUSED, UnitOutcome, Units, hash_of};
use crate::design::DesignReport;
use crate::failure::Failure;
use crate::hardware::Built;
use crate::observer::Observer;
use crate::synth;
use crate::{machine, verilog};
use posicast_machine::machine_file::{AxisSection, Machine};
use posicast_machine::plan::AxisTables;
use posicast_synth::clock::{ClockError, PlaceAndRoute};
use posicast_synth::yosys::Yosys;
use posicast_testbench::shard::MachineFileHash;
use serde_json::{Map, Number, Value};
use std::path::{Path, PathBuf};
use toml_edit::{Array, DocumentMut, Item};

/// The machine that is designed at every combination of values, and the estimates that are made for each.
#[derive(Debug, Clone)]
pub struct SweepOptions {
    /// Machine file with all other values.
    pub machine: PathBuf,
    /// Places in the machine file with their values, which are combined.
    pub places: Vec<Place>,
    /// Whether the area is estimated by Yosys: some seconds per combination.
    pub area: bool,
    /// Whether the highest clock is estimated by place and route: minutes per combination.
    pub clock: bool,
}

/// A place in the machine file, and the values that it takes.
#[derive(Debug, Clone)]
pub struct Place {
    path: String,
    values: Vec<toml_edit::Value>,
}

/// Parses a place and its values, as in `axis.x.shaper.kind=zv,zvd`.
///
/// # Errors
/// Returns the required form for any other text.
pub fn place(text: &str) -> Result<Place, String> {
    let (path, values) = text
        .split_once('=')
        .filter(|(path, values)| !path.trim().is_empty() && !values.trim().is_empty())
        .ok_or("a place and its values are needed, as in axis.x.shaper.kind=zv,zvd")?;
    let values = match format!("all = [{values}]").parse::<DocumentMut>() {
        Ok(document) => {
            let all = document.get("all").and_then(Item::as_array).cloned();
            all.unwrap_or_else(Array::new).into_iter().collect()
        }
        // Words need no quotes.
        Err(_) => values.split(',').map(word).collect(),
    };
    Ok(Place {
        path: path.trim().to_owned(),
        values,
    })
}

fn word(text: &str) -> toml_edit::Value {
    let text = text.trim();
    text.parse().unwrap_or_else(|_| toml_edit::Value::from(text))
}

struct Sweep<'a> {
    path: &'a Path,
    document: DocumentMut,
    machine: MachineFileHash,
    places: &'a [Place],
    yosys: Option<Yosys>,
    router: Option<PlaceAndRoute>,
    observer: &'a dyn Observer,
}

pub(super) fn of<'a>(options: &'a SweepOptions, observer: &'a dyn Observer) -> Result<impl Units + use<'a>, Failure> {
    let file = machine::read(&options.machine)?;
    let beside = file.beside.iter().map(|(_, text)| text.as_bytes());
    let (yosys, router) = if options.area || options.clock {
        synth::tools(options.clock).map(|(yosys, router)| (Some(yosys), router))?
    } else {
        (None, None)
    };
    let sweep = Sweep {
        path: &options.machine,
        document: file
            .text
            .parse()
            .map_err(|error: toml_edit::TomlError| Failure::because(error).in_file(&options.machine))?,
        machine: MachineFileHash {
            name: file.machine.name.clone(),
            sha256: hash_of(std::iter::once(file.text.as_bytes()).chain(beside)),
        },
        places: &options.places,
        yosys,
        router,
        observer,
    };
    // Finds a misspelt place before anything long begins.
    sweep.text(0)?;
    Ok(sweep)
}

impl Sweep<'_> {
    /// Values of a combination; the last place varies fastest.
    fn values(&self, unit: u64) -> Vec<(&str, &toml_edit::Value)> {
        let mut rest = unit;
        let mut values: Vec<_> = self
            .places
            .iter()
            .rev()
            .map(|place| {
                let count = place.values.len() as u64;
                let value = &place.values[(rest % count) as usize];
                rest /= count;
                (place.path.as_str(), value)
            })
            .collect();
        values.reverse();
        values
    }

    /// The machine file of a combination.
    fn text(&self, unit: u64) -> Result<String, Failure> {
        let mut document = self.document.clone();
        for (path, value) in self.values(unit) {
            set(document.as_item_mut(), path, value).map_err(|what| {
                let found = Failure::input(format!("--set {path}: {what} in `{}`", self.path.display()));
                found.with_help(
                    "write the tables' names with points between them; an axis by its name, a mode by its number from 1",
                )
            })?;
        }
        Ok(document.to_string())
    }

    fn figures(&self, machine: &Machine) -> Result<Map<String, Value>, Failure> {
        let report = DesignReport::new(machine, self.path)?;
        let mut figures = Map::new();
        for (axis, tables) in machine.axes.iter().zip(&report.design.axes) {
            figures.extend(axis_figures(axis, tables, report.design.sample_hz));
        }
        let Some(yosys) = &self.yosys else {
            return Ok(figures);
        };
        let modules = Built::new(&report, self.path, self.observer)?.modules(self.path)?;
        let (files, _folder) = verilog::write_scratch(&modules)?;
        let area = yosys
            .estimate(&files, &machine.name, machine::family(machine)?)
            .map_err(synth::failure)?
            .total;
        let counts = [
            ("cells", area.cells),
            ("registers", area.registers),
            ("memory bits", area.memory_bits),
            ("multipliers", area.multipliers),
        ];
        figures.extend(counts.map(|(name, count)| (name.to_owned(), Value::from(count))));
        if let Some(router) = &self.router {
            let mhz = router
                .highest_mhz(yosys, &files, &machine.name)
                .map_err(clock_failure)?;
            figures.insert("clock, MHz".to_owned(), number(mhz));
        }
        Ok(figures)
    }
}

impl Units for Sweep<'_> {
    fn kind(&self) -> &'static str {
        "sweep"
    }

    fn machine(&self) -> Option<MachineFileHash> {
        Some(self.machine.clone())
    }

    fn options(&self) -> Map<String, Value> {
        let places = self.places.iter().map(|place| {
            let values = place.values.iter().map(|value| Value::from(shown(value)));
            (place.path.clone(), Value::Array(values.collect()))
        });
        let mut options: Map<String, Value> = places.collect();
        options.insert("area".to_owned(), Value::from(self.yosys.is_some()));
        options.insert("clock".to_owned(), Value::from(self.router.is_some()));
        options
    }

    fn count(&self) -> u64 {
        let counts = self.places.iter().map(|place| place.values.len() as u64);
        counts.fold(1, u64::saturating_mul)
    }

    fn name(&self, unit: u64) -> String {
        let values = self.values(unit).into_iter();
        let named = values.map(|(path, value)| format!("{path}={}", shown(value)));
        named.collect::<Vec<_>>().join(" ")
    }

    fn run(&self, unit: u64, _seed: u64) -> Result<UnitOutcome, Failure> {
        let text = self.text(unit)?;
        let figures = match machine::parse(self.path, &text).and_then(|machine| self.figures(&machine)) {
            Err(Failure::Input(problem)) => Map::from_iter([(REFUSED.to_owned(), Value::from(problem.message))]),
            other => other?,
        };
        Ok(UnitOutcome { figures, failure: None })
    }
}

/// Figures of an axis; the name of each begins with that of the axis.
fn axis_figures(axis: &AxisSection, tables: &AxisTables, sample_hz: f64) -> [(String, Value); 4] {
    let modes = tables.mode_figures(axis, sample_hz);
    let worst = modes.iter().map(|mode| mode.residual_quantised).fold(0.0, f64::max);
    let named = |what: &str| format!("{} {what}", axis.name);
    [
        (named("duration, ms"), number(1e3 * tables.design.impulses.duration_s())),
        (named("delay, ms"), number(1e3 * tables.design.impulses.delay_s())),
        (named("taps"), Value::from(tables.table.taps().len())),
        (named("residual, %"), number(100.0 * worst)),
    ]
}

/// A number rounded to the digits that a reader can use.
fn number(value: f64) -> Value {
    let rounded = format!("{value:.4e}").parse().unwrap_or(value);
    Number::from_f64(rounded).map_or(Value::Null, Value::Number)
}

fn shown(value: &toml_edit::Value) -> String {
    match value.as_str() {
        Some(text) => text.to_owned(),
        None => value.to_string().trim().to_owned(),
    }
}

/// Sets the value at a path below an item; the error names the missing step of the path.
fn set(item: &mut Item, path: &str, value: &toml_edit::Value) -> Result<(), String> {
    let (step, rest) = path
        .split_once('.')
        .map_or((path, None), |(step, rest)| (step, Some(rest)));
    let next = match item {
        Item::ArrayOfTables(tables) => {
            let is_named = |table: &toml_edit::Table| table.get("name").and_then(Item::as_str) == Some(step);
            let named = tables.iter().position(is_named);
            let numbered = step.parse::<usize>().ok().and_then(|number| number.checked_sub(1));
            let table = named.or(numbered).and_then(|place| tables.get_mut(place));
            let table = table.ok_or_else(|| format!("there is no `{step}`"))?;
            return match rest {
                None => Err(format!("`{step}` is a table, not a value")),
                Some(rest) => set_in(table, rest, value),
            };
        }
        Item::Table(table) => return set_in(table, path, value),
        other => other,
    };
    match (next.as_inline_table_mut(), rest) {
        (Some(table), None) => {
            table.insert(step, value.clone());
            Ok(())
        }
        _ => Err(format!("there is no table with `{step}`")),
    }
}

fn set_in(table: &mut toml_edit::Table, path: &str, value: &toml_edit::Value) -> Result<(), String> {
    match path.split_once('.') {
        None => {
            table.insert(path, Item::Value(value.clone()));
            Ok(())
        }
        Some((step, rest)) => {
            let item = table.get_mut(step).ok_or_else(|| format!("there is no `{step}`"))?;
            set(item, rest, value)
        }
    }
}

fn clock_failure(error: ClockError) -> Failure {
    match error {
        ClockError::Missing(_) => Failure::missing_tool(error),
        ClockError::Yosys(error) => synth::failure(error),
        other => Failure::because(other),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "name = \"m\"\n[clock]\nsample_hz = 1000\n[[axis]]\nname = \"x\"\nlimits = { velocity = 1 }\n\
                        [axis.shaper]\nkind = \"zv\"\n[[axis.mode]]\ndamping = 0.1\n[[axis.mode]]\ndamping = 0.2\n";

    fn put(path: &str) -> Result<String, String> {
        let mut document: DocumentMut = TEXT.parse().unwrap();
        set(document.as_item_mut(), path, &toml_edit::Value::from(7)).map(|()| document.to_string())
    }

    #[test]
    fn a_value_is_set_only_at_its_place() {
        for (path, old, new) in [
            ("clock.sample_hz", "sample_hz = 1000", "sample_hz = 7"),
            ("axis.x.shaper.kind", "kind = \"zv\"", "kind = 7"),
            ("axis.1.shaper.kind", "kind = \"zv\"", "kind = 7"),
            ("axis.x.mode.2.damping", "damping = 0.2", "damping = 7"),
            ("axis.x.limits.velocity", "velocity = 1", "velocity = 7"),
        ] {
            let squeezed = |text: &str| text.replace(' ', "");
            assert_eq!(
                squeezed(&put(path).unwrap()),
                squeezed(&TEXT.replace(old, new)),
                "{path}"
            );
        }
    }

    #[test]
    fn the_error_names_a_missing_step_of_a_path() {
        for (path, what) in [
            ("axis.z.shaper.kind", "there is no `z`"),
            ("axis.x.mode.3.damping", "there is no `3`"),
            ("axis.x.mode.0.damping", "there is no `0`"),
            ("clok.sample_hz", "there is no `clok`"),
            ("axis.x", "`x` is a table, not a value"),
            ("clock.sample_hz.more", "there is no table with `more`"),
        ] {
            assert_eq!(put(path), Err(what.to_owned()), "{path}");
        }
    }

    #[test]
    fn values_are_numbers_words_or_lists() {
        let shown_of = |text: &str| place(text).unwrap().values.iter().map(shown).collect::<Vec<_>>();
        assert_eq!(shown_of("a=zv,zvd"), ["zv", "zvd"]);
        assert_eq!(shown_of("a=1000,2e3"), ["1000", "2e3"]);
        assert_eq!(shown_of("a=\"positive\",[-1, 1]"), ["positive", "[-1, 1]"]);
        for wrong in ["a", "=1", "a=", ""] {
            assert!(place(wrong).is_err(), "{wrong}");
        }
    }
}
