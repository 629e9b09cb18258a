//! Indices of a shaper's ports among the ports of the simulated block.

use posicast_blocks::{Direction, Port};

use crate::Error;

/// An input that every shaper has once.
const OF_EVERY_AXIS: &str = "clear_flags";

/// The ports of one shaper: indices among the inputs and the outputs, and the widths that stimuli depend on.
#[derive(Debug, Clone, PartialEq, Eq)]
#[allow(missing_docs)] // places, named after the ports
pub struct AxisLayout {
    /// Name of the axis; empty for a shaper that stands alone.
    pub name: String,
    pub start: usize,
    /// Index of the command word. For a motion shaper this is the word of channel 0; those of the others follow.
    pub x: usize,
    /// Number of channels, each with its own word.
    pub channels: usize,
    pub clear_flags: usize,
    /// Width of a command word in bits.
    pub word_bits: u32,
    pub valid: usize,
    pub busy: usize,
    pub overrun: usize,
    /// The ports for its tables; a cascade has none.
    pub tables: Option<TableLayout>,
}

/// The ports of one shaper that belong to its tables of taps, as in [`AxisLayout`].
#[derive(Debug, Clone, PartialEq, Eq)]
#[allow(missing_docs)] // places, named after the ports
pub struct TableLayout {
    /// Number of fraction bits `F` of the tables that are loaded.
    pub coefficient_fraction: u32,
    pub tap_write: usize,
    pub tap_bank: usize,
    pub tap_index: usize,
    pub tap_coefficient: usize,
    pub tap_delay: usize,
    pub tap_read: usize,
    pub swap: usize,
    pub swap_bank: usize,
    /// Index of the port; only a motion shaper has it.
    pub swap_how: Option<usize>,
    /// Width of a tap's index in bits.
    pub tap_index_bits: u32,
    /// Width of a tap's delay in bits.
    pub ring_address_bits: u32,
    pub saturated: usize,
    pub swap_pending: usize,
    pub bank: usize,
    pub refused: usize,
    pub loaded_coefficient: usize,
    pub tap_read_waits: usize,
}

impl AxisLayout {
    /// Returns the largest command word; the smallest is `-largest - 1`.
    pub fn largest_word(&self) -> i64 {
        (1 << (self.word_bits.clamp(2, 63) - 1)) - 1
    }
}

/// All shapers of a block or a top module.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Layout {
    /// Index of `rst` among the inputs.
    pub rst: usize,
    /// Index of `strobe` among the inputs.
    pub strobe: usize,
    /// The shapers, in the order of the ports.
    pub axes: Vec<AxisLayout>,
    /// Number of inputs.
    pub inputs: usize,
}

impl Layout {
    /// Finds the shapers. `coefficient_fraction` is the machine's `F`, 1..=16.
    ///
    /// # Errors
    /// [`Error::Unlike`] names the port that a shaper lacks.
    pub fn new(ports: &[Port], coefficient_fraction: u32) -> Result<Self, Error> {
        let inputs: Vec<&Port> = ports.iter().filter(|p| p.direction == Direction::Input).collect();
        let outputs: Vec<&Port> = ports.iter().filter(|p| p.direction == Direction::Output).collect();
        let place = |list: &[&Port], name: String| {
            let at = list.iter().position(|p| p.name == name);
            at.ok_or_else(|| Error::Unlike(format!("no shaper: the port `{name}` is missing")))
        };
        let prefixes = inputs.iter().filter_map(|p| p.name.strip_suffix(OF_EVERY_AXIS));
        let axes = prefixes.map(|prefix| {
            let input = |name: &str| place(&inputs, format!("{prefix}{name}"));
            let output = |name: &str| place(&outputs, format!("{prefix}{name}"));
            let x = input("x").or_else(|_| input("x_0"))?;
            let channels = (1..3).take_while(|channel| input(&format!("x_{channel}")).is_ok());
            let tables = || {
                let (tap_index, tap_delay) = (input("tap_index")?, input("tap_delay")?);
                Ok::<_, Error>(TableLayout {
                    coefficient_fraction: coefficient_fraction.clamp(1, 16),
                    tap_write: input("tap_write")?,
                    tap_bank: input("tap_bank")?,
                    tap_index,
                    tap_coefficient: input("tap_coefficient")?,
                    tap_delay,
                    tap_read: input("tap_read")?,
                    swap: input("swap")?,
                    swap_bank: input("swap_bank")?,
                    swap_how: input("swap_how").ok(),
                    tap_index_bits: inputs[tap_index].width,
                    ring_address_bits: inputs[tap_delay].width,
                    saturated: output("saturated")?,
                    swap_pending: output("swap_pending")?,
                    bank: output("bank")?,
                    refused: output("refused")?,
                    loaded_coefficient: output("loaded_coefficient")?,
                    tap_read_waits: output("tap_read_waits")?,
                })
            };
            let has_tables = input("tap_coefficient").is_ok();
            Ok(AxisLayout {
                name: prefix.trim_end_matches('_').to_owned(),
                start: input("start")?,
                x,
                channels: 1 + channels.count(),
                clear_flags: input(OF_EVERY_AXIS)?,
                word_bits: inputs[x].width,
                valid: output("valid")?,
                busy: output("busy")?,
                overrun: output("overrun")?,
                tables: has_tables.then(tables).transpose()?,
            })
        });
        let axes = axes.collect::<Result<Vec<_>, Error>>()?;
        if axes.is_empty() {
            return Err(Error::Unlike(format!("no shaper: there is no port `{OF_EVERY_AXIS}`")));
        }
        Ok(Self {
            rst: place(&inputs, "rst".to_owned())?,
            strobe: place(&inputs, "strobe".to_owned())?,
            axes,
            inputs: inputs.len(),
        })
    }
}
