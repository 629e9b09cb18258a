//! `posicast synth --clock TOP`.

use crate::failure::Failure;
use crate::observer::Observer;
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
pub struct ClockEstimate {
    /// Name of the top.
    pub name: String,
    /// The frequency.
    pub mhz: f64,
}

/// `clocks` of `synth --json`.
#[derive(Serialize, JsonSchema)]
pub struct ClockEstimates {
    /// The tops, in the order of the request.
    pub tops: Vec<ClockEstimate>,
    /// Tools, device and what the figures are worth.
    pub method: String,
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

pub(super) fn failure(error: ClockError) -> Failure {
    match error {
        ClockError::Missing(_) | ClockError::Yosys(YosysError::Missing(_)) => Failure::missing_tool(error),
        other => Failure::because(other),
    }
}
