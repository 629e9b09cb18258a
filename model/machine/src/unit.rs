//! The unit of an axis's figures in its `[[axis]]`, and the way in which figures are written for people.
//!
//! ```text
//! file's figure · unit = SI figure (m or rad, what everything in this crate computes with) ─► "1.38 µm"
//! ```
//!
//! A figure is shown in the largest unit of its family that leaves a number before the point: a linear axis has nm,
//! µm, mm and m, a rotary one µrad, mrad and rad, or m° and °; revolutions have no smaller unit. A figure that the
//! file gave keeps the file's unit, so that the reader finds it there.
//!
//! ```
//! use posicast_machine::unit::AxisUnit;
//! assert_eq!(AxisUnit::Millimetre.to_si(250.0), 0.25);
//! assert_eq!(AxisUnit::Millimetre.show(1.384e-6, 3), "1.38 µm");
//! assert_eq!(AxisUnit::Millimetre.as_in_file(1.5e-6, "/s"), "0.0015 mm/s");
//! ```

use posicast_shaper::unit::{LEAST, ShownUnit, space, trimmed};
use std::f64::consts::{PI, TAU};
use std::fmt;

/// Digits of a figure of the file; the rounding of a conversion to SI and back lies below them.
const FILE_DIGITS: usize = 7;
const LENGTHS: [ShownUnit; 4] = [
    ShownUnit::new("nm", 1e9),
    ShownUnit::new("µm", 1e6),
    ShownUnit::new("mm", 1e3),
    ShownUnit::new("m", 1.0),
];
const ANGLES: [ShownUnit; 3] = [
    ShownUnit::new("µrad", 1e6),
    ShownUnit::new("mrad", 1e3),
    ShownUnit::new("rad", 1.0),
];
const DEGREES: [ShownUnit; 2] = [ShownUnit::new("m°", 180e3 / PI), ShownUnit::new("°", 180.0 / PI)];
const REVOLUTIONS: [ShownUnit; 1] = [ShownUnit::new("rev", 1.0 / TAU)];

/// The unit of an axis, `unit` of `[[axis]]`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum AxisUnit {
    /// Metre, `m`.
    #[default]
    Metre,
    /// Millimetre, `mm`.
    Millimetre,
    /// Micrometre, `um`.
    Micrometre,
    /// Radian, `rad`.
    Radian,
    /// Milliradian, `mrad`.
    Milliradian,
    /// Degree, `deg`.
    Degree,
    /// Whole turn, `rev`.
    Revolution,
}

impl AxisUnit {
    /// Every unit with its name in the machine file.
    pub const ALL: [(Self, &str); 7] = [
        (Self::Metre, "m"),
        (Self::Millimetre, "mm"),
        (Self::Micrometre, "um"),
        (Self::Radian, "rad"),
        (Self::Milliradian, "mrad"),
        (Self::Degree, "deg"),
        (Self::Revolution, "rev"),
    ];

    /// Name of the unit in the machine file and in JSON.
    pub fn name(self) -> &'static str {
        Self::ALL
            .into_iter()
            .find(|(unit, _)| *unit == self)
            .map_or("", |(_, name)| name)
    }

    /// Symbol of the unit for people.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Micrometre => "µm",
            Self::Degree => "°",
            other => other.name(),
        }
    }

    /// The unit in which figures are computed: `m` or `rad`.
    pub fn si_name(self) -> &'static str {
        match self {
            Self::Metre | Self::Millimetre | Self::Micrometre => "m",
            Self::Radian | Self::Milliradian | Self::Degree | Self::Revolution => "rad",
        }
    }

    /// How many of the unit make one m or rad.
    pub fn per_si(self) -> f64 {
        match self {
            Self::Metre | Self::Radian => 1.0,
            Self::Millimetre | Self::Milliradian => 1e3,
            Self::Micrometre => 1e6,
            Self::Degree => 180.0 / PI,
            Self::Revolution => 1.0 / TAU,
        }
    }

    /// Converts a length or angle of the file to m or rad; also a velocity, acceleration or jerk.
    pub fn to_si(self, figure: f64) -> f64 {
        // A quotient of the file's figure is rounded once: 0.1 mm is exactly the 0.0001 m that a file in m would
        // give.
        figure / self.per_si()
    }

    /// Converts a length or angle in m or rad to this unit.
    pub fn from_si(self, figure: f64) -> f64 {
        figure * self.per_si()
    }

    /// Converts to this unit and removes the rounding of the conversion: the result is the figure that stands in the
    /// file.
    pub fn in_file(self, figure: f64) -> f64 {
        self.without_rounding(self.from_si(figure))
    }

    /// Converts counts per m or rad to counts per unit of the file.
    pub fn counts_in_file(self, counts: f64) -> f64 {
        self.without_rounding(self.to_si(counts))
    }

    /// A figure without its last digits, which a conversion to another unit and back may change.
    fn without_rounding(self, figure: f64) -> f64 {
        if self.per_si() == 1.0 {
            figure
        } else {
            format!("{figure:.13e}").parse().unwrap_or(figure)
        }
    }

    /// Writes a figure of the file with its unit, as it stands there. `per` follows the unit, such as `/s²` for an
    /// acceleration.
    pub fn as_in_file(self, figure: f64, per: &str) -> String {
        let number = trimmed(self.from_si(figure), FILE_DIGITS);
        format!("{number}{}{}{per}", self.space(), self.symbol())
    }

    /// Writes a figure in m or rad with `digits` significant digits, in the unit of its size.
    pub fn show(self, figure: f64, digits: usize) -> String {
        self.for_size(figure).show(figure, digits)
    }

    /// Writes a round figure, such as a speed that was chosen, without zeros at its end. `per` follows the unit.
    pub fn show_round(self, figure: f64, per: &str) -> String {
        let unit = self.for_size(figure);
        format!("{}{}{}{per}", trimmed(unit.of(figure), 3), unit.space(), unit.symbol())
    }

    /// The unit that shows a figure of this size, in m or rad, with a number before the point.
    pub fn for_size(self, figure: f64) -> ShownUnit {
        let family: &[ShownUnit] = match self {
            Self::Metre | Self::Millimetre | Self::Micrometre => &LENGTHS,
            Self::Radian | Self::Milliradian => &ANGLES,
            Self::Degree => &DEGREES,
            Self::Revolution => &REVOLUTIONS,
        };
        let fits = |unit: &&ShownUnit| unit.of(figure).abs() >= 1.0;
        let largest_that_fits = family.iter().rev().find(fits);
        // Zero, NaN and infinity get the second unit of a family of four.
        let otherwise = match (figure == 0.0 || !figure.is_finite(), family) {
            (true, [_, middle, _, _]) => *middle,
            _ => family[0],
        };
        largest_that_fits
            .copied()
            .filter(|_| figure.is_finite())
            .unwrap_or(otherwise)
    }

    /// One unit for figures that are shown side by side: that of the largest.
    pub fn for_largest(self, figures: impl IntoIterator<Item = f64>) -> ShownUnit {
        self.for_size(figures.into_iter().map(f64::abs).fold(0.0, f64::max))
    }

    /// Writes figures in m or rad that are shown side by side, with three significant digits: all in one unit, except
    /// those that would be less than a thousandth of it.
    pub fn show_all<const N: usize>(self, figures: [f64; N]) -> [String; N] {
        let unit = self.for_largest(figures);
        figures.map(|figure| {
            if unit.of(figure).abs() < LEAST && figure != 0.0 {
                self.show(figure, 3)
            } else {
                unit.show(figure, 3)
            }
        })
    }

    /// Writes figures in m or rad that a sentence compares, with three significant digits: all in the unit of the largest.
    pub fn show_compared<const N: usize>(self, figures: [f64; N]) -> [String; N] {
        let unit = self.for_largest(figures);
        figures.map(|figure| unit.show(figure, 3))
    }

    fn space(self) -> &'static str {
        space(self.symbol())
    }
}

impl fmt::Display for AxisUnit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.symbol())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_figure_of_the_file_becomes_the_si_figure_that_an_engineer_would_write() {
        for (unit, figure, si) in [
            (AxisUnit::Metre, 0.25, 0.25),
            (AxisUnit::Millimetre, 0.1, 1e-4),
            (AxisUnit::Millimetre, 250.0, 0.25),
            (AxisUnit::Micrometre, 50.0, 50e-6),
            (AxisUnit::Radian, 3.0, 3.0),
            (AxisUnit::Milliradian, 2.5, 2.5e-3),
            (AxisUnit::Degree, 180.0, PI),
            (AxisUnit::Revolution, 1.0, TAU),
        ] {
            assert_eq!(unit.to_si(figure), si, "{figure} {unit}");
            assert!((unit.from_si(si) - figure).abs() <= 1e-12 * figure, "{figure} {unit}");
        }
    }

    #[test]
    fn figures_are_shown_in_the_unit_of_their_size() {
        for (unit, figure, text) in [
            (AxisUnit::Metre, 1.384e-6, "1.38 µm"),
            (AxisUnit::Millimetre, 1.384e-6, "1.38 µm"),
            (AxisUnit::Metre, 0.18e-6, "180 nm"),
            (AxisUnit::Metre, 784e-6, "784 µm"),
            (AxisUnit::Metre, -0.005, "-5.00 mm"),
            (AxisUnit::Metre, 1234.5, "1234 m"),
            (AxisUnit::Metre, 0.0, "0 µm"),
            (AxisUnit::Metre, f64::NAN, "NaN µm"),
            (AxisUnit::Metre, 9.996e-6, "10.0 µm"),
            (AxisUnit::Metre, 2e-13, "2.00e-4 nm"),
            (AxisUnit::Radian, 1e-7, "0.100 µrad"),
            (AxisUnit::Milliradian, 2e-5, "20.0 µrad"),
            (AxisUnit::Radian, 3.0, "3.00 rad"),
            (AxisUnit::Degree, 0.5_f64.to_radians(), "500 m°"),
            (AxisUnit::Degree, 12.34_f64.to_radians(), "12.3°"),
            (AxisUnit::Revolution, TAU / 8.0, "0.125 rev"),
        ] {
            assert_eq!(unit.show(figure, 3), text);
        }
        assert_eq!(AxisUnit::Metre.show_round(0.1, "/s"), "100 mm/s");
        assert_eq!(AxisUnit::Degree.show_round(PI, "/s"), "180°/s");
    }

    #[test]
    fn figures_side_by_side_have_the_unit_of_the_largest() {
        let texts = AxisUnit::Metre.show_all([0.18e-6, 0.0203e-6, f64::NAN, 0.0, 4.04e-10, 11.42e-6]);
        assert_eq!(
            texts,
            ["0.180 µm", "0.0203 µm", "NaN µm", "0 µm", "0.404 nm", "11.4 µm"]
        );
        let texts = AxisUnit::Milliradian.show_compared([2.41e-3, 0.4e-6, 19.2e-6]);
        assert_eq!(texts, ["2.41 mrad", "4.00e-4 mrad", "0.0192 mrad"]);
    }

    #[test]
    fn figures_of_the_file_are_shown_as_they_stand_there() {
        for (unit, figure, text) in [
            (AxisUnit::Metre, 0.0001, "0.0001 m"),
            (AxisUnit::Millimetre, 0.3, "300 mm"),
            (AxisUnit::Micrometre, 4.000_1, "4000100 µm"),
            (AxisUnit::Degree, 90.0_f64.to_radians(), "90°"),
            (AxisUnit::Metre, 1e15, "1e15 m"),
            (AxisUnit::Metre, 1e-9, "1e-9 m"),
        ] {
            assert_eq!(unit.as_in_file(figure, ""), text);
        }
        assert_eq!(AxisUnit::Millimetre.as_in_file(4.0, "/s²"), "4000 mm/s²");
    }

    #[test]
    fn every_unit_has_a_name_of_its_own() {
        for (index, (unit, name)) in AxisUnit::ALL.iter().enumerate() {
            assert_eq!(unit.name(), *name);
            assert!(AxisUnit::ALL[..index].iter().all(|(_, other)| other != name));
        }
    }
}
