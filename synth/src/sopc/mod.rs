//! Files for Quartus: components for Platform Designer, a system with a processor, and a project per board.
//!
//! ```text
//! DIR/README.md                                 what to do, step by step
//! DIR/sopc/TOP_hw.tcl                           a component each: the stage, and every block that stands alone
//! DIR/sopc/MACHINE_BOARD_system.tcl             the system of a board, for qsys-script
//! DIR/sopc/quartus/BOARD/MACHINE_BOARD.qpf …    its project: .qpf, .qsf, .sdc, top level
//! DIR/sopc/quartus/BOARD_link/…                 a project without a processor: the stage with its line
//! ```
//!
//! - Everything is derived from the components' register maps and ports ([`Unit`]) and from the facts of the boards
//!   ([`Board`]).
//! - Systems and projects are written for a machine with a stage. Blocks that stand alone are components for the
//!   user's own systems.
//! - A board whose oscillator does not have the machine's clock gets no project, and the README says so: these
//!   systems have no PLL.
//! - Cyclone II ends with Quartus II 13.0sp1. Its files, and the components, which all boards share, use only what
//!   that version knows.
//!
//! Quartus itself is not run. The commands are checked against lists of the commands of 13.0 (`cli/tests`); their
//! results are not checked.

mod board;
mod bridge;
mod core;
mod hw_tcl;
mod pins;
mod quartus;
mod readme;
mod system;
mod tcl;
mod top;
mod unit;

use core::Core;
use posicast_blocks::bus_component::BridgedBus;

pub use board::{Board, UnknownBoard};
pub use bridge::BridgeUnit;
pub use hw_tcl::compatible;
pub(crate) use system::STAGE_BASE;
pub use unit::Unit;

/// Data from which the package of a machine is made.
#[derive(Debug, Clone)]
pub struct Design<'a> {
    /// Name of the machine.
    pub machine: &'a str,
    /// Fabric clock in Hz.
    pub clock_hz: f64,
    /// Its board, if the machine file names one: the README lists it first.
    pub board: Option<Board>,
    /// Its stage, if it has one.
    pub stage: Option<Unit<'a>>,
    /// Top module of the stage with its line, and the bridge in it, if it has one.
    pub link: Option<(String, BridgeUnit)>,
    /// The axes of the stage whose gates are off at a high level.
    pub active_low_axes: Vec<&'a str>,
    /// The blocks that stand alone.
    pub components: Vec<Unit<'a>>,
    /// The inline shaper, if it has one.
    pub inline: Option<InlineUnit>,
    /// The bus of the further top modules, if the machine file asks for one.
    pub bus: Option<BridgedBus>,
}

/// An inline shaper, as the README tells its user.
#[derive(Debug, Clone, PartialEq)]
pub struct InlineUnit {
    /// Name of its top module.
    pub top: String,
    /// Its axes.
    pub axes: Vec<InlineUnitAxis>,
}

/// Delays and rates of an axis of an inline shaper.
#[derive(Debug, Clone, PartialEq)]
pub struct InlineUnitAxis {
    /// Name of the axis.
    pub name: String,
    /// Largest rate of the command, in steps per second.
    pub input_hz: f64,
    /// Delay with shaping in s.
    pub shaped_s: f64,
    /// Delay without shaping in s.
    pub unshaped_s: f64,
    /// Longest time from the last step of the command to rest, in s.
    pub settle_s: f64,
}

/// A file of the package.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ProjectFile {
    /// Path in the folder, with `/`.
    pub path: String,
    /// Text of the file.
    pub text: String,
}

/// Why the package cannot be made.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SopcError {
    /// The board has fewer pins than the stage has lines.
    #[error(
        "{board}: the stage has {needed} lines for the expansion headers, which have {available} pins: leave out an axis or a \
         scale, or take a board of your own (the component does not depend on one)"
    )]
    Pins {
        /// The board.
        board: Board,
        /// Number of pins that are needed.
        needed: usize,
        /// Number of pins of the headers.
        available: usize,
    },
    /// A port has more than one bit.
    #[error("port {port} of the stage has more than one bit: a board has no place for it")]
    Wide {
        /// Name of the port.
        port: String,
    },
}

impl Design<'_> {
    /// The files, in no particular order.
    ///
    /// # Errors
    /// [`SopcError`] for a stage that does not fit the pins of a board.
    pub fn files(&self) -> Result<Vec<ProjectFile>, SopcError> {
        let mut files = Vec::new();
        let mut add = |path: String, text: String| files.push(ProjectFile { path, text });
        for unit in self.units() {
            add(format!("sopc/{}_hw.tcl", unit.top), hw_tcl::text(unit));
        }
        // An inline shaper is in no system with a processor.
        if let Some((_, bridge)) = self.link.as_ref().filter(|_| self.inline.is_none()) {
            let name = bridge.name(self.machine);
            add(format!("sopc/{name}_hw.tcl"), bridge.text(self.machine));
        }
        let mut projects = Vec::new();
        for (board, stage) in self.projects() {
            let machine = self.machine;
            add(
                format!("sopc/{}.tcl", system::name(machine, board)),
                system::script(machine, board, stage, self.clock_hz),
            );
            for core in self.cores() {
                let pins = match pins::assign(board, core, stage) {
                    Err(SopcError::Pins { .. }) if core != Core::System => continue,
                    pins => pins?,
                };
                let of = (machine, board, core);
                let (folder, name) = (core.folder(board), core.project(machine, board));
                add(format!("{folder}/{name}.v"), top::text(of, stage, &pins));
                add(format!("{folder}/{name}.qpf"), quartus::project(of));
                add(format!("{folder}/{name}.qsf"), quartus::settings(of, &pins));
                add(format!("{folder}/{name}.sdc"), quartus::timing(of, stage, &pins));
                projects.push((board, core, pins));
            }
        }
        add("README.md".to_owned(), readme::text(self, &projects));
        Ok(files)
    }

    /// Returns why boards get no project without a processor: their headers have no pins left for the line.
    pub fn without_link_project(&self) -> Vec<SopcError> {
        let cores: Vec<Core<'_>> = self.cores().filter(|core| *core != Core::System).collect();
        let of_board = |(board, stage): (Board, &Unit<'_>)| {
            let assigned = cores.iter().map(move |core| pins::assign(board, *core, stage));
            assigned.filter_map(Result::err).collect::<Vec<_>>()
        };
        self.projects().into_iter().flat_map(of_board).collect()
    }

    /// All components, the stage first.
    fn units(&self) -> impl Iterator<Item = &Unit<'_>> {
        self.stage.iter().chain(&self.components)
    }

    /// Contents of the projects of a board.
    fn cores(&self) -> impl Iterator<Item = Core<'_>> {
        let link = self.link.as_ref().map(|(top, bridge)| Core::Link(top, bridge.line()));
        std::iter::once(Core::System).chain(link)
    }

    /// Whether the board can run the machine without changes.
    pub fn runs_on(&self, board: Board) -> bool {
        (board.facts().oscillator_hz - self.clock_hz).abs() < 0.5
    }

    /// The boards with a project; the machine's own comes first.
    fn projects(&self) -> Vec<(Board, &Unit<'_>)> {
        let Some(stage) = &self.stage else {
            return Vec::new();
        };
        let mut boards: Vec<Board> = Board::ALL.into_iter().filter(|board| self.runs_on(*board)).collect();
        boards.sort_by_key(|board| Some(*board) != self.board);
        boards.into_iter().map(|board| (board, stage)).collect()
    }
}
