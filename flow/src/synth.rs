//! `posicast synth`: estimates the resources that a machine's Verilog needs on a device.

mod clock;

use self::clock::Clocks;
pub use self::clock::{ClockEstimate, ClockEstimates};

use crate::Outcome;
use crate::design::DesignReport;
use crate::failure::Failure;
use crate::hardware::{Built, COMPONENT_SUFFIX, INLINE_SUFFIX, LINK_SUFFIX, STAGE_SUFFIX};
use crate::observer::Observer;
use crate::{machine, verilog};
use posicast_machine::machine_file::Machine;
use posicast_synth::clock::{ClockError, PlaceAndRoute};
use posicast_synth::package;
use posicast_synth::yosys::{BlockEstimate, Estimate, Excess, Family, Yosys, YosysError};
use posicast_system::scratch::Folder;
use schemars::JsonSchema;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Options of an estimate.
#[derive(Debug, Clone)]
pub struct Options {
    /// Machine file, or a folder that [`generate`](crate::generate) or [`run`](crate::run) wrote.
    pub source: PathBuf,
    /// Device family; `None`: the machine file's, else `cyclone5`.
    pub family: Option<Family>,
    /// Top modules whose clock is estimated by place and route on an open family as a proxy, which takes minutes for a stage.
    pub clock: Vec<String>,
}

/// Estimates the logic cells, registers, memory and multipliers of a machine's Verilog.
///
/// # Errors
/// [`Failure`] for files that cannot be read or mapped, and for a missing tool. A device that is too small is not an error but gives
/// [`Outcome::failed`].
pub fn synth(options: &Options, observer: &dyn Observer) -> Result<Outcome<Document>, Failure> {
    let (machine, files, _scratch) = sources(&options.source, observer)?;
    let family = match options.family {
        Some(family) => family,
        None => machine::family(&machine)?,
    };
    let names = self::components(&files, &machine.name);
    Clocks::check(&options.clock, &machine.name, &names)?;
    let (yosys, router) = tools(!options.clock.is_empty())?;
    let clocks = router.map(|tool| Clocks::new(tool, &options.clock));
    let mut estimate = mapped(&yosys, &files, (&machine.name, "the design"), family, observer).map_err(failure)?;
    let mut lacks = lacks(&estimate);
    let mut components = Vec::new();
    for name in names {
        let estimate = mapped(&yosys, &files, (&name, &name), family, observer).map_err(failure)?;
        lacks.extend(self::lacks(&estimate));
        components.push(BlockEstimate {
            name,
            resources: estimate.total,
        });
    }
    let clocks = clocks.map(|clocks| clocks.estimate(&yosys, &files, observer));
    let clocks = clocks.transpose()?;
    let of_top = clocks.iter().flat_map(|clocks| &clocks.tops);
    let of_top = of_top.filter(|clock| clock.name == machine.name);
    estimate.clock_mhz_estimate = of_top.map(|clock| clock.mhz).next();
    let document = Document {
        estimate,
        components,
        clocks,
    };
    let failed = (!lacks.is_empty()).then(|| format!("does not fit the device: {}", lacks.join("; ")));
    Ok(Outcome {
        failed,
        ..Outcome::passed(document)
    })
}

/// Lets Yosys map the top module of this name; the front shows it as `what`.
pub(crate) fn mapped(
    yosys: &Yosys,
    files: &[PathBuf],
    (top, what): (&str, &str),
    family: Family,
    observer: &dyn Observer,
) -> Result<Estimate, YosysError> {
    let _shown = observer.begin(&format!("Yosys maps {what}"), None);
    yosys.estimate(files, top, family)
}

/// Resources of the device that are too few for this top, with the missing amounts.
fn lacks(estimate: &Estimate) -> Vec<String> {
    let lack = |excess: &Excess<'_>| {
        let Excess {
            resource,
            needed,
            available,
            block,
        } = excess;
        let missing = needed - available;
        format!("{needed} {resource} needed, {available} available, {missing} too few; most of it in {block}")
    };
    estimate.excesses().iter().map(lack).collect()
}

/// The estimate of the top, and of each component, which is not included in a sum.
#[derive(Serialize, JsonSchema)]
pub struct Document {
    /// The top module, block by block.
    #[serde(flatten)]
    pub estimate: Estimate,
    /// The stage or the inline shaper, alone and with its line to a host, and the blocks that stand alone.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub components: Vec<BlockEstimate>,
    /// The tops whose clock was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub clocks: Option<ClockEstimates>,
}

/// The top modules of the components among these files: the stage or the inline shaper, alone and with its line to a host, and the blocks
/// that stand alone.
fn components(files: &[PathBuf], machine: &str) -> Vec<String> {
    let stages = [STAGE_SUFFIX, INLINE_SUFFIX, LINK_SUFFIX].map(|suffix| format!("{machine}{suffix}"));
    let stems = files.iter().filter_map(|file| file.file_stem()?.to_str());
    let mut names: Vec<String> = stems
        .filter(|name| name.ends_with(COMPONENT_SUFFIX) || stages.iter().any(|stage| name == stage))
        .map(str::to_owned)
        .collect();
    names.sort_unstable();
    names
}

/// The machine, its Verilog files, and the guard of their folder if that is temporary.
fn sources(source: &Path, observer: &dyn Observer) -> Result<(Machine, Vec<PathBuf>, Option<Folder>), Failure> {
    if source.is_dir() {
        let contents = package::read(source).map_err(Failure::because)?;
        let machine = machine::parse(&contents.machine_path, &contents.machine_toml)?;
        return Ok((machine, contents.rtl, None));
    }
    let machine = machine::read(source)?.machine;
    let report = DesignReport::new(&machine, source)?;
    let modules = Built::new(&report, source, observer)?.modules(source)?;
    let (files, scratch) = verilog::write_scratch(&modules)?;
    Ok((machine, files, Some(scratch)))
}

/// Returns Yosys, and the tools for place and route if a clock is requested; the error names all missing tools.
pub(crate) fn tools(with_clock: bool) -> Result<(Yosys, Option<PlaceAndRoute>), Failure> {
    let (yosys, router) = (
        Yosys::installed(),
        with_clock.then(PlaceAndRoute::installed).transpose(),
    );
    match (yosys, router) {
        (Err(yosys @ YosysError::Missing(_)), Err(router @ ClockError::Missing(_))) => {
            Err(Failure::missing_tool(format!("{yosys}\n{router}")))
        }
        (Err(error), _) => Err(failure(error)),
        (_, Err(error)) => Err(clock::failure(error)),
        (Ok(yosys), Ok(router)) => Ok((yosys, router)),
    }
}

/// Turns an error of Yosys into the failure of a command.
pub(crate) fn failure(error: YosysError) -> Failure {
    match error {
        YosysError::Missing(_) => Failure::missing_tool(error),
        other => Failure::because(other),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use posicast_synth::yosys::{EstimateMethod, Resources};

    #[test]
    fn lacking_resources_are_named_with_their_amounts() {
        let of = |cells| Resources {
            cells,
            ..Resources::default()
        };
        let block = |name: &str, cells| BlockEstimate {
            name: name.to_owned(),
            resources: of(cells),
        };
        let mut estimate = Estimate {
            family: Family::Cyclone2,
            blocks: vec![block("u_x", 9_000), block("u_y", 10_000)],
            total: of(19_000),
            device: Family::Cyclone2.device(),
            clock_mhz_estimate: None,
            method: EstimateMethod {
                tool: String::new(),
                mapped_as: Family::Cyclone2.mapped_as(),
                note: String::new(),
            },
        };
        let words = "19000 cells needed, 18752 available, 248 too few; most of it in u_y";
        assert_eq!(lacks(&estimate), [words]);
        estimate.total = of(18_752);
        assert!(lacks(&estimate).is_empty());
    }
}
