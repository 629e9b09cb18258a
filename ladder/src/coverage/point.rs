//! Reads Verilator's coverage file.
//!
//! ```text
//! C '\x01KEY\x02VALUE\x01KEY\x02VALUE…' COUNT      one line per point, the letters here being the characters 1 and 2
//! ```
//!
//! Its keys are `f` for the file, `l` for the line, `page` for kind and module, and `o` for the point (a branch, or a
//! net's bit). A module that a block contains several times is counted once, over all its instances.

use std::path::{Path, PathBuf};

use posicast_testbench::Error;

/// A coverage point of a module, and how often it was reached.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CoveragePoint {
    /// Name of the module, as in the Verilog.
    pub module: String,
    /// Kind: line, toggle or condition.
    pub kind: PointKind,
    /// Line: its text in the Verilog. Toggle: the net, with the bit if it has several. Condition: the term and its value.
    pub what: String,
    /// Number of times that the point was reached.
    pub count: u64,
}

/// Kind of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum PointKind {
    /// The body that begins in a line was run.
    Line,
    /// A bit of a net changed, up or down.
    Toggle,
    /// A term of a condition had a value and decided.
    Condition,
}

impl PointKind {
    /// Name of the kind in the table of holes.
    pub fn name(self) -> &'static str {
        match self {
            Self::Line => "line",
            Self::Toggle => "toggle",
            Self::Condition => "condition",
        }
    }
}

/// Reads the points in the file at `path`. Lines are looked up in `files` by file name, because the paths in
/// Verilator's file lead to the folder in which the simulation was built.
///
/// # Errors
/// [`Error::File`] where a file cannot be read, [`Error::Option`] where a line is not as above.
pub fn read(path: &Path, files: &[PathBuf]) -> Result<Vec<CoveragePoint>, Error> {
    let text = std::fs::read_to_string(path).map_err(Error::file(path, "read Verilator's counts in"))?;
    let mut verilog = Verilog {
        files,
        path: PathBuf::new(),
        lines: Vec::new(),
    };
    let mut points = Vec::new();
    for line in text.lines().filter(|line| line.starts_with("C ")) {
        let point = point(line, &mut verilog)?;
        points.push(point);
    }
    Ok(points)
}

fn point(line: &str, verilog: &mut Verilog<'_>) -> Result<CoveragePoint, Error> {
    let strange = || Error::Option(format!("`{line}` is not a line of Verilator's coverage file"));
    let (keys, count) = line
        .strip_prefix("C '")
        .and_then(|rest| rest.rsplit_once("' "))
        .ok_or_else(strange)?;
    let value = |wanted: &str| {
        let mut pairs = keys.split('\u{1}').filter_map(|pair| pair.split_once('\u{2}'));
        pairs
            .find(|(key, _)| *key == wanted)
            .map(|(_, value)| value)
            .ok_or_else(strange)
    };
    let (page, module) = value("page")?.split_once('/').ok_or_else(strange)?;
    let kind = match page {
        "v_toggle" => PointKind::Toggle,
        "v_line" | "v_branch" => PointKind::Line,
        "v_user" => PointKind::Condition,
        _ => return Err(strange()),
    };
    let what = match kind {
        PointKind::Toggle => value("o")?.to_owned(),
        PointKind::Line | PointKind::Condition => {
            let number = value("l")?.parse().map_err(|_| strange())?;
            let text = verilog.line(Path::new(value("f")?), number)?;
            // The condition of an `if` may stand for its other branch.
            match value("o")? {
                _ if kind == PointKind::Condition => text.split_once("// ").ok_or_else(strange)?.1.to_owned(),
                "else" => format!("not {text}"),
                _ => text,
            }
        }
    };
    Ok(CoveragePoint {
        module: module.to_owned(),
        kind,
        what,
        count: count.trim().parse().map_err(|_| strange())?,
    })
}

/// The Verilog files, with the text of the one that was read last.
struct Verilog<'a> {
    files: &'a [PathBuf],
    path: PathBuf,
    lines: Vec<String>,
}

impl Verilog<'_> {
    fn line(&mut self, path: &Path, number: usize) -> Result<String, Error> {
        if self.path != path {
            let file = self.files.iter().find(|file| file.file_name() == path.file_name());
            let unknown = || Error::Option(format!("{} is none of the block's files", path.display()));
            let file = file.ok_or_else(unknown)?;
            let text = std::fs::read_to_string(file).map_err(Error::file(file, "read the Verilog"))?;
            self.lines = text.lines().map(|line| line.trim().to_owned()).collect();
            self.path = path.to_owned();
        }
        let text = number.checked_sub(1).and_then(|at| self.lines.get(at));
        text.cloned()
            .ok_or_else(|| Error::Option(format!("{} has no line {number}", path.display())))
    }
}
