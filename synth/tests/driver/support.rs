//! The driver of the example's stage in a folder, and C compilers.

use posicast_blocks::component::Component;
use posicast_machine::hardware::{self, MachineStage};
use posicast_machine::machine_file::{self, Machine};
use posicast_machine::motion::TickLimits;
use posicast_machine::plan::design_machine;
use posicast_synth::driver::{AxisData, AxisFamily, FOLDER, StageDriver, component_header, stage_files};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Compiler options that every file of the driver must pass.
pub(crate) const STRICT: [&str; 6] = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror"];

/// Returns the machine of the example.
pub(crate) fn machine() -> Machine {
    machine_file::parse("xy-stage.toml", include_str!("../../../examples/xy-stage.toml")).unwrap()
}

/// Returns the example with a trace memory of 256 samples, and test signals, for its first axis.
pub(crate) fn traced_machine() -> Machine {
    let text = include_str!("../../../examples/xy-stage.toml");
    let text = text.replacen("[axis.pwm]", "[axis.trace]\nsamples = 256\n[axis.pwm]", 1);
    machine_file::parse("xy-stage.toml", &text).unwrap()
}

/// Returns the machine's stage.
pub(crate) fn stage(machine: &Machine) -> MachineStage {
    hardware::stage(machine, &design_machine(machine).unwrap())
        .unwrap()
        .unwrap()
}

/// The driver of a machine, written into a folder.
pub(crate) struct Driver {
    pub(crate) machine: Machine,
    folder: tempfile::TempDir,
}

impl Driver {
    /// Writes the driver of the example.
    pub(crate) fn write() -> Self {
        Self::of(machine())
    }

    pub(crate) fn of(machine: Machine) -> Self {
        let stage = stage(&machine);
        let component = Component::stage(&stage.config).unwrap();
        let axes: Vec<AxisData> = machine
            .axes
            .iter()
            .map(|axis| AxisData {
                unit: axis.unit,
                counts_per_unit: axis.loop_counts_per_file_unit(),
                limits: TickLimits::of_axis(axis, &machine.clock),
            })
            .collect();
        let mut files = stage_files(&StageDriver {
            machine: &machine.name,
            top: "xy_stage_stage",
            map: component.map(),
            config: &stage.config,
            tick_hz: machine.clock.sample_hz,
            axes: &axes,
            families: &AxisFamily::of_machine(&machine, &stage.families),
        });
        files.push(component_header("xy_stage_pwm_avalon", pwm().map()));
        let folder = tempfile::tempdir().unwrap();
        for file in files {
            let path = folder.path().join(&file.path);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, &file.text).unwrap();
        }
        Self { machine, folder }
    }

    pub(crate) fn path(&self) -> PathBuf {
        self.folder.path().join(FOLDER)
    }

    /// Returns the C files of the driver's core.
    pub(crate) fn core(&self) -> Vec<PathBuf> {
        let files = std::fs::read_dir(self.path().join("src")).unwrap();
        let mut files: Vec<PathBuf> = files.map(|file| file.unwrap().path()).collect();
        files.retain(|file| file.extension().is_some_and(|ending| ending == "c"));
        files.sort();
        assert!(files.len() >= 7, "{files:?}");
        files
    }

    /// Builds a program of these files and the core, with strict warnings.
    pub(crate) fn program(&self, name: &str, options: &[&str], files: &[PathBuf]) -> PathBuf {
        let program = self.folder.path().join(name);
        let mut gcc = Command::new("gcc");
        gcc.args(STRICT)
            .args(["-O1", "-fsanitize=undefined", "-fno-sanitize-recover=all"])
            .args(options);
        gcc.arg("-I").arg(self.path().join("inc")).args(files).args(self.core());
        run(gcc.arg("-o").arg(&program));
        program
    }
}

/// Returns a component that is not the stage.
pub(crate) fn pwm() -> Component {
    use posicast_blocks::pwm::{ActiveLow, BridgeMode, PwmConfig};
    let config = PwmConfig::new(ActiveLow::default(), 25, 50).unwrap();
    Component::pwm(config, BridgeMode::HalfBridge, 2500).unwrap()
}

/// Returns the path of a file beside this one.
pub(crate) fn beside(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/driver").join(name)
}

/// Runs a command, and returns its output.
pub(crate) fn run(command: &mut Command) -> String {
    let output = command.output();
    let output = output.unwrap_or_else(|error| panic!("{command:?}: {error}; scripts/install-tools installs it"));
    assert!(
        output.status.success(),
        "{command:?}: {}\n{}{}",
        output.status,
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
    String::from_utf8(output.stdout).unwrap()
}
