//! `posicast synth --clock TOP`.

use crate::failure::Failure;
use crate::observer::Observer;
use crate::text::Table;
use posicast_synth::clock::{ClockError, PlaceAndRoute};
use posicast_synth::yosys::{Yosys, YosysError};
use schemars::JsonSchema;
use serde::Serialize;
use std::path::PathBuf;

/// The requested tops, and the tools that place and route them.
pub(super) struct Clocks<'a> {
    tool: PlaceAndRoute,
    tops: &'a [String],
}

/// The highest clock frequency of a top.
#[derive(Serialize, JsonSchema)]
pub(super) struct ClockEstimate {
    pub(super) name: String,
    pub(super) mhz: f64,
}

/// `clocks` of `synth --json`.
#[derive(Serialize, JsonSchema)]
pub(super) struct ClockEstimates {
    pub(super) tops: Vec<ClockEstimate>,
    method: String,
}

impl<'a> Clocks<'a> {
    /// Refuses a misspelt top before anything long begins.
    pub(super) fn check(tops: &[String], machine: &str, components: &[String]) -> Result<(), Failure> {
        let known = || std::iter::once(machine).chain(components.iter().map(String::as_str));
        if let Some(unknown) = tops.iter().find(|top| !known().any(|known| known == *top)) {
            let list = known().collect::<Vec<_>>().join(", ");
            return Err(Failure::input(format!(
                "--clock {unknown}: there is no such top module; there are {list}"
            )));
        }
        Ok(())
    }

    /// Estimates of these tops by this tool.
    pub(super) fn new(tool: PlaceAndRoute, tops: &'a [String]) -> Self {
        Self { tool, tops }
    }

    /// Estimates the tops one after the other.
    pub(super) fn estimate(
        &self,
        yosys: &Yosys,
        files: &[PathBuf],
        observer: &dyn Observer,
    ) -> Result<ClockEstimates, Failure> {
        let estimate = |top: &String| {
            let _shown = observer.begin(&format!("nextpnr places and routes {top}"), None);
            let mhz = self.tool.highest_mhz(yosys, files, top).map_err(failure)?;
            let name = top.clone();
            Ok(ClockEstimate { name, mhz })
        };
        Ok(ClockEstimates {
            tops: self.tops.iter().map(estimate).collect::<Result<_, Failure>>()?,
            method: self.tool.method(),
        })
    }
}

impl ClockEstimates {
    /// A table, and the method of the estimate.
    pub(super) fn text(&self) -> String {
        let mut table = Table::new(&["top", ">clock, MHz"]);
        for clock in &self.tops {
            table.row([clock.name.clone(), format!("{:.1}", clock.mhz)]);
        }
        format!("\n{}Clock: {}\n", table.text(""), self.method)
    }
}

pub(super) fn failure(error: ClockError) -> Failure {
    match error {
        ClockError::Missing(_) | ClockError::Yosys(YosysError::Missing(_)) => Failure::missing_tool(error),
        other => Failure::because(other),
    }
}
