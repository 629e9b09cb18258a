//! The controllers of a machine's axes: the gains that follow from its file, and what is doubtful about them.

use crate::failure::Failure;
use crate::machine;
use crate::output;
use posicast_model::control::{self, Derived, NoTravel, Schedule, Supervision};
use posicast_model::design::{AxisTables, MachineDesign};
use posicast_model::rtl::sliding_mode::{Law, Row};
use posicast_model::spec::{Axis, Machine, PwmMode};
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;

/// The controller of one axis.
pub(crate) struct AxisControl {
    pub(crate) axis: String,
    pub(crate) lag_s: f64,
    pub(crate) derived: Derived,
    /// The words of the axis's supervisor.
    supervision: Supervision,
    /// Whether the pins have no pattern for a negative command.
    one_sided: bool,
    /// Whether velocity and acceleration are not shaped.
    one_channel: bool,
    /// Where the file does not say how far it goes.
    no_travel: Option<NoTravel>,
}

const ONE_SIDED: &str = "a half bridge shows a negative command as 0: choose direction, full-bridge or locked-antiphase \
                         for mode in [axis.pwm], unless the axis is pushed back by something else";

const ONE_CHANNEL: &str = "the shaper component has the position's channel alone: three take command words of 24 or 32 \
                           bits and delays of at most 4094 samples; the host must give velocity and acceleration shaped";

/// The controllers of the machine that the file at `path` describes: `None` for an axis without.
pub(crate) fn of_machine(
    machine: &Machine,
    design: &MachineDesign,
    path: &Path,
) -> Result<Vec<Option<AxisControl>>, Failure> {
    let of_axis = |(index, (axis, tables)): (usize, (&Axis, &AxisTables))| {
        let (Some(drive), Some(pwm), Some(_)) = (&axis.drive, &axis.pwm, &axis.controller) else {
            return Ok(None);
        };
        let shaper = machine::shaper(machine, axis, tables).ok();
        // Without a shaper there is no hardware: its pass counts nothing.
        let component = shaper.map(|top| machine::component_shaper(axis, &top));
        let shape_clocks = component.as_ref().map_or(0, |c| c.pass_clocks(c.most_products()));
        let schedule = Schedule::controlling(shape_clocks);
        let lag_s = control::loop_lag_s(drive, control::schedule_delay_s(&machine.clock, pwm, schedule.clocks()));
        let derived = control::gains(axis, machine.clock, lag_s)
            .map_err(|error| machine::at_key(path, index, &error.key(), &error))?;
        let supervision = control::supervision(axis, &machine.clock, (&tables.table).into())
            .map_err(|error| machine::at_key(path, index, error.key(), &error))?;
        Ok(Some(AxisControl {
            axis: axis.name.clone(),
            lag_s,
            derived,
            supervision,
            one_sided: pwm.mode == PwmMode::HalfBridge,
            no_travel: control::no_travel(axis),
            one_channel: component.is_some_and(|shaper| shaper.channels() == 1),
        }))
    };
    machine.axes.iter().zip(&design.axes).enumerate().map(of_axis).collect()
}

impl AxisControl {
    /// Says on standard error what is doubtful.
    pub(crate) fn warn(&self) {
        for warning in self.warnings() {
            output::say(&format!("warning: controller of axis `{}`: {warning}", self.axis));
        }
    }

    fn warnings(&self) -> Vec<String> {
        let of_law = self.derived.warnings.iter().map(ToString::to_string);
        let hardware = [(self.one_sided, ONE_SIDED), (self.one_channel, ONE_CHANNEL)];
        let hardware = hardware.into_iter().filter(|(holds, _)| *holds);
        let hardware = hardware.map(|(_, text)| text.to_owned());
        let range = self.no_travel.iter().map(ToString::to_string);
        of_law.chain(hardware).chain(range).collect()
    }

    /// A line for people.
    pub(crate) fn text(&self) -> String {
        format!(
            "  controller {}: loop lag {:.1} µs, friction leaves {:.3} µ of error\n",
            self.law(),
            1e6 * self.lag_s,
            1e6 * self.derived.steady_error
        )
    }

    /// For programs.
    pub(crate) fn json(&self) -> ControlDocument {
        ControlDocument {
            law: self.law(),
            lag_s: self.lag_s,
            steady_error: self.derived.steady_error,
            settings: Row::ALL
                .into_iter()
                .map(|row| SettingDocument {
                    row: format!("{row:?}").to_lowercase(),
                    value: self.derived.gains.get(row),
                    word: self.derived.settings.word(row as usize),
                })
                .collect(),
            supervision: self.supervision.words().into(),
            warnings: self.warnings(),
        }
    }

    fn law(&self) -> &'static str {
        match self.derived.law {
            Law::SlidingMode => "sliding-mode",
            Law::Pd => "pd",
            Law::Pid => "pid",
        }
    }
}

/// An axis's `control` in `design --json` and `report.json`.
#[derive(Serialize)]
pub(crate) struct ControlDocument {
    law: &'static str,
    /// From the position to what the drive does about it.
    lag_s: f64,
    /// Error in m or rad that Coulomb friction leaves.
    steady_error: f64,
    /// By address: what the controller's memory holds after reset.
    settings: Vec<SettingDocument>,
    /// By name: what the axis's supervisor starts with.
    supervision: BTreeMap<&'static str, i64>,
    warnings: Vec<String>,
}

#[derive(Serialize)]
struct SettingDocument {
    row: String,
    /// In counts, ticks and command units.
    value: f64,
    word: u32,
}
