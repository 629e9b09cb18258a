//! Everything that can go wrong here, by cause.

use std::path::{Path, PathBuf};

use posicast_hdl::SimulationError;
use posicast_hdl::emit::EmitError;
use posicast_model::rtl::StepError;
use wavecmp::WaveError;

/// Why a comparison could not be made. That something *differs* is a result, never an error.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// An external program is not installed: exit status 3.
    #[error("{tool}: not found ({purpose}). {remedy}")]
    ToolMissing {
        /// The program that was looked for.
        tool: String,
        /// What it is needed for.
        purpose: &'static str,
        /// How to get it.
        remedy: &'static str,
    },
    /// An external program ran and failed.
    #[error("{tool} failed while {doing} ({status}):\n{output}")]
    ToolFailed {
        /// The program.
        tool: String,
        /// What it was doing.
        doing: &'static str,
        /// Its exit status in words.
        status: String,
        /// The last lines of its output.
        output: String,
    },
    /// The Verilog's ports are not those of the model.
    #[error("module `{top}` does not have the expected ports:\n{}\nThe Verilog was edited, or belongs to another \
             machine file: generate it again, or verify the folder it came from", .problems.join("\n"))]
    Ports {
        /// The module.
        top: String,
        /// One line per port that differs.
        problems: Vec<String>,
    },
    /// Model and device under test have different ports.
    #[error("model and device under test cannot be compared: {0}")]
    Unlike(String),
    /// A block that cannot be written as Verilog, or that RustHDL refuses.
    #[error(transparent)]
    Block(BlockError),
    /// A source file, cache folder or output file cannot be read or written.
    #[error("{}: cannot {doing}: {source}", .path.display())]
    File {
        /// The file or folder.
        path: PathBuf,
        /// What was tried.
        doing: &'static str,
        /// What the system says.
        source: std::io::Error,
    },
    /// The shared object that Verilator built cannot be used.
    #[error("{}: the built simulation cannot be loaded ({reason}); delete that file and try again", .path.display())]
    Load {
        /// The shared object.
        path: PathBuf,
        /// What the loader says.
        reason: String,
    },
    /// A simulator stopped.
    #[error("clock {clock}: {source}")]
    Step {
        /// Clocks since the start of the run.
        clock: u64,
        /// What it says.
        source: StepError,
    },
    /// A waveform cannot be read, or compared.
    #[error(transparent)]
    Wave(#[from] WaveError),
    /// An option, or an argument, that does not fit.
    #[error("{0}")]
    Option(String),
}

/// Why there is no hardware to compare.
#[derive(Debug, thiserror::Error)]
pub enum BlockError {
    /// The emitter cannot write it.
    #[error(transparent)]
    Emit(#[from] EmitError),
    /// RustHDL found a fault in it.
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
    pub(crate) fn file(path: &Path, doing: &'static str) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self::File { path, doing, source }
    }

    /// Whether the cause is a program that is not installed.
    pub fn is_missing_tool(&self) -> bool {
        matches!(self, Self::ToolMissing { .. })
    }
}
