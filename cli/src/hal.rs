//! `posicast generate --hal`: the files for LinuxCNC.

use crate::failure::Failure;
use crate::machine::at_key;
use crate::output;
use posicast_machine::hardware::NAME_KEY;
use posicast_machine::machine_file::Machine;
use posicast_machine::plan::MachineDesign;
use posicast_synth::hal::{self, HalMachine};
use posicast_synth::package::Package;
use std::path::Path;

/// The options of `generate` for LinuxCNC.
#[derive(clap::Args)]
pub(crate) struct HalArgs {
    /// Also write what LinuxCNC needs: its real-time component, HAL and INI files, tap tables at the servo rate
    #[arg(long)]
    hal: bool,
    /// Rate of LinuxCNC's servo thread in Hz
    #[arg(long, value_name = "HZ", requires = "hal", default_value_t = 1000.0)]
    servo_hz: f64,
}

impl HalArgs {
    /// Adds the files, if they are wanted, of the machine that the file at `path` describes.
    pub(crate) fn add(
        &self,
        package: &mut Package,
        machine: &Machine,
        design: &MachineDesign,
        has_stage: bool,
        path: &Path,
    ) -> Result<(), Failure> {
        if !self.hal {
            return Ok(());
        }
        if !has_stage {
            output::say("note: without a stage, hal/ has the tap tables of posicast_shaper only");
        }
        let servo_hz = self.servo_hz;
        if !(servo_hz.is_finite() && servo_hz > 0.0) {
            return Err(Failure::from(miette::miette!(
                help = "give a rate in Hz, such as 1000",
                "--servo-hz: found {servo_hz}; allowed: above 0"
            )));
        }
        let of_machine = HalMachine::of(machine, design, servo_hz, has_stage)
            .map_err(|error| Failure::from(miette::miette!("--servo-hz: {error}")))?;
        let files = hal::files(&of_machine).map_err(|error| at_key(path, error.axis, NAME_KEY, &error))?;
        for file in files {
            package
                .add(&file.path, file.text.as_bytes())
                .map_err(Failure::because)?;
        }
        Ok(())
    }
}
