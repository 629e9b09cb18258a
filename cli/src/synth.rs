//! `posicast synth`: estimates the resources that a machine's Verilog takes of a device.

mod clock;

use self::clock::{ClockEstimates, Clocks};

use crate::design::DesignReport;
use crate::failure::Failure;
use crate::hardware::{Built, COMPONENT_SUFFIX, LINK_SUFFIX, STAGE_SUFFIX};
use crate::output::{self, Table};
use crate::{machine, progress, verilog};
use posicast_machine::machine_file::Machine;
use posicast_synth::clock::{ClockError, PlaceAndRoute};
use posicast_synth::package;
use posicast_synth::yosys::{BlockEstimate, Estimate, Excess, Family, Resources, Yosys, YosysError};
use posicast_system::scratch::Folder;
use serde::Serialize;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Logic cells, registers, memory and multipliers of the machine's Verilog
#[derive(clap::Args)]
#[command(after_help = "Example:\n  posicast synth examples/xy-stage.toml --family cyclone5")]
pub(crate) struct Args {
    /// Machine file, or a folder that `generate` or `run` wrote
    source: PathBuf,
    /// Device family: cyclone2, cyclone4e, cyclone10lp, cyclone5, max10 [default: the machine file's, else cyclone5]
    #[arg(long)]
    family: Option<Family>,
    /// Clock estimate of this top module, by place and route on an open family as a proxy: minutes for a stage; may be given
    /// several times
    #[arg(long, value_name = "TOP")]
    clock: Vec<String>,
    /// Print one JSON document on standard output
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let (machine, files, _scratch) = sources(&args.source)?;
    let family = match args.family {
        Some(family) => family,
        None => machine::family(&machine)?,
    };
    let names = self::components(&files, &machine.name);
    Clocks::check(&args.clock, &machine.name, &names)?;
    let (yosys, router) = tools(!args.clock.is_empty())?;
    let clocks = router.map(|tool| Clocks::new(tool, &args.clock));
    let spinner = progress::spinner("Yosys maps the design");
    let mut estimate = yosys.estimate(&files, &machine.name, family).map_err(failure)?;
    spinner.finish_and_clear();
    let mut lacks = lacks(&estimate);
    let mut components = Vec::new();
    for name in names {
        let spinner = progress::spinner(&format!("Yosys maps {name}"));
        let estimate = yosys.estimate(&files, &name, family).map_err(failure)?;
        spinner.finish_and_clear();
        lacks.extend(self::lacks(&estimate));
        components.push(BlockEstimate {
            name,
            resources: estimate.total,
        });
    }
    let clocks = clocks.map(|clocks| clocks.estimate(&yosys, &files)).transpose()?;
    let of_top = clocks.iter().flat_map(|clocks| &clocks.tops);
    let of_top = of_top.filter(|clock| clock.name == machine.name);
    estimate.clock_mhz_estimate = of_top.map(|clock| clock.mhz).next();
    let document = Document {
        estimate: &estimate,
        components: &components,
        clocks: clocks.as_ref(),
    };
    if args.json {
        output::print_json(&document)?
    } else {
        output::print(
            &(text(&estimate) + &components_text(&components) + &clocks.map_or_else(String::new, |c| c.text())),
        )?
    }
    if lacks.is_empty() {
        return Ok(());
    }
    Err(Failure::Check(format!("does not fit the device: {}", lacks.join("; "))))
}

/// Resources of which the device has too little for this top, and by how much.
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

/// `synth --json`: the estimate of the top, and of each component, which is not included in a sum.
#[derive(Serialize)]
struct Document<'a> {
    #[serde(flatten)]
    estimate: &'a Estimate,
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    components: &'a [BlockEstimate],
    #[serde(skip_serializing_if = "Option::is_none")]
    clocks: Option<&'a ClockEstimates>,
}

/// The top modules of the components among these files: the stage, alone and with its line to a host, and the blocks that stand alone.
fn components(files: &[PathBuf], machine: &str) -> Vec<String> {
    let stages = [STAGE_SUFFIX, LINK_SUFFIX].map(|suffix| format!("{machine}{suffix}"));
    let stems = files.iter().filter_map(|file| file.file_stem()?.to_str());
    let mut names: Vec<String> = stems
        .filter(|name| name.ends_with(COMPONENT_SUFFIX) || stages.iter().any(|stage| name == stage))
        .map(str::to_owned)
        .collect();
    names.sort_unstable();
    names
}

fn components_text(components: &[BlockEstimate]) -> String {
    if components.is_empty() {
        return String::new();
    }
    let mut table = Table::new(&["component", ">cells", ">registers", ">memory bits", ">multipliers"]);
    for component in components {
        table.row(cells(&component.name, &component.resources));
    }
    format!("\nBeside the top, each by itself:\n{}", table.text(""))
}

fn cells(name: &str, r: &Resources) -> impl Iterator<Item = String> {
    let numbers = [r.cells, r.registers, r.memory_bits, r.multipliers].map(|n| n.to_string());
    std::iter::once(name.to_owned()).chain(numbers)
}

/// The machine, its Verilog files, and the guard of their folder if that is temporary.
fn sources(source: &Path) -> Result<(Machine, Vec<PathBuf>, Option<Folder>), Failure> {
    if source.is_dir() {
        let contents = package::read(source).map_err(Failure::because)?;
        let machine = machine::parse(&contents.machine_path, &contents.machine_toml)?;
        return Ok((machine, contents.rtl, None));
    }
    let machine = machine::read(source)?.machine;
    let report = DesignReport::new(&machine, source)?;
    let modules = Built::new(&report, source)?.modules(source)?;
    let (files, scratch) = verilog::write_scratch(&modules)?;
    Ok((machine, files, Some(scratch)))
}

/// A table of blocks with the device's capacity, and the method of the estimate.
pub(crate) fn text(estimate: &Estimate) -> String {
    let mut table = Table::new(&["block", ">cells", ">registers", ">memory bits", ">multipliers"]);
    let mut row = |name: &str, r: &Resources| table.row(cells(name, r));
    for block in &estimate.blocks {
        row(&block.name, &block.resources);
    }
    row("total", &estimate.total);
    let device = &estimate.device;
    let capacity = Resources {
        cells: device.cells,
        registers: device.registers,
        memory_bits: device.memory_bits,
        multipliers: device.multipliers,
        ..Resources::default()
    };
    row(device.name, &capacity);
    let mut text = table.text("");
    let _ = writeln!(text, "Estimate by {}: {}", estimate.method.tool, estimate.method.note);
    text
}

/// Yosys, and what places and routes if a clock is asked for; where both are missing, both are named.
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
    use posicast_synth::yosys::EstimateMethod;

    #[test]
    fn what_is_lacking_says_by_how_much_and_where() {
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
