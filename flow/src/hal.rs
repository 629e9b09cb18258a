//! `posicast generate --hal`: the files for LinuxCNC.

use crate::failure::Failure;
use crate::machine::at_key;
use crate::observer::Observer;
use posicast_machine::hardware::NAME_KEY;
use posicast_machine::machine_file::Machine;
use posicast_machine::plan::MachineDesign;
use posicast_synth::hal::{self, HalMachine};
use posicast_synth::package::Package;
use std::path::Path;

/// Default rate of LinuxCNC's servo thread in Hz.
pub const SERVO_HZ: f64 = 1000.0;

/// Adds the files for a servo thread of `servo_hz` for the machine that the file at `path` describes.
pub(crate) fn add(
    package: &mut Package,
    servo_hz: f64,
    (machine, path): (&Machine, &Path),
    design: &MachineDesign,
    has_stage: bool,
    observer: &dyn Observer,
) -> Result<(), Failure> {
    if !has_stage {
        observer.say("note: without a stage, hal/ has the tap tables of posicast_shaper only");
    }
    if !(servo_hz.is_finite() && servo_hz > 0.0) {
        return Err(
            Failure::input(format!("--servo-hz: found {servo_hz}; allowed: above 0"))
                .with_help("give a rate in Hz, such as 1000"),
        );
    }
    let of_machine = HalMachine::of(machine, design, servo_hz, has_stage)
        .map_err(|error| Failure::input(format!("--servo-hz: {error}")))?;
    let files = hal::files(&of_machine).map_err(|error| at_key(path, error.axis, NAME_KEY, &error))?;
    for file in files {
        package
            .add(&file.path, file.text.as_bytes())
            .map_err(Failure::because)?;
    }
    Ok(())
}
