//! Comparison of the source papers' tables with the results of this library.
//!
//! | paper | about |
//! |---|---|
//! | `hybrid-ei` | bias-point hybrids of ZV and EI shapers, and one shaper for many modes (2010) |
//! | `negative-hybrid` | negative impulses, a different shaper per mode |
//! | `vibrationless` | half-sum cascades, robust over a band |
//! | `antisymmetry` | one shaper for many modes whose frequencies are odd multiples (1993) |
//! | `xy-stage` | a thesis on an XY stage: drive, identification, ZV and ZVD |
//!
//! Every row holds the paper's own number, which is the only one entered by hand, and ours, which the library
//! computes when the row is made. [`PaperVerdict`] and [`Rule`] define how the two give a verdict.

mod antisymmetry;
mod beyond;
mod chain;
mod contour;
pub mod controllers;
mod designs;
mod drive;
mod figures;
mod hybrid_ei;
mod identification;
mod minors;
mod negative_hybrid;
mod negative_shapers;
mod negative_statements;
mod plants;
mod row;
mod sheet;
mod sliding_mode_law;
mod vibrationless;
mod xy_stage;

pub use beyond::{BeyondRow, beyond};
pub use figures::{Figure, FigureCurve};
pub use row::{PaperRow, PaperVerdict, Value};
pub use sheet::Rule;

use posicast_shaper::design::DesignError;
use sheet::Sheet;

/// One of the source papers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Paper {
    /// Bias-point hybrids of ZV and EI shapers, and one shaper for many modes.
    HybridEi,
    /// Negative-impulse shapers, a different one per mode.
    NegativeHybrid,
    /// Half-sum cascades.
    Vibrationless,
    /// One shaper for many modes by antisymmetry.
    Antisymmetry,
    /// The XY stage.
    XyStage,
}

impl Paper {
    /// All papers, in the order in which they are shown.
    pub const ALL: [Paper; 5] = [
        Paper::HybridEi,
        Paper::NegativeHybrid,
        Paper::Vibrationless,
        Paper::Antisymmetry,
        Paper::XyStage,
    ];

    /// Returns the name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Paper::HybridEi => "hybrid-ei",
            Paper::NegativeHybrid => "negative-hybrid",
            Paper::Vibrationless => "vibrationless",
            Paper::Antisymmetry => "antisymmetry",
            Paper::XyStage => "xy-stage",
        }
    }

    /// Returns the subject of the paper.
    pub fn title(self) -> &'static str {
        match self {
            Paper::HybridEi => "hybrid EI shapers, and one of them for many modes (Zhang and Li 2010)",
            Paper::NegativeHybrid => "negative-impulse shapers, a different one for each of two modes",
            Paper::Vibrationless => "robust vibrationless control by half-sum cascades (Prourzin and Shevlyakov)",
            Paper::Antisymmetry => "one shaper for many modes by antisymmetry (Singh and Heppler 1993)",
            Paper::XyStage => "a thesis on an XY stage: its drive, its identified plants, ZV and ZVD",
        }
    }

    /// Returns the paper of that name, if there is one.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|paper| paper.name() == name)
    }

    /// Computes every row of the paper.
    ///
    /// # Errors
    /// [`DesignError`] if a shaper of the paper cannot be designed, which is a bug of posicast.
    pub fn reproduce(self) -> Result<Vec<PaperRow>, DesignError> {
        let mut sheet = Sheet::default();
        match self {
            Paper::HybridEi => hybrid_ei::rows(&mut sheet)?,
            Paper::NegativeHybrid => negative_hybrid::rows(&mut sheet)?,
            Paper::Vibrationless => vibrationless::rows(&mut sheet)?,
            Paper::Antisymmetry => antisymmetry::rows(&mut sheet)?,
            Paper::XyStage => xy_stage::rows(&mut sheet)?,
        }
        Ok(sheet.into_rows())
    }

    /// Returns the paper's figures, redrawn.
    ///
    /// # Errors
    /// Same as [`Self::reproduce`].
    pub fn figures(self) -> Result<Vec<Figure>, DesignError> {
        match self {
            Paper::HybridEi => figures::hybrid_ei(),
            Paper::NegativeHybrid => figures::negative_hybrid(),
            Paper::Vibrationless => figures::vibrationless(),
            Paper::Antisymmetry => figures::antisymmetry(),
            Paper::XyStage => figures::xy_stage(),
        }
    }
}
