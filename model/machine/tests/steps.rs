//! A stage whose axes have steps: the lines at its pins, read as a drive reads them.

use posicast_blocks::component::Component;
use posicast_blocks::composition::Composed;
use posicast_blocks::segments::{Entry, EntryMotion};
use posicast_blocks::sliding_mode::CONTROL_CLOCKS;
use posicast_blocks::{ClockedBlock, Direction};
use posicast_machine::plan::design_machine;
use posicast_machine::{hardware, machine_file};

const TEXT: &str = include_str!("steps.toml");

/// A drive that counts the steps of an axis from its lines.
#[derive(Default)]
struct DriveInput {
    lines: [bool; 2],
    steps: i64,
    /// Steps of this drive that came while it was disabled.
    disabled_steps: u64,
}

impl DriveInput {
    fn step_and_direction(&mut self, [step, direction]: [bool; 2], enabled: bool) {
        if step && !self.lines[0] {
            self.steps += if direction { 1 } else { -1 };
            self.disabled_steps += u64::from(!enabled);
        }
        self.lines = [step, direction];
    }

    fn up_and_down(&mut self, [up, down]: [bool; 2], enabled: bool) {
        let given = i64::from(up && !self.lines[0]) - i64::from(down && !self.lines[1]);
        self.steps += given;
        self.disabled_steps += u64::from(given != 0 && !enabled);
        self.lines = [up, down];
    }
}

/// The model of the stage, its inputs by name, and the drives.
struct Bed {
    component: Component,
    model: Composed,
    inputs: Vec<u64>,
    outputs: Vec<u64>,
    x: DriveInput,
    y: DriveInput,
    tick_clocks: u64,
}

impl Bed {
    fn new() -> Self {
        let machine = machine_file::parse("steps.toml", TEXT).unwrap();
        let config = hardware::stage(&machine, &design_machine(&machine).unwrap())
            .unwrap()
            .unwrap()
            .config;
        let component = Component::stage(&config).unwrap();
        let model = component.model(1);
        let count = |direction| model.ports().iter().filter(|port| port.direction == direction).count();
        let mut bed = Self {
            inputs: vec![0; count(Direction::Input)],
            outputs: vec![0; count(Direction::Output)],
            x: DriveInput::default(),
            y: DriveInput::default(),
            tick_clocks: config.tick.tick_clocks().into(),
            component,
            model,
        };
        bed.set("emergency_stop_n", 1);
        for line in ["limit_plus_n", "limit_minus_n", "drive_ready"] {
            bed.set(&format!("x_{line}"), 1);
            bed.set(&format!("y_{line}"), 1);
        }
        bed.set("rst", 1);
        bed.clocks(2);
        bed.set("rst", 0);
        bed.clocks(20);
        bed
    }

    fn set(&mut self, input: &str, value: u64) {
        let mut inputs = self
            .model
            .ports()
            .iter()
            .filter(|port| port.direction == Direction::Input);
        let place = inputs.position(|port| port.name == input).unwrap();
        self.inputs[place] = value;
    }

    fn pin(&self, output: &str) -> bool {
        let mut outputs = self
            .model
            .ports()
            .iter()
            .filter(|port| port.direction == Direction::Output);
        self.outputs[outputs.position(|port| port.name == output).unwrap()] == 1
    }

    fn clocks(&mut self, clocks: u64) {
        let mut left = clocks;
        while left > 0 {
            left -= self.model.hold(&self.inputs, left, &mut self.outputs).unwrap();
            let enabled = ["x", "y"].map(|axis| self.pin(&format!("{axis}_drive_enable")));
            let lines = ["x_step", "x_direction"].map(|line| self.pin(line));
            self.x.step_and_direction(lines, enabled[0]);
            // The line for steps down is active low.
            let lines = [self.pin("y_step_up"), !self.pin("y_step_down")];
            self.y.up_and_down(lines, enabled[1]);
        }
    }

    fn net(&self, name: &str) -> i64 {
        i64::from(self.model.value(self.model.net(name).unwrap()) as u32 as i32)
    }

    fn write(&mut self, register: &str, place: u32, data: u32) {
        let offset = self.component.map().register(register).unwrap().offset + place;
        self.set("avs_address", offset.into());
        self.set("avs_writedata", data.into());
        self.set("avs_byteenable", 0xf);
        self.set("avs_write", 1);
        self.clocks(1);
        self.set("avs_write", 0);
    }

    fn switch_on(&mut self) {
        for axis in ["x", "y"] {
            self.write(&format!("{axis}_control"), 0, 1);
        }
        for _ in 0..20 {
            self.clocks(self.tick_clocks);
        }
        assert_eq!(["x_can_start", "y_can_start"].map(|net| self.net(net)), [1, 1]);
    }

    /// Moves both axes by jerk-limited entries, and lets the shaped position settle.
    fn moves(&mut self, jerks: [i64; 2], ticks: u32) {
        for (axis, jerk) in ["x", "y"].into_iter().zip(jerks) {
            for (jerk, ticks) in [(jerk, ticks), (-jerk, 2 * ticks), (jerk, ticks)] {
                self.entry(axis, jerk, ticks);
            }
        }
        self.write("start", 0, 3);
        for _ in 0..4 * ticks + 600 {
            self.clocks(self.tick_clocks);
        }
    }

    /// Writes an entry with a constant jerk, in 2^-32 counts per tick³.
    fn entry(&mut self, axis: &str, jerk: i64, ticks: u32) {
        let entry = Entry {
            ticks,
            motion: EntryMotion::Jerk(jerk),
            notify: false,
        };
        for (place, word) in (0..).zip(entry.words()) {
            self.write(&format!("{axis}_segment"), place, word);
        }
    }
}

#[test]
fn the_lines_give_the_steps_of_the_shaped_position() {
    let mut bed = Bed::new();
    bed.switch_on();
    // 2 · J · n³ counts: 2^-10 counts/tick³ for 64 ticks are 512.
    bed.moves([1 << 22, -(1 << 21)], 64);
    assert_eq!(
        [bed.net("x_shaped_position") >> 8, bed.net("y_shaped_position") >> 8],
        [512, -256]
    );
    assert_eq!([bed.x.steps, bed.y.steps], [512, -256]);
    // The pulse counter reads the same lines.
    assert_eq!([bed.net("x_count"), bed.net("y_count")], [512, -256]);
    assert_eq!([bed.net("x_given_steps"), bed.net("y_given_steps")], [512, -256]);
    assert_eq!([bed.x.disabled_steps, bed.y.disabled_steps], [0, 0]);
    assert_eq!(bed.net("x_causes") | bed.net("y_causes"), 0);
}

#[test]
fn an_emergency_stop_ends_the_steps_at_once_and_loses_no_count() {
    let mut bed = Bed::new();
    bed.switch_on();
    for (axis, jerk) in [("x", 1i64 << 22), ("y", 1 << 22)] {
        for (jerk, ticks) in [(jerk, 64), (-jerk, 128), (jerk, 64)] {
            bed.entry(axis, jerk, ticks);
        }
    }
    bed.write("start", 0, 3);
    for _ in 0..200 {
        bed.clocks(bed.tick_clocks);
    }
    let moving = bed.x.steps;
    assert!(moving > 50, "{moving}");
    bed.set("emergency_stop_n", 0);
    bed.clocks(10);
    assert!(!bed.pin("x_drive_enable") && !bed.pin("y_drive_enable"));
    bed.clocks(400);
    let stopped = bed.x.steps;
    assert!(stopped - moving <= 1, "{moving} {stopped}");
    bed.clocks(100 * bed.tick_clocks);
    assert_eq!(bed.x.steps, stopped);
    assert_eq!([bed.net("x_count"), bed.net("y_count")], [bed.x.steps, bed.y.steps]);
    assert_eq!([bed.x.disabled_steps, bed.y.disabled_steps], [0, 0]);
    assert_eq!(bed.net("x_causes") & 1, 1);
}

#[test]
fn a_stage_of_steps_alone_counts_no_controller() {
    let timing = |text: &str| {
        let machine = machine_file::parse("m.toml", text).unwrap();
        let stage = hardware::stage(&machine, &design_machine(&machine).unwrap()).unwrap();
        stage.unwrap().config.timing()
    };
    let steps = timing(TEXT);
    assert_eq!(steps.duty_clocks(), steps.control_clocks());
    let text = steps.to_string();
    assert!(
        text.ends_with(&format!("steps from {0} on: {0} clocks", steps.control_clocks())),
        "{text}"
    );
    let loops = timing(include_str!("../../../examples/xy-stage.toml"));
    assert_eq!(loops.duty_clocks() - loops.control_clocks(), CONTROL_CLOCKS + 2);
}

#[test]
fn steps_that_no_stage_gives_are_an_error() {
    let loopless = TEXT.replacen(
        "[axis.steps]\nmode = \"up_down\"\npulse_s = 2e-6\ndirection_setup_s = 5e-6\nactive_low = [\"step_down\"]\n",
        "",
        1,
    );
    let loopless = loopless.replace("soft_limits_after_homing = true\n", "");
    assert_ne!(loopless, TEXT);
    let machine = machine_file::parse("steps.toml", &loopless).unwrap();
    let hardware = hardware::Hardware::of(&machine, &design_machine(&machine).unwrap()).unwrap();
    let error = hardware.stage().unwrap_err();
    assert_eq!((error.axis, error.key.as_str()), (1, "axis"));
    assert!(
        error
            .reason
            .contains("axis `y` has neither [axis.steps] nor a whole loop"),
        "{}",
        error.reason
    );
}

/// The trace takes its rows from the tick of the steps: there is no controller whose result it could wait for.
#[test]
fn an_axis_with_steps_can_have_a_trace() {
    let text = TEXT.replacen("[axis.steps]", "[axis.trace]\nsamples = 256\n\n[axis.steps]", 1);
    let machine = machine_file::parse("steps.toml", &text).unwrap();
    let stage = hardware::stage(&machine, &design_machine(&machine).unwrap());
    let component = Component::stage(&stage.unwrap().unwrap().config).unwrap();
    let model = component.model(1);
    assert!(model.net("x_trace_rows").is_some() && model.net("y_trace_rows").is_none());
}
