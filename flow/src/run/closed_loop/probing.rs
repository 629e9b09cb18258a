//! Homing by a probe: a host moves each axis that has one to its contact, on the simulated machine.

use super::ClosedLoop;
use super::hosted::behind_a_line;
use crate::run::checks::Check;
use posicast_closed_loop::stage_run::StageRunError;
use posicast_host::{HostError, HostedStage, Link, LinkOptions};
use posicast_machine::hardware::StageHardware;
use posicast_machine::machine_file::Machine;
use posicast_machine::plant::axis::PlantOptions;
use posicast_testbench::wording::counted;

/// The contact is at this part of the distance in which the axis searches.
const CONTACT_AT: f64 = 0.2;
/// The position after homing may be off by a step: the motor lags behind its steps.
const MOST_OFF: i64 = 1;

/// Result of homing an axis.
pub(super) struct Probed {
    /// Index of the axis.
    axis: usize,
    /// Steps by which its position is off afterwards; the error says why it was not homed.
    off: Result<i64, String>,
}

/// Homes every axis that has a probe, each on a machine of its own.
pub(super) fn all(machine: &Machine, stage: &StageHardware, seed: u64) -> Result<Vec<Probed>, StageRunError> {
    let axes = (0..machine.axes.len()).filter(|axis| machine.axes[*axis].probe.is_some());
    axes.map(|axis| one(machine, stage, seed, axis)).collect()
}

fn one(machine: &Machine, stage: &StageHardware, seed: u64, axis: usize) -> Result<Probed, StageRunError> {
    let contact = |axis: usize| {
        let probe = machine.axes[axis].probe?;
        Some((probe, probe.side.sign() * CONTACT_AT * probe.within))
    };
    let options = |axis: usize| PlantOptions {
        contact_at: contact(axis).map_or(0.0, |(_, at)| at),
        ..PlantOptions::default()
    };
    let line = behind_a_line(machine, stage, options, seed)?;
    let homed = || -> Result<i64, HostError> {
        let mut host = HostedStage::open(Link::new(line, LinkOptions::default()), machine, stage)?;
        host.switch_on(&[axis], false)?;
        host.home(axis)?;
        let position = host.status()?[axis].position as i64;
        let bench = host.into_link().into_line().bench;
        Ok(contact(axis).map_or(i64::MAX, |(probe, at)| {
            // Where the axis is by its register, and where it is on the machine.
            let counts = |length: f64| (length * machine.axes[axis].counts_per_unit).round() as i64;
            position - counts(probe.position) - (counts(bench.plant(axis).motion().position) - counts(at))
        }))
    };
    Ok(Probed {
        axis,
        off: homed().map_err(|error| error.to_string()),
    })
}

impl ClosedLoop<'_> {
    /// The check of the probes; `None` if there is none.
    pub(super) fn probed(&self) -> Option<Check> {
        let name = "an axis homed by its probe knows its position";
        let axis = |probed: &Probed| self.machine.axes[probed.axis].name.as_str();
        if let Some((probed, error)) = self
            .probed
            .iter()
            .find_map(|probed| Some((probed, probed.off.as_ref().err()?)))
        {
            return Some(Check::new(name, false, format!("axis {}: {error}", axis(probed))));
        }
        let off = |probed: &Probed| probed.off.as_ref().map_or(i64::MAX, |off| off.abs());
        let worst = self.probed.iter().max_by_key(|probed| off(probed))?;
        let detail = format!(
            "{}, each from one start; the farthest, {}, is {} off",
            counted(self.probed.len() as u64, "axis"),
            axis(worst),
            counted(off(worst).unsigned_abs(), "step")
        );
        Some(Check::new(name, off(worst) <= MOST_OFF, detail))
    }
}
