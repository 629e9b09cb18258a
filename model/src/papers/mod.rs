//! The source papers' tables beside ours.
//!
//! | paper | about |
//! |---|---|
//! | `hybrid-ei` | bias-point hybrids of ZV and EI shapers, and one shaper for many modes (2010) |
//! | `negative-hybrid` | negative impulses, a different shaper per mode |
//! | `vibrationless` | half-sum cascades, robust over a band |
//! | `antisymmetry` | one shaper for many modes whose frequencies are odd multiples (1993) |
//! | `xy-stage` | a thesis on an XY stage: drive, identification, ZV and ZVD |
//!
//! Every row holds the paper's own number, which is the only thing that is typed in, and ours, which the library computes
//! as the row is made. [`sheet`] says how the two become a verdict.

mod contour;
mod designs;
mod drive;
mod identification;
mod negative_hybrid;
mod sheet;
mod xy_stage;

pub use sheet::{Row, Rule, Value, Verdict};

use crate::design::DesignError;
use sheet::Sheet;

/// One of the source papers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Paper {
    /// Negative-impulse shapers, a different one per mode.
    NegativeHybrid,
    /// The XY stage.
    XyStage,
}

impl Paper {
    /// All papers, in the order in which they are shown.
    pub const ALL: [Paper; 2] = [Paper::NegativeHybrid, Paper::XyStage];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Paper::NegativeHybrid => "negative-hybrid",
            Paper::XyStage => "xy-stage",
        }
    }

    /// The paper of that name, if there is one.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|paper| paper.name() == name)
    }

    /// Computes every row of the paper.
    ///
    /// # Errors
    /// [`DesignError`] if a shaper of the paper cannot be designed: a fault of posicast.
    pub fn reproduce(self) -> Result<Vec<Row>, DesignError> {
        let mut sheet = Sheet::default();
        match self {
            Paper::NegativeHybrid => negative_hybrid::rows(&mut sheet)?,
            Paper::XyStage => xy_stage::rows(&mut sheet)?,
        }
        Ok(sheet.into_rows())
    }
}
