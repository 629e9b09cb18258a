//! The content of a project's top level: the system with a processor, or the stage with its line alone.

use super::board::Board;
use super::system;

/// The content of a project's top level.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Core<'a> {
    /// The system that Platform Designer builds.
    System,
    /// The top module `NAME_link`: a host at its line in place of a processor.
    Link(&'a str, Line),
}

/// The line of a stage without a processor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Line {
    Uart,
    Spi,
}

impl Line {
    /// A description of the stage as a part of a sentence.
    pub(super) fn of_stage(self) -> &'static str {
        match self {
            Self::Uart => "the stage with its serial line",
            Self::Spi => "the stage with its SPI lines",
        }
    }
}

impl Core<'_> {
    /// Name of the project, which is that of its top level.
    pub(super) fn project(self, machine: &str, board: Board) -> String {
        match self {
            Self::System => format!("{machine}_{board}"),
            Self::Link(top, _) => format!("{top}_{board}"),
        }
    }

    /// Folder of the project.
    pub(super) fn folder(self, board: Board) -> String {
        match self {
            Self::System => format!("sopc/quartus/{board}"),
            Self::Link(..) => format!("sopc/quartus/{board}_link"),
        }
    }

    /// Module inside the top level.
    pub(super) fn module(self, machine: &str, board: Board) -> String {
        match self {
            Self::System => system::name(machine, board),
            Self::Link(top, _) => top.to_owned(),
        }
    }

    /// The file with the list of its Verilog, in the folder of the project.
    pub(super) fn qip(self, machine: &str, board: Board) -> String {
        match self {
            Self::System => {
                let system = system::name(machine, board);
                format!("{system}/synthesis/{system}.qip")
            }
            Self::Link(..) => format!("{machine}.qip"),
        }
    }
}
