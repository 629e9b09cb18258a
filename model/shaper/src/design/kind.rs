//! The kinds of shaper: a row for each, which lives in the file of its design, and the list that joins the rows.
//!
//! Whatever depends on the kind follows from its row: the names in messages, the keys of the machine file that a kind
//! takes, the dispatch of the design and the tables of the pages. A new kind is a row and a line of `kinds!`.

use std::fmt;

use super::joint::Findings;
use super::smooth::Form;
use super::{
    DesignError, ModeSettings, antisymmetric, bias_point, custom, hump_ei, negative, optimal, periodic, simultaneous,
    smooth, vibrationless, zv,
};
use crate::axis::ShapedAxis;
use crate::impulse::ImpulseSequence;
use crate::mode::Mode;

/// A kind of shaper: its name, what it promises, and how it is designed.
#[derive(Debug, Clone, Copy)]
pub struct KindRow {
    /// Name in the machine file.
    pub name: &'static str,
    /// Effect of the kind, as a phrase of Markdown.
    pub about: &'static str,
    /// Author and year of the publication; empty for what needs none.
    pub source: &'static str,
    /// The keys of `[axis.shaper]` that it takes, beside `kind` and `tolerance`, which every kind has.
    pub keys: &'static [&'static str],
    /// Value of the key `order` where the file has none; 1 for a kind without order.
    pub default_order: u32,
    pub(super) promise: Promise,
    pub(super) design: Design,
}

/// Residual that a kind leaves at the mode, without damping or with it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Promise {
    /// None.
    Zero,
    /// The tolerance.
    Tolerance,
    /// No certain one; the design checks what it promises instead.
    Unsaid,
}

impl Promise {
    /// The residual; `None` for [`Promise::Unsaid`].
    pub(super) fn at(self, tolerance: f64) -> Option<f64> {
        match self {
            Promise::Zero => Some(0.0),
            Promise::Tolerance => Some(tolerance),
            Promise::Unsaid => None,
        }
    }
}

/// Subject of a kind's design, and the function that designs it.
#[derive(Debug, Clone, Copy)]
pub(super) enum Design {
    /// Impulses for one mode; the axis gets the convolution of its modes' shapers.
    Mode(fn(ShaperKind, &Mode, &ModeSettings) -> Result<ImpulseSequence, DesignError>),
    /// A continuous kernel for one mode and a tolerance.
    Kernel(fn(ShaperKind, &Mode, f64) -> Result<Form, DesignError>),
    /// Impulses for all modes of an axis, with samples at this rate in Hz.
    Axis(fn(ShapedAxis<'_>, f64) -> Result<(ImpulseSequence, Findings), DesignError>),
    /// Impulses that do not depend on the modes.
    Fixed(fn(ShapedAxis<'_>) -> Result<ImpulseSequence, DesignError>),
}

impl KindRow {
    /// Makes a row without a source and without keys of its own.
    pub(super) const fn new(name: &'static str, promise: Promise, design: Design, about: &'static str) -> Self {
        Self {
            name,
            about,
            source: "",
            keys: &[],
            default_order: 1,
            promise,
            design,
        }
    }

    /// Sets the publication of the kind.
    pub(super) const fn source(self, source: &'static str) -> Self {
        Self { source, ..self }
    }

    /// Gives the kind keys of its own.
    pub(super) const fn keys(self, keys: &'static [&'static str]) -> Self {
        Self { keys, ..self }
    }

    /// Gives the key `order` a default.
    pub(super) const fn order(self, default_order: u32) -> Self {
        Self { default_order, ..self }
    }
}

/// Joins the rows to the list of kinds.
macro_rules! kinds {
    ($($kind:ident: $row:path,)*) => {
        /// Every kind of shaper that a machine file may name, in the order in which messages list them.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        #[allow(missing_docs)] // the rows are the documentation
        pub enum ShaperKind {
            $($kind,)*
        }

        impl ShaperKind {
            /// All kinds.
            pub const ALL: &[ShaperKind] = &[$(ShaperKind::$kind,)*];

            /// The row of the kind.
            pub const fn row(self) -> &'static KindRow {
                match self {
                    $(ShaperKind::$kind => &$row,)*
                }
            }
        }
    };
}

kinds! {
    Zv: zv::ZV,
    Zvd: zv::ZVD,
    Zvdd: zv::ZVDD,
    Zvddd: zv::ZVDDD,
    Mzv: zv::MZV,
    Ei: hump_ei::EI,
    TwoHumpEi: hump_ei::TWO_HUMP_EI,
    ThreeHumpEi: hump_ei::THREE_HUMP_EI,
    UmZv: negative::UM_ZV,
    UmZvd: negative::UM_ZVD,
    UmEi: negative::UM_EI,
    PsZv: negative::PS_ZV,
    PsZvd: negative::PS_ZVD,
    PsEi: negative::PS_EI,
    ZvEi: bias_point::ZV_EI,
    ZvEi2: bias_point::ZV_EI_2,
    ZvdEi: bias_point::ZVD_EI,
    MultiEi: bias_point::MULTI_EI,
    ChebyshevEi: bias_point::CHEBYSHEV_EI,
    Vibrationless: vibrationless::VIBRATIONLESS,
    Antisymmetric: antisymmetric::ANTISYMMETRIC,
    Simultaneous: simultaneous::SIMULTANEOUS,
    Periodic: periodic::PERIODIC,
    SmoothZv: smooth::ZV,
    SmoothMzv: smooth::MZV,
    SmoothEi: smooth::EI,
    SmoothZvd: smooth::ZVD,
    SmoothSi: smooth::SI,
    SmoothZvdEi: smooth::ZVD_EI,
    SmoothTwoHumpEi: smooth::TWO_HUMP_EI,
    Optimal: optimal::OPTIMAL,
    Custom: custom::CUSTOM,
    None: custom::NONE,
}

impl ShaperKind {
    /// Name in the machine file.
    pub const fn name(self) -> &'static str {
        self.row().name
    }

    /// The kind with this name; `None` if there is none.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|kind| kind.name() == name)
    }

    /// Whether the command is convolved with a continuous kernel, which has no impulses before it is sampled.
    pub const fn is_smooth(self) -> bool {
        matches!(self.row().design, Design::Kernel(_))
    }

    /// Whether one shaper serves all modes of an axis, instead of one per mode and their convolution.
    pub const fn treats_modes_together(self) -> bool {
        matches!(self.row().design, Design::Axis(_) | Design::Fixed(_))
    }

    /// Whether the impulses depend on the modes: an axis without modes can have only the other kinds.
    pub const fn depends_on_modes(self) -> bool {
        !matches!(self.row().design, Design::Fixed(_))
    }

    /// Residual that the kind promises at a mode; `None` where it promises none there.
    pub fn promised(self, tolerance: f64) -> Option<f64> {
        self.row().promise.at(tolerance)
    }

    /// Whether the kind accepts this key of `[axis.shaper]`, for keys that only some kinds accept.
    pub fn takes(self, key: &str) -> bool {
        self.row().keys.contains(&key)
    }
}

impl fmt::Display for ShaperKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_leads_back_to_its_kind() {
        for &kind in ShaperKind::ALL {
            assert_eq!(ShaperKind::from_name(kind.name()), Some(kind));
            assert!(!kind.row().about.is_empty(), "{kind}");
        }
        assert_eq!(ShaperKind::from_name("zvx"), None);
    }
}
