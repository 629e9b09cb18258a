//! The steps of posicast as functions: each takes typed options and returns one document.
//!
//! A front, such as the command line, calls them, and shows the document as JSON or as text. Fields of a document that JSON leaves out are
//! for texts alone. Nothing here reads arguments, prints, or draws a progress bar: messages of a step go to the front's [`Observer`].

mod allowance;
mod bench;
pub mod bitstream;
pub mod block_kit;
mod blocks;
mod bus_files;
pub mod campaign;
pub mod choice;
mod command;
pub mod compare;
pub mod contour;
mod control;
pub mod design;
mod driver;
pub mod export;
mod failure;
mod files;
pub mod generate;
mod guards;
pub mod hal;
mod hardware;
pub mod identify;
mod input;
mod kit;
pub mod machine;
pub mod moves;
mod observer;
pub mod plot;
pub mod replay;
pub mod run;
pub mod simulate;
mod sopc;
pub mod synth;
pub mod template;
pub mod text;
mod tolerance;
pub mod verify;
mod verilog;
mod vhdl;
mod warning;

pub use bench::{Simulator, clocks};
pub use failure::{Excerpt, Failure, Reason};
pub use files::ResultForm;
pub use observer::{ExpectedTime, Late, Observer, Silent, WorkProgress};

use posicast_system::output::OutputFiles;

/// Version of posicast, with the short hash of the commit where it was built in a checkout of its own repository.
pub const VERSION: &str = env!("POSICAST_VERSION");

/// The result of a step.
pub struct Outcome<D> {
    /// The result.
    pub document: D,
    /// Whether an output file of the step is the standard output, so that a text belongs elsewhere.
    pub is_beside_a_file: bool,
    /// Why a check of the step failed; `None` if all hold.
    pub failed: Option<String>,
}

impl<D> Outcome<D> {
    /// The result of a step in which nothing failed.
    pub(crate) fn passed(document: D) -> Self {
        Self {
            document,
            is_beside_a_file: false,
            failed: None,
        }
    }

    /// The same result, for a step that wrote these files.
    pub(crate) fn beside(self, outputs: &OutputFiles) -> Self {
        Self {
            is_beside_a_file: outputs.take_standard_output(),
            ..self
        }
    }
}
