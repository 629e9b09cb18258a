//! The machine at a board's oscillator.

use crate::failure::Failure;
use crate::machine::{self, MachineFile, at_key};
use posicast_bitstream::boards::{BOARDS, FpgaBoard};
use posicast_machine::machine_file::{AxisSection, Machine};
use std::path::Path;
use toml_edit::{DocumentMut, Value};

/// The key of the sample rate.
const SAMPLE_KEY: &str = "clock.sample_hz";
/// Usual oscillators of boards, in MHz.
const OSCILLATORS_MHZ: [u32; 9] = [12, 16, 24, 25, 26, 27, 48, 50, 100];

/// Reads the machine file at `path` with the board's oscillator as its clock.
pub(super) fn on_board(path: &Path, board: &FpgaBoard) -> Result<MachineFile, Failure> {
    let file = machine::read(path)?;
    whole_or_only_shapers(&file.machine, path, board)?;
    sample_rate(&file.machine, path, board)?;
    let text = with_clock(&file.text, board.oscillator_hz).map_err(Failure::because)?;
    // Files that it names are read beside it.
    let machine = machine::parse(path, &text)?;
    Ok(MachineFile {
        text,
        machine,
        beside: file.beside,
    })
}

/// A machine with loops becomes a stage with its line, on a board that is large enough.
fn whole_or_only_shapers(machine: &Machine, path: &Path, board: &FpgaBoard) -> Result<(), Failure> {
    let loops = |axis: &AxisSection| match (&axis.encoder, &axis.pwm) {
        (Some(_), _) => Some("axis.encoder"),
        (None, Some(_)) => Some("axis.pwm"),
        (None, None) => axis.has_loop().then_some("axis.controller"),
    };
    let mut axes = machine.axes.iter().enumerate();
    let Some((index, key)) = axes.find_map(|(index, axis)| loops(axis).map(|key| (index, key))) else {
        return Ok(());
    };
    let name = &machine.axes[index].name;
    if board.header.is_empty() {
        let reason = format!(
            "axis {name} has more than a shaper, and a stage does not fit {}",
            board.name
        );
        let help = format!(
            "choose a board for a stage: {}; or leave out the other blocks",
            boards_with_headers()
        );
        return Err(at_key(path, index, key, reason).or_help(&help));
    }
    if machine.link.is_none() {
        let reason = format!(
            "axis {name} has more than a shaper, and a stage alone on a board needs a line to its host; there is no [link]"
        );
        return Err(at_key(path, index, key, reason).or_help("add `[link]` with `baud = 1_000_000`"));
    }
    Ok(())
}

fn boards_with_headers() -> String {
    let boards = BOARDS.iter().filter(|board| !board.header.is_empty());
    boards.map(|board| board.name).collect::<Vec<_>>().join(", ")
}

/// The sample rate divides the oscillator, or the error names what would.
fn sample_rate(machine: &Machine, path: &Path, board: &FpgaBoard) -> Result<(), Failure> {
    let sample_hz = machine.clock.sample_hz;
    let divides = |oscillator: u32| f64::from(oscillator) % sample_hz == 0.0;
    if divides(board.oscillator_hz) {
        return Ok(());
    }
    let oscillators: Vec<String> = OSCILLATORS_MHZ
        .into_iter()
        .filter(|mhz| divides(mhz * 1_000_000))
        .map(|mhz| mhz.to_string())
        .collect();
    let works = match oscillators.as_slice() {
        [] => "no usual oscillator".to_owned(),
        some => format!("a board with {} MHz", some.join(", ")),
    };
    let [below, above] = nearest_rates(board.oscillator_hz, sample_hz);
    let reason = format!(
        "{sample_hz} Hz does not divide the oscillator of {}, {} Hz; the nearest that do: {below} Hz and {above} Hz; with {sample_hz} Hz \
         works {works}",
        board.name, board.oscillator_hz
    );
    Err(at_key(path, 0, SAMPLE_KEY, reason))
}

/// The nearest whole rates below and above that divide the oscillator.
fn nearest_rates(oscillator_hz: u32, sample_hz: f64) -> [u32; 2] {
    let divides = |rate: &u32| oscillator_hz.is_multiple_of(*rate);
    let floor = (sample_hz.floor() as u32).clamp(1, oscillator_hz);
    let below = (1..=floor).rev().find(divides).unwrap_or(1);
    let above = (floor + 1..=oscillator_hz).find(divides).unwrap_or(oscillator_hz);
    [below, above]
}

/// The text of the machine file with this clock, and without the board of its `[target]`.
fn with_clock(text: &str, frequency_hz: u32) -> Result<String, toml_edit::TomlError> {
    let mut document: DocumentMut = text.parse()?;
    if let Some(value) = document["clock"]["frequency_hz"].as_value_mut() {
        let decor = value.decor().clone();
        *value = Value::from(i64::from(frequency_hz));
        *value.decor_mut() = decor;
    }
    if let Some(target) = document.get_mut("target").and_then(toml_edit::Item::as_table_like_mut) {
        target.remove("board");
    }
    Ok(document.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_clock_changes_and_its_comment_stays() {
        let text = "# a machine\n[clock]\nfrequency_hz = 50_000_000   # fabric\nsample_hz = 10_000\n";
        let changed = with_clock(text, 12_000_000).unwrap();
        assert_eq!(changed, text.replace("50_000_000", "12000000"));
    }

    #[test]
    fn the_nearest_rates_divide_the_oscillator() {
        assert_eq!(nearest_rates(12_000_000, 7_000.0), [6_400, 7_500]);
        assert_eq!(nearest_rates(12_000_000, 0.5), [1, 2]);
        assert_eq!(nearest_rates(12_000_000, 1e9), [12_000_000, 12_000_000]);
    }
}
