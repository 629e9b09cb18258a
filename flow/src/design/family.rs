//! The table family of an axis whose modes move, in the report of a design.

use crate::plot::{Curve, Panel};
use crate::warning::Warning;
use posicast_machine::machine_file::{AxisSection, FamilySection};
use posicast_machine::plan::{FamilyMember, TableFamily};
use posicast_shaper::analysis::{residual_vibration, tap_impulses};
use posicast_shaper::mode::Mode;
use posicast_shaper::unit::trimmed;
use posicast_testbench::wording::counted;
use schemars::JsonSchema;
use serde::Serialize;

use super::document::TableTap;

/// Number of values at which the residual is drawn.
const POINTS: u32 = 601;
/// Shown range of the residual, in tolerances.
const SHOWN: f64 = 3.0;

/// `family` of an axis in `design --json`. Values of a position are in m or rad.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "Family")]
pub struct DesignFamily {
    /// Name of the variable with which the modes move.
    pub variable: String,
    /// Whether the variable is the position of an axis.
    #[serde(skip)]
    pub is_position: bool,
    /// Range of the variable.
    pub range: [f64; 2],
    /// Index of the table in the ROM, from 0.
    pub nominal: usize,
    /// Number of tables that cover the range.
    pub needed: usize,
    /// Largest rate of change of the variable, per second; absent for a single table.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fastest_per_s: Option<f64>,
    /// The tables, by the variable.
    pub tables: Vec<FamilyTable>,
}

/// A table of a family.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "Member")]
pub struct FamilyTable {
    /// The value of the variable for which it is designed.
    pub value: f64,
    /// The modes there.
    pub modes: Vec<FamilyMode>,
    /// Range in which every mode's residual is within its tolerance.
    pub covers: [f64; 2],
    /// Threshold below which the table before is chosen; absent for the first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub down: Option<f64>,
    /// Threshold above which the table after is chosen; absent for the last.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub up: Option<f64>,
    /// The taps.
    pub taps: Vec<TableTap>,
    /// Mean delay of a command.
    #[serde(skip)]
    pub delay_s: f64,
}

/// A mode at a value of the variable.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "MemberMode")]
pub struct FamilyMode {
    /// Natural frequency.
    pub frequency_hz: f64,
    /// Damping ratio.
    pub damping: f64,
    /// Residual vibration of a step with the integer taps of the table.
    pub residual: f64,
}

/// An axis whose modes move, with its tables.
pub(super) struct FamilyReport<'a> {
    /// Index of the axis, from 0.
    index: usize,
    pub(super) axis: &'a AxisSection,
    pub(super) family: &'a FamilySection,
    pub(super) tables: &'a TableFamily,
    pub(super) sample_hz: f64,
}

impl<'a> FamilyReport<'a> {
    /// `None` where no mode of the axis moves.
    pub(super) fn new(
        index: usize,
        axis: &'a AxisSection,
        tables: Option<&'a TableFamily>,
        sample_hz: f64,
    ) -> Option<Self> {
        Some(Self {
            index,
            axis,
            family: axis.family.as_ref()?,
            tables: tables?,
            sample_hz,
        })
    }

    pub(super) fn json(&self) -> DesignFamily {
        let finite = |value: f64| value.is_finite().then_some(value);
        let members = self.tables.members.iter().map(|member| FamilyTable {
            value: member.value,
            modes: self.modes(member).collect(),
            covers: member.covers,
            down: finite(member.down),
            up: finite(member.up),
            taps: TableTap::of(&member.tables.table),
            delay_s: member.tables.table.mean_delay_samples() / self.sample_hz,
        });
        DesignFamily {
            variable: self.family.variable.clone(),
            is_position: self.family.is_position(),
            range: self.family.range,
            nominal: self.tables.nominal,
            needed: self.tables.needed,
            fastest_per_s: finite(self.tables.fastest_per_s(self.sample_hz)),
            tables: members.collect(),
        }
    }

    fn modes(&self, member: &FamilyMember) -> impl Iterator<Item = FamilyMode> {
        let taps = tap_impulses(&member.tables.table, self.sample_hz);
        self.axis.modes.iter().map(move |mode| {
            let Mode { frequency_hz, damping } = mode.at(member.value);
            FamilyMode {
                frequency_hz,
                damping,
                residual: residual_vibration(&taps, &Mode { frequency_hz, damping }),
            }
        })
    }

    /// Label of the variable's axis in a picture.
    fn axis_label(&self) -> String {
        if self.family.is_position() {
            format!("{}, {}", self.family.variable, self.axis.unit.symbol())
        } else {
            self.family.variable.clone()
        }
    }

    /// A warning where the axis may move faster than its tables follow.
    pub(super) fn warning(&self) -> Option<Warning> {
        let velocity = self.axis.limits?.velocity.filter(|_| self.family.is_position())?;
        let fastest = self.tables.fastest_per_s(self.sample_hz);
        (fastest < velocity).then(|| {
            let text = format!(
                "axis {}: above {} its mode leaves the tolerance of a table before the next one shapes the command: lower limits.velocity, or choose a kind that is shorter or less sensitive",
                self.axis.name,
                self.axis.unit.show_round(fastest, "/s")
            );
            Warning::new(self.index, "axis.limits.velocity", text)
        })
    }

    /// The residual over the variable: of the table that is chosen, and of the one in the ROM alone.
    pub(super) fn panel(&self, machine: &str) -> Panel {
        let [low, high] = self.family.range;
        let worst = |index: usize, value: f64| {
            let taps = tap_impulses(&self.tables.members[index].tables.table, self.sample_hz);
            let modes = self
                .axis
                .modes
                .iter()
                .map(|mode| residual_vibration(&taps, &mode.at(value)));
            100.0 * modes.fold(0.0, f64::max)
        };
        let shown = |value: f64| {
            if self.family.is_position() {
                self.axis.unit.from_si(value)
            } else {
                value
            }
        };
        let (mut chosen, mut nominal, mut now) = (Vec::new(), Vec::new(), 0);
        for point in 0..POINTS {
            let value = low + (high - low) * f64::from(point) / f64::from(POINTS - 1);
            now = self.tables.choose(now, value);
            chosen.push((shown(value), worst(now, value)));
            nominal.push((shown(value), worst(self.tables.nominal, value)));
        }
        let tolerances = self
            .axis
            .modes
            .iter()
            .map(|mode| 100.0 * self.axis.shaped().tolerance_of(mode));
        let tolerance = tolerances.fold(0.0, f64::max);
        let line = vec![(shown(low), tolerance), (shown(high), tolerance)];
        Panel {
            title: format!(
                "{machine}, axis {}: residual vibration while {} changes",
                self.axis.name, self.family.variable
            ),
            x_label: self.axis_label(),
            y_label: "residual vibration of the worst mode, %".into(),
            curves: vec![
                Curve::new(
                    format!(
                        "{}, handed over on the way up",
                        counted(self.tables.members.len() as u64, "table")
                    ),
                    chosen,
                ),
                Curve::beside("the table in the ROM alone".to_owned(), nominal),
                Curve::limit(format!("tolerance {} %", trimmed(tolerance, 3)), line),
            ],
            y_range: Some((0.0, SHOWN * tolerance)),
            ..Panel::default()
        }
    }
}
