//! Measures the area of every block in a Cyclone II against the budgets of the hardware's specification.
//!
//! ```text
//! cargo run --release -p posicast --example budgets              measure, compare with docs/area.md
//! cargo run --release -p posicast --example budgets -- --write   measure, write docs/area.md
//! ```
//!
//! Exit status 1: a figure is larger than the one in `docs/area.md`, or a row is missing there. So area cannot grow
//! unnoticed; where growth is intended, `--write` makes it part of the change. Smaller figures pass. Needs Yosys;
//! takes some seconds.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "its purpose")]

mod table;

use posicast_hdl::emit::Module;
use posicast_synth::yosys::{Family, Mapping, Resources, Yosys};
use posicast_testbench::blocks::{AreaRow, areas};
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Figures of a row.
struct Measured {
    row: AreaRow,
    resources: Resources,
    /// LUTs as Yosys maps alone, without carry chain and synchronous clear; `None` for the whole stage, where it
    /// takes minutes.
    luts_by_yosys: Option<u64>,
}

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let write = match std::env::args().skip(1).collect::<Vec<_>>().as_slice() {
        [] => false,
        [option] if option == "--write" => true,
        _ => return Err("the only option is --write".into()),
    };
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/area.md");
    let yosys = Yosys::installed()?;
    let measured: Result<Vec<_>, _> = areas()?.into_iter().map(|row| measure(&yosys, row)).collect();
    let page = table::page(yosys.version(), &measured?);
    print!("{page}");
    if write {
        std::fs::write(&path, page)?;
        return Ok(ExitCode::SUCCESS);
    }
    let grown = table::grown(&std::fs::read_to_string(&path)?, &page);
    for line in &grown {
        eprintln!("{line}");
    }
    if grown.is_empty() {
        return Ok(ExitCode::SUCCESS);
    }
    eprintln!("If that is meant: cargo run --release -p posicast --example budgets -- --write");
    Ok(ExitCode::FAILURE)
}

fn measure(yosys: &Yosys, row: AreaRow) -> Result<Measured, Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let write = |module: &Module| {
        let path = folder.path().join(format!("{}.v", module.name));
        std::fs::write(&path, &module.text).map(|()| path)
    };
    let files: Vec<PathBuf> = row.modules.iter().map(write).collect::<Result<_, _>>()?;
    let estimate = |mapping| {
        let (top, ports) = row
            .modules
            .last()
            .map_or(("", &[][..]), |top| (top.name.as_str(), &top.ports[..]));
        let yosys = yosys.clone().with_mapping(mapping);
        yosys.estimate_alone(&files, top, ports, Family::Cyclone2)
    };
    let by_yosys = (row.block != table::STAGE).then(|| estimate(Mapping::Luts));
    Ok(Measured {
        resources: estimate(Mapping::LogicElement)?.total,
        luts_by_yosys: by_yosys.transpose()?.map(|estimate| estimate.total.luts),
        row,
    })
}
