//! Errors of this crate, by cause.

use std::fmt;
use std::path::{Path, PathBuf};
use std::time::Duration;

use posicast_blocks::StepError;
use posicast_hdl::SimulationError;
use posicast_hdl::emit::EmitError;
use wavecmp::WaveError;

/// Why a comparison could not be made. A *difference* is a result, never an error.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// External programs are not installed: exit status 3.
    #[error("{}", named(.0))]
    ToolMissing(Vec<MissingTool>),
    /// An external program did not answer, and was stopped.
    #[error("{tool} did not answer for {} s while {doing}, and was stopped; {} sets another time limit, in seconds", .limit.as_secs(), crate::tool::LIMIT_VARIABLE)]
    TimeOut {
        /// Name of the program.
        tool: String,
        /// Its task.
        doing: &'static str,
        /// Its time limit.
        limit: Duration,
    },
    /// An external program failed.
    #[error("{tool} failed while {doing} ({status}):\n{output}")]
    ToolFailed {
        /// Name of the program.
        tool: String,
        /// Its task.
        doing: &'static str,
        /// Its exit status, in words.
        status: String,
        /// Last lines of its output.
        output: String,
    },
    /// The Verilog's ports are not those of the model.
    #[error("module `{top}` does not have the expected ports:\n{}\nThe Verilog was edited, or belongs to another \
             machine file: generate it again, or verify the folder it came from", .problems.join("\n"))]
    Ports {
        /// Name of the module.
        top: String,
        /// A line for each port that differs.
        problems: Vec<String>,
    },
    /// Model and device under test have different ports.
    #[error("model and device under test cannot be compared: {0}")]
    Unlike(String),
    /// A block cannot be written as Verilog, or RustHDL refuses it.
    #[error(transparent)]
    Block(BlockError),
    /// A source file, cache folder or output file cannot be read or written.
    #[error("{}: cannot {doing}: {source}", .path.display())]
    File {
        /// Path of the file or folder.
        path: PathBuf,
        /// What was attempted.
        doing: &'static str,
        /// The system's error.
        source: std::io::Error,
    },
    /// The shared object that Verilator built cannot be loaded.
    #[error("{}: the built simulation cannot be loaded ({reason}); delete that file and try again", .path.display())]
    Load {
        /// Path of the shared object.
        path: PathBuf,
        /// The loader's reason.
        reason: String,
    },
    /// A simulator stopped.
    #[error("clock {clock}: {source}")]
    Step {
        /// Number of clocks since the start of the run.
        clock: u64,
        /// The simulator's error.
        source: StepError,
    },
    /// A waveform cannot be read, or compared.
    #[error(transparent)]
    Wave(#[from] WaveError),
    /// An option does not fit the files with which it is used.
    #[error("{0}")]
    Option(String),
}

/// Why there is no hardware to compare.
#[derive(Debug, thiserror::Error)]
pub enum BlockError {
    /// The emitter cannot write the block.
    #[error(transparent)]
    Emit(#[from] EmitError),
    /// RustHDL found an error in the block.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
}

impl From<EmitError> for Error {
    fn from(error: EmitError) -> Self {
        Self::Block(error.into())
    }
}

impl From<SimulationError> for Error {
    fn from(error: SimulationError) -> Self {
        Self::Block(error.into())
    }
}

impl Error {
    /// Adds path and attempted action to an error of the file system.
    pub fn file(path: &Path, doing: &'static str) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self::File { path, doing, source }
    }

    /// Whether the cause is a program that is not installed.
    pub fn is_missing_tool(&self) -> bool {
        matches!(self, Self::ToolMissing(_))
    }
}

/// An external program that is not installed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MissingTool {
    /// Name of the program, or the path that a variable gives.
    pub tool: String,
    /// Purpose of the program.
    pub purpose: &'static str,
    /// Instruction that installs the tool.
    pub remedy: &'static str,
}

impl fmt::Display for MissingTool {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: not found ({}). {}", self.tool, self.purpose, self.remedy)
    }
}

fn named(tools: &[MissingTool]) -> String {
    tools.iter().map(MissingTool::to_string).collect::<Vec<_>>().join("\n")
}
