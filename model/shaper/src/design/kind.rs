//! The kinds of shaper and their names.

use std::fmt;

/// Every kind of shaper that a machine file may name, in the order in which messages list them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[allow(missing_docs)] // the names are the documentation: those of `Kind::name`
pub enum ShaperKind {
    Zv,
    Zvd,
    Zvdd,
    Zvddd,
    Mzv,
    Ei,
    TwoHumpEi,
    ThreeHumpEi,
    UmZv,
    UmZvd,
    UmEi,
    PsZv,
    PsZvd,
    PsEi,
    ZvEi,
    ZvEi2,
    ZvdEi,
    MultiEi,
    ChebyshevEi,
    Vibrationless,
    Antisymmetric,
    Simultaneous,
    Periodic,
    SmoothZv,
    SmoothMzv,
    SmoothEi,
    SmoothZvd,
    SmoothSi,
    SmoothZvdEi,
    SmoothTwoHumpEi,
    Optimal,
    Custom,
    None,
}

impl ShaperKind {
    /// All kinds with their names in the machine file.
    pub const ALL: [(ShaperKind, &'static str); 33] = [
        (ShaperKind::Zv, "zv"),
        (ShaperKind::Zvd, "zvd"),
        (ShaperKind::Zvdd, "zvdd"),
        (ShaperKind::Zvddd, "zvddd"),
        (ShaperKind::Mzv, "mzv"),
        (ShaperKind::Ei, "ei"),
        (ShaperKind::TwoHumpEi, "two-hump-ei"),
        (ShaperKind::ThreeHumpEi, "three-hump-ei"),
        (ShaperKind::UmZv, "um-zv"),
        (ShaperKind::UmZvd, "um-zvd"),
        (ShaperKind::UmEi, "um-ei"),
        (ShaperKind::PsZv, "ps-zv"),
        (ShaperKind::PsZvd, "ps-zvd"),
        (ShaperKind::PsEi, "ps-ei"),
        (ShaperKind::ZvEi, "zv-ei"),
        (ShaperKind::ZvEi2, "zv-ei-2"),
        (ShaperKind::ZvdEi, "zvd-ei"),
        (ShaperKind::MultiEi, "multi-ei"),
        (ShaperKind::ChebyshevEi, "chebyshev-ei"),
        (ShaperKind::Vibrationless, "vibrationless"),
        (ShaperKind::Antisymmetric, "antisymmetric"),
        (ShaperKind::Simultaneous, "simultaneous"),
        (ShaperKind::Periodic, "periodic"),
        (ShaperKind::SmoothZv, "smooth_zv"),
        (ShaperKind::SmoothMzv, "smooth_mzv"),
        (ShaperKind::SmoothEi, "smooth_ei"),
        (ShaperKind::SmoothZvd, "smooth_zvd"),
        (ShaperKind::SmoothSi, "smooth_si"),
        (ShaperKind::SmoothZvdEi, "smooth_zvd_ei"),
        (ShaperKind::SmoothTwoHumpEi, "smooth_2hump_ei"),
        (ShaperKind::Optimal, "optimal"),
        (ShaperKind::Custom, "custom"),
        (ShaperKind::None, "none"),
    ];

    /// Name in the machine file.
    pub fn name(self) -> &'static str {
        Self::ALL
            .iter()
            .find(|(kind, _)| *kind == self)
            .map_or("", |(_, name)| name)
    }

    /// The kind with this name; `None` if there is none.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, n)| *n == name).map(|(kind, _)| *kind)
    }

    /// Whether this version designs the kind. The machine file accepts the names of the others, and then reports
    /// `not built in this version`.
    pub fn is_built(self) -> bool {
        matches!(
            self,
            ShaperKind::Zv
                | ShaperKind::Zvd
                | ShaperKind::Zvdd
                | ShaperKind::Zvddd
                | ShaperKind::Mzv
                | ShaperKind::Ei
                | ShaperKind::TwoHumpEi
                | ShaperKind::ThreeHumpEi
                | ShaperKind::UmZv
                | ShaperKind::UmZvd
                | ShaperKind::UmEi
                | ShaperKind::PsZv
                | ShaperKind::PsZvd
                | ShaperKind::PsEi
                | ShaperKind::ZvEi
                | ShaperKind::ZvEi2
                | ShaperKind::ZvdEi
                | ShaperKind::MultiEi
                | ShaperKind::ChebyshevEi
                | ShaperKind::Vibrationless
                | ShaperKind::Antisymmetric
                | ShaperKind::Simultaneous
                | ShaperKind::Periodic
                | ShaperKind::SmoothZv
                | ShaperKind::SmoothMzv
                | ShaperKind::SmoothEi
                | ShaperKind::SmoothZvd
                | ShaperKind::SmoothSi
                | ShaperKind::SmoothZvdEi
                | ShaperKind::SmoothTwoHumpEi
                | ShaperKind::Optimal
                | ShaperKind::Custom
                | ShaperKind::None
        )
    }

    /// Whether the command is convolved with a continuous kernel, which has no impulses before it is sampled.
    pub fn is_smooth(self) -> bool {
        matches!(
            self,
            ShaperKind::SmoothZv
                | ShaperKind::SmoothMzv
                | ShaperKind::SmoothEi
                | ShaperKind::SmoothZvd
                | ShaperKind::SmoothSi
                | ShaperKind::SmoothZvdEi
                | ShaperKind::SmoothTwoHumpEi
        )
    }

    /// Whether one shaper serves all modes of an axis, instead of one per mode and their convolution.
    pub fn treats_modes_together(self) -> bool {
        matches!(
            self,
            ShaperKind::Periodic
                | ShaperKind::Simultaneous
                | ShaperKind::Antisymmetric
                | ShaperKind::Optimal
                | ShaperKind::Custom
                | ShaperKind::None
        )
    }
}

impl fmt::Display for ShaperKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
