//! Finds the clock and the reset among the pairs.

use std::collections::BTreeMap;

use super::matching::{Matched, Pair};
use super::names::{is_low_active, last_part};
use super::options::{DiffOptions, Reset, SamplingEdge};
use crate::WaveError;
use crate::wording::counted;

const CLOCKS: [&str; 2] = ["clk", "clock"];
/// Name of a clock that rises once per sample; it must not be mistaken for the clock of the hardware.
pub const SAMPLE_CLOCK: &str = "sample_clk";
const RESETS: [&str; 4] = ["rst", "reset", "arst", "areset"];

/// Slots of a one-bit pair in both files.
pub(super) type Slots = [u32; 2];

/// The signals that define the samples, and their beginning.
pub(super) struct Clocking {
    pub(super) clock: Option<Slots>,
    /// The reset and its active value.
    pub(super) reset: Option<(Slots, bool)>,
    /// How clock and reset were found, or why not.
    pub(super) notes: Vec<String>,
}

impl Clocking {
    /// Finds them. `fits` tells whether a pair has one bit in both files.
    pub(super) fn find(
        matched: &Matched,
        options: &DiffOptions,
        fits: impl Fn(&Pair) -> bool,
    ) -> Result<Self, WaveError> {
        let mut clocking = Self {
            clock: None,
            reset: None,
            notes: Vec::new(),
        };
        if options.raw {
            clocking.notes.push("compared at every change".to_owned());
            return Ok(clocking);
        }
        if let Some(name) = &options.clock {
            let (slots, name) = named(matched, "--clock", name, &fits)?;
            clocking.sample_at(slots, &name, options);
        } else {
            let mut found = candidates(matched, &fits, |name| CLOCKS.contains(&name));
            if found.is_empty() {
                found = candidates(matched, &fits, |name| name == SAMPLE_CLOCK);
            }
            match found.first_key_value() {
                Some((slots, name)) if found.len() == 1 => clocking.sample_at(*slots, name, options),
                _ => clocking.notes.push(format!(
                    "no clock ({} named clk or clock): compared at every change",
                    counted(found.len() as u64, "candidate")
                )),
            }
        }
        if clocking.clock.is_some() {
            clocking.find_reset(matched, options, &fits)?;
        } else if let Reset::Named { name, .. } = &options.reset {
            return Err(WaveError::Option(format!(
                "--reset {name}: no clock; name it with --clock"
            )));
        }
        Ok(clocking)
    }

    fn sample_at(&mut self, slots: Slots, name: &str, options: &DiffOptions) {
        self.clock = Some(slots);
        let edge = match options.edge {
            SamplingEdge::Rising => "rising",
            SamplingEdge::Falling => "falling",
        };
        self.notes.push(format!("sampled at the {edge} edges of `{name}`"));
    }

    fn find_reset(
        &mut self,
        matched: &Matched,
        options: &DiffOptions,
        fits: &impl Fn(&Pair) -> bool,
    ) -> Result<(), WaveError> {
        let (slots, name, active) = match &options.reset {
            Reset::Ignored => return Ok(()),
            Reset::Named { name, active } => {
                let (slots, name) = named(matched, "--reset", name, fits)?;
                (slots, name, *active)
            }
            Reset::Found => {
                let is_reset = |name: &str| {
                    let plain = name.trim_end_matches("_n").trim_end_matches('n');
                    RESETS.contains(&plain) || RESETS.contains(&name)
                };
                let found = candidates(matched, fits, is_reset);
                let (1, Some((slots, name))) = (found.len(), found.first_key_value()) else {
                    return Ok(());
                };
                (*slots, name.clone(), !is_low_active(name))
            }
        };
        self.reset = Some((slots, active));
        self.notes.push(format!(
            "compared from the release of `{name}` on, which is active {}",
            if active { "high" } else { "low" }
        ));
        Ok(())
    }
}

/// Returns the pairs with such a name, in lower case without scopes. Several names of one signal are one candidate.
fn candidates(
    matched: &Matched,
    fits: &impl Fn(&Pair) -> bool,
    is_name: impl Fn(&str) -> bool,
) -> BTreeMap<Slots, String> {
    let pairs = matched.pairs.iter().filter(|pair| fits(pair));
    let pairs = pairs.filter(|pair| is_name(&last_part(&pair.name).to_ascii_lowercase()));
    slots_of(pairs)
}

fn slots_of<'a>(pairs: impl Iterator<Item = &'a Pair>) -> BTreeMap<Slots, String> {
    let mut slots = BTreeMap::new();
    for pair in pairs {
        if let (Some(a), Some(b)) = (pair.a, pair.b) {
            slots.entry([a, b]).or_insert_with(|| pair.name.clone());
        }
    }
    slots
}

fn named(
    matched: &Matched,
    option: &str,
    name: &str,
    fits: &impl Fn(&Pair) -> bool,
) -> Result<(Slots, String), WaveError> {
    let meant = matched.meant(name)?;
    let pairs = meant.iter().map(|at| &matched.pairs[*at]);
    let found = slots_of(pairs.filter(|pair| fits(pair)));
    if let (1, Some((slots, name))) = (found.len(), found.first_key_value()) {
        return Ok((*slots, name.clone()));
    }
    let names: Vec<&str> = found.values().map(String::as_str).collect();
    Err(WaveError::Option(if meant.is_empty() {
        format!("{option} {name}: the first file has no such signal")
    } else if names.is_empty() {
        format!("{option} {name}: it must be one bit wide in both files, and have a partner in the second")
    } else {
        format!(
            "{option} {name}: it may mean {}; give the full name",
            names.join(" or ")
        )
    }))
}
