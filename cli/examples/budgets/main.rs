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
use posicast_testbench::blocks::{AreaRow, areas};
use std::error::Error;
use std::iter;
use std::panic::resume_unwind;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Mutex;
use std::thread;

/// Figures of a row.
struct Measured {
    row: AreaRow,
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
    let measured = measure_all(&yosys, changed, has("--write"))?;
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

/// Measures the rows, one per core at a time, and returns them in their order, each with its place in the table.
fn measure_all(yosys: &Yosys, rows: Vec<(usize, AreaRow)>, write: bool) -> Result<Vec<(usize, Measured)>, Failure> {
    let cores = thread::available_parallelism().map_or(1, usize::from);
    let waiting = Mutex::new(rows.into_iter());
    let next = || waiting.lock().map_or(None, |mut rows| rows.next());
    let measure_next = || {
        iter::from_fn(next)
            .map(|(at, row)| Ok((at, measure(yosys, row, write)?)))
            .collect()
    };
    let mut measured: Vec<(usize, Measured)> = thread::scope(|scope| {
        let workers: Vec<_> = (0..cores).map(|_| scope.spawn(measure_next)).collect();
        let results = workers.into_iter().map(|worker| worker.join());
        let rows = results.map(|rows| rows.unwrap_or_else(|panic| resume_unwind(panic)));
        rows.collect::<Result<Vec<Vec<_>>, Failure>>()
    })?
    .into_iter()
    .flatten()
    .collect();
    measured.sort_by_key(|(at, _)| *at);
    Ok(measured)
}

fn measure(yosys: &Yosys, row: AreaRow, write: bool) -> Result<Measured, Failure> {
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
        checksum: table::checksum(&row),
        resources: estimate(Mapping::LogicElement)?.total,
        luts_by_yosys: by_yosys.transpose()?.map(|estimate| estimate.total.luts),
        row,
    })
}
