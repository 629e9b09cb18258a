//! What an engineer opens in Quartus: components for Platform Designer, a system with a processor, and a project per board.
//!
//! ```text
//! DIR/README.md                                 what to do, step by step
//! DIR/sopc/TOP_hw.tcl                           a component each: the stage, and every block that stands alone
//! DIR/sopc/MACHINE_BOARD_system.tcl             the system of a board, for qsys-script
//! DIR/sopc/quartus/BOARD/MACHINE_BOARD.qpf …    its project: .qpf, .qsf, .sdc, top level
//! ```
//!
//! - Everything follows from the components' register maps and ports ([`Unit`]) and from the facts of the boards ([`Board`]).
//! - Systems and projects are there for a machine with a stage. Blocks that stand alone are components for systems of one's own.
//! - A board whose oscillator has not the machine's clock gets no project: the README says so. There is no PLL in ours.
//! - Cyclone II ends with Quartus II 13.0sp1. What is written for it, and the components, which all boards share, keep to what
//!   that version knows.
//!
//! What this does not show: Quartus itself. Its commands are checked against lists of what 13.0 knows (`cli/tests`), its
//! results are not.

mod board;
mod hw_tcl;
mod pins;
mod quartus;
mod readme;
mod system;
mod tcl;
mod top;
mod unit;

pub use board::{Board, UnknownBoard};
pub use hw_tcl::compatible;
pub(crate) use system::STAGE_BASE;
pub use unit::Unit;

/// What the package of a machine is made from.
#[derive(Debug, Clone)]
pub struct Design<'a> {
    /// Name of the machine.
    pub machine: &'a str,
    /// Its clock in Hz.
    pub clock_hz: f64,
    /// Its board, where the machine file names one: the README begins with it.
    pub board: Option<Board>,
    /// Its stage, if it has one.
    pub stage: Option<Unit<'a>>,
    /// The axes whose gates are off at a high level, out of those of the stage.
    pub active_low_axes: Vec<&'a str>,
    /// The blocks that stand alone.
    pub components: Vec<Unit<'a>>,
}

/// A file of the package.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ProjectFile {
    /// Path in the folder, with `/`.
    pub path: String,
    /// Contents.
    pub text: String,
}

/// Why there is no package.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SopcError {
    /// More lines than a board has pins for.
    #[error(
        "{board}: the stage has {needed} lines for the expansion headers, which have {available} pins: leave out an axis or a \
         scale, or take a board of your own (the component does not depend on one)"
    )]
    Pins {
        /// The board.
        board: Board,
        /// Pins needed.
        needed: usize,
        /// Pins there are.
        available: usize,
    },
    /// A port that is no line.
    #[error("port {port} of the stage has more than one bit: a board has no place for it")]
    Wide {
        /// The port.
        port: String,
    },
}

impl Design<'_> {
    /// The files, in no order that matters.
    ///
    /// # Errors
    /// [`SopcError`] for a stage that a board has no pins for.
    pub fn files(&self) -> Result<Vec<ProjectFile>, SopcError> {
        let mut files = Vec::new();
        let mut add = |path: String, text: String| files.push(ProjectFile { path, text });
        for unit in self.units() {
            add(format!("sopc/{}_hw.tcl", unit.top), hw_tcl::text(unit));
        }
        let mut projects = Vec::new();
        for (board, stage) in self.projects() {
            let pins = pins::assign(board, stage)?;
            let machine = self.machine;
            let name = top::name(machine, board);
            let folder = format!("sopc/quartus/{board}");
            add(
                format!("sopc/{}.tcl", system::name(machine, board)),
                system::script(machine, board, stage, self.clock_hz),
            );
            add(format!("{folder}/{name}.v"), top::text(machine, board, stage, &pins));
            add(format!("{folder}/{name}.qpf"), quartus::project(machine, board));
            add(format!("{folder}/{name}.qsf"), quartus::settings(machine, board, &pins));
            add(
                format!("{folder}/{name}.sdc"),
                quartus::timing(machine, board, stage, &pins),
            );
            projects.push((board, pins));
        }
        add("README.md".to_owned(), readme::text(self, &projects));
        Ok(files)
    }

    /// All components, the stage first.
    fn units(&self) -> impl Iterator<Item = &Unit<'_>> {
        self.stage.iter().chain(&self.components)
    }

    /// Can the board run the machine as it is?
    pub fn runs_on(&self, board: Board) -> bool {
        (board.facts().oscillator_hz - self.clock_hz).abs() < 0.5
    }

    /// The boards with a project, the machine's own first.
    fn projects(&self) -> Vec<(Board, &Unit<'_>)> {
        let Some(stage) = &self.stage else {
            return Vec::new();
        };
        let mut boards: Vec<Board> = Board::ALL.into_iter().filter(|board| self.runs_on(*board)).collect();
        boards.sort_by_key(|board| Some(*board) != self.board);
        boards.into_iter().map(|board| (board, stage)).collect()
    }
}
