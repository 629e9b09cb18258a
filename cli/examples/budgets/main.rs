//! Measures the area of every block in a Cyclone II against the budgets of the hardware's specification.
//!
//! ```text
//! cargo run --release -p posicast --example budgets              measure, compare with docs/area.md
//! cargo run --release -p posicast --example budgets -- --write   measure, write docs/area.md
//! ```
//!
//! Exit status 1: a figure is larger than the one in `docs/area.md`, or a row is missing there. So area cannot grow
//! unnoticed; where growth is intended, `--write` makes it part of the change. Smaller figures pass. Needs Yosys.
//!
//! The page has a checksum of each row's Verilog. A row of the same Verilog keeps its figures and is not measured; `--again`,
//! alone or with `--write`, measures all rows, which takes some minutes.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "its purpose")]

mod table;

use posicast_hdl::emit::Module;
use posicast_synth::yosys::{Family, Mapping, Resources, Yosys};
use posicast_system::cores;
use posicast_testbench::blocks::{AreaRow, areas};
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Figures of a row.
struct Measured<'a> {
    row: &'a AreaRow,
    /// Checksum of its Verilog.
    checksum: String,
    resources: Resources,
    /// LUTs as Yosys maps alone, without carry chain and synchronous clear. `None` for the whole stage, where it takes
    /// minutes, and where the page is not written, because the figure is for readers and not compared.
    luts_by_yosys: Option<u64>,
}

type Failure = Box<dyn Error + Send + Sync>;

fn main() -> Result<ExitCode, Failure> {
    let options: Vec<String> = std::env::args().skip(1).collect();
    if let Some(other) = options
        .iter()
        .find(|option| !["--write", "--again"].contains(&option.as_str()))
    {
        return Err(format!("{other} is not an option: there are --write and --again").into());
    }
    let has = |option: &str| options.iter().any(|given| given == option);
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/area.md");
    let written = table::Written::of(&std::fs::read_to_string(&path)?);
    let yosys = Yosys::installed()?;
    let rows = areas()?;
    let count = rows.len();
    let is_known = |row: &AreaRow| !has("--again") && written.is_of(row);
    let (known, changed): (Vec<_>, Vec<_>) = rows.into_iter().enumerate().partition(|(_, row)| is_known(row));
    eprintln!(
        "{} of {count} rows are of the Verilog in docs/area.md; {} are measured",
        known.len(),
        changed.len()
    );
    let one = |row| measure(&yosys, row, has("--write"));
    let measured = cores::each(&changed, |(at, row)| one(row).map(|measured| (*at, measured)), |_| ())?;
    if has("--write") {
        let mut lines: Vec<_> = known
            .iter()
            .filter_map(|(at, row)| Some((*at, written.line(row)?)))
            .collect();
        lines.extend(measured.iter().map(|(at, one)| (*at, table::line(one))));
        lines.sort();
        std::fs::write(&path, table::page(yosys.version(), &lines))?;
        return Ok(ExitCode::SUCCESS);
    }
    let mut grown = Vec::new();
    for (_, one) in &measured {
        println!("{}", table::line(one));
        grown.extend(written.grown(one));
    }
    for line in &grown {
        eprintln!("{line}");
    }
    if grown.is_empty() {
        return Ok(ExitCode::SUCCESS);
    }
    eprintln!("If that is meant: cargo run --release -p posicast --example budgets -- --write");
    Ok(ExitCode::FAILURE)
}

fn measure<'a>(yosys: &Yosys, row: &'a AreaRow, write: bool) -> Result<Measured<'a>, Failure> {
    let folder = tempfile::tempdir()?;
    let written = |module: &Module| {
        let path = folder.path().join(format!("{}.v", module.name));
        std::fs::write(&path, &module.text).map(|()| path)
    };
    let files: Vec<PathBuf> = row.modules.iter().map(written).collect::<Result<_, _>>()?;
    let estimate = |mapping| {
        let (top, ports) = row
            .modules
            .last()
            .map_or(("", &[][..]), |top| (top.name.as_str(), &top.ports[..]));
        let yosys = yosys.clone().with_mapping(mapping);
        yosys.estimate_alone(&files, top, ports, Family::Cyclone2)
    };
    let by_yosys = (write && row.block != table::STAGE).then(|| estimate(Mapping::Luts));
    Ok(Measured {
        checksum: table::checksum(row),
        resources: estimate(Mapping::LogicElement)?.total,
        luts_by_yosys: by_yosys.transpose()?.map(|estimate| estimate.total.luts),
        row,
    })
}
