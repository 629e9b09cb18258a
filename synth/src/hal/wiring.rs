//! The HAL file: which pin of LinuxCNC is connected to which of the component.

use super::HalMachine;
use std::fmt::Write;

/// Returns the text of the file.
pub(super) fn text(machine: &HalMachine<'_>) -> String {
    let mut text = format!(
        "# {} in LinuxCNC. Written by posicast; docs/linuxcnc.md has the pins.
loadrt [KINS]KINEMATICS
loadrt [EMCMOT]EMCMOT servo_period_nsec=[EMCMOT]SERVO_PERIOD num_joints=[KINS]JOINTS
loadrt posicast stage=[POSICAST]STAGE
loadrt and2 names=machine-ok

# Positions of this period, LinuxCNC, commands.
addf posicast.read          servo-thread
addf machine-ok             servo-thread
addf motion-command-handler servo-thread
addf motion-controller      servo-thread
addf posicast.write         servo-thread

# LinuxCNC is in estop while the stage's emergency stop line is open, or its link is broken.
net user-enable iocontrol.0.user-enable-out => machine-ok.in0
net stage-ok    posicast.ok                 => machine-ok.in1
net machine-ok  machine-ok.out              => iocontrol.0.emc-enable-in

net tool-prepare iocontrol.0.tool-prepare => iocontrol.0.tool-prepared
net tool-change  iocontrol.0.tool-change  => iocontrol.0.tool-changed

# The stage stops by itself, with the cause watchdog, if the servo thread is silent for so long.
setp posicast.watchdog-ms [POSICAST]WATCHDOG_MS
",
        machine.name
    );
    if machine.captures {
        text.push_str("\n# The touch probe at the stage's capture_line: G38.\nnet probe posicast.probe-input => motion.probe-input\n");
    }
    for (number, axis) in machine.axes.iter().enumerate() {
        let name = axis.name;
        let wires = [
            ("pos-cmd", "joint", "motor-pos-cmd", "posicast", "pos-cmd"),
            ("pos-fb", "posicast", "pos-fb", "joint", "motor-pos-fb"),
            ("enable", "joint", "amp-enable-out", "posicast", "enable"),
            ("fault", "posicast", "fault", "joint", "amp-fault-in"),
            ("home", "posicast", "home", "joint", "home-sw-in"),
            ("limit-plus", "posicast", "limit-plus", "joint", "pos-lim-sw-in"),
            ("limit-minus", "posicast", "limit-minus", "joint", "neg-lim-sw-in"),
        ];
        let _ = writeln!(text, "\n# Axis {name}");
        for (net, from, out, to, into) in wires {
            let _ = writeln!(text, "net {name}-{net} {from}.{number}.{out} => {to}.{number}.{into}");
        }
        // Both sides write this pin: LinuxCNC arms the index, and the component reports that it has come.
        let _ = writeln!(
            text,
            "net {name}-index joint.{number}.index-enable <=> posicast.{number}.index-enable"
        );
    }
    text
}
