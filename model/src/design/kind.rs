//! The kinds of shaper by name.

use std::fmt;

/// Every kind of shaper that a machine file may name, in the order in which messages list them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[allow(missing_docs)] // the names are the documentation: those of `Kind::name`
pub enum Kind {
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
    Optimal,
    Custom,
    None,
}

impl Kind {
    /// All kinds with their names in the machine file.
    pub const ALL: [(Kind, &'static str); 26] = [
        (Kind::Zv, "zv"),
        (Kind::Zvd, "zvd"),
        (Kind::Zvdd, "zvdd"),
        (Kind::Zvddd, "zvddd"),
        (Kind::Mzv, "mzv"),
        (Kind::Ei, "ei"),
        (Kind::TwoHumpEi, "two-hump-ei"),
        (Kind::ThreeHumpEi, "three-hump-ei"),
        (Kind::UmZv, "um-zv"),
        (Kind::UmZvd, "um-zvd"),
        (Kind::UmEi, "um-ei"),
        (Kind::PsZv, "ps-zv"),
        (Kind::PsZvd, "ps-zvd"),
        (Kind::PsEi, "ps-ei"),
        (Kind::ZvEi, "zv-ei"),
        (Kind::ZvEi2, "zv-ei-2"),
        (Kind::ZvdEi, "zvd-ei"),
        (Kind::MultiEi, "multi-ei"),
        (Kind::ChebyshevEi, "chebyshev-ei"),
        (Kind::Vibrationless, "vibrationless"),
        (Kind::Antisymmetric, "antisymmetric"),
        (Kind::Simultaneous, "simultaneous"),
        (Kind::Periodic, "periodic"),
        (Kind::Optimal, "optimal"),
        (Kind::Custom, "custom"),
        (Kind::None, "none"),
    ];

    /// The name in the machine file.
    pub fn name(self) -> &'static str {
        Self::ALL
            .iter()
            .find(|(kind, _)| *kind == self)
            .map_or("", |(_, name)| name)
    }

    /// The kind of that name, if there is one.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, n)| *n == name).map(|(kind, _)| *kind)
    }

    /// Whether this version designs the kind; the others parse and end in `not built in this version`.
    pub fn is_built(self) -> bool {
        matches!(
            self,
            Kind::Zv
                | Kind::Zvd
                | Kind::Zvdd
                | Kind::Zvddd
                | Kind::Mzv
                | Kind::Ei
                | Kind::TwoHumpEi
                | Kind::ThreeHumpEi
                | Kind::UmZv
                | Kind::UmZvd
                | Kind::UmEi
                | Kind::PsZv
                | Kind::PsZvd
                | Kind::PsEi
                | Kind::ZvEi
                | Kind::ZvEi2
                | Kind::ZvdEi
                | Kind::MultiEi
                | Kind::ChebyshevEi
                | Kind::Vibrationless
                | Kind::Antisymmetric
                | Kind::Simultaneous
                | Kind::Periodic
                | Kind::Custom
                | Kind::None
        )
    }

    /// Whether one shaper serves all modes of an axis, instead of one per mode and their convolution.
    pub fn treats_modes_together(self) -> bool {
        matches!(
            self,
            Kind::Periodic | Kind::Simultaneous | Kind::Antisymmetric | Kind::Optimal | Kind::Custom | Kind::None
        )
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
