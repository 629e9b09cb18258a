//! The controller as a component: law and settings change together, between two passes, whenever the host commits.

use posicast_blocks::component::Component;
use posicast_blocks::composition::Composed;
use posicast_blocks::sliding_mode::{CONTROL_CLOCKS, Gain, Inputs, Law, SettingRow, Settings, SlidingMode, TickMotion};
use posicast_blocks::{ClockedBlock, Direction};

/// Settings whose commands differ for each pair of law and bank: PD with `per_count` for each count.
fn settings(per_count: f64) -> Settings {
    let mut settings = Settings::default();
    let mut set = |row, value| settings.set_gain(row, Gain::nearest(value, row).unwrap());
    set(SettingRow::Proportional, per_count);
    set(SettingRow::Reaching, 16.0 * per_count);
    set(SettingRow::Surface, 1.0);
    set(SettingRow::Feedback, 1.0);
    settings.set_limit(1 << 30);
    settings
}

/// A component whose passes follow each other without a clock between them: its pin `start` is always high.
struct Bench {
    model: Composed,
    component: Component,
    inputs: Vec<u64>,
    outputs: Vec<u64>,
}

impl Bench {
    fn new() -> Self {
        let component = Component::sliding_mode(&settings(0.25), Law::Pd, false).unwrap();
        let model = component.model(3);
        let count = |direction| {
            let ports = model.ports().iter();
            ports.filter(|port| port.direction == direction).count()
        };
        let (inputs, outputs) = (count(Direction::Input), count(Direction::Output));
        let mut bench = Self {
            model,
            component,
            inputs: vec![0; inputs],
            outputs: vec![0; outputs],
        };
        bench.set("position_reference", 10 << 8);
        bench
    }

    fn place(&self, name: &str, direction: Direction) -> usize {
        let mut ports = self.model.ports().iter().filter(|port| port.direction == direction);
        ports.position(|port| port.name == name).unwrap()
    }

    fn set(&mut self, name: &str, value: u64) {
        let place = self.place(name, Direction::Input);
        self.inputs[place] = value;
    }

    /// Advances by a clock; returns the command at the end of a pass.
    fn clock(&mut self) -> Option<i32> {
        self.model.step(&self.inputs, &mut self.outputs).unwrap();
        let shown = |name| self.outputs[self.place(name, Direction::Output)];
        (shown("valid") != 0).then(|| shown("command") as i32)
    }

    fn write(&mut self, register: &str, data: u32) -> Option<i32> {
        let offset = self.component.map().register(register).unwrap().offset;
        for (name, value) in [("avs_address", offset), ("avs_writedata", data), ("avs_byteenable", 15)] {
            self.set(name, value.into());
        }
        self.set("avs_write", 1);
        let command = self.clock();
        self.set("avs_write", 0);
        command
    }
}

/// The commit comes at every distance from the boundary of two passes; each pass must use one law and the bank that
/// belongs to it.
#[test]
fn no_pass_mixes_a_law_with_the_settings_of_another() {
    let tick = |law: Law, settings: &Settings| {
        let mut controller = posicast_blocks::sliding_mode::TickController::default();
        let motion = TickMotion {
            position_reference: 10 << 8,
            ..TickMotion::default()
        };
        controller.control(law, false, &motion, settings).command
    };
    let loaded = settings(0.75);
    let (old, new) = (tick(Law::Pd, &settings(0.25)), tick(Law::SlidingMode, &loaded));
    let mixtures = [tick(Law::Pd, &loaded), tick(Law::SlidingMode, &settings(0.25))];
    assert!(old != new && !mixtures.contains(&old) && !mixtures.contains(&new));

    for distance in 0..2 * CONTROL_CLOCKS {
        let mut bench = Bench::new();
        bench.write("control", 1);
        for row in 0..16 {
            bench.write("setting_address", row | 1 << 8);
            bench.write("setting", loaded.word(row as usize));
        }
        bench.write("law", Law::SlidingMode as u32 | 1 << 8);
        bench.set("start", 1);
        while bench.clock().is_none() {}
        let mut commands: Vec<i32> = (0..distance).filter_map(|_| bench.clock()).collect();
        commands.extend(bench.write("commit", 1));
        while commands.len() < 5 {
            commands.extend(bench.clock());
        }
        let changes = commands.iter().position(|command| *command != old).unwrap();
        assert!(changes <= 3, "{distance}: {commands:?}");
        assert!(
            commands[changes..].iter().all(|command| *command == new),
            "{distance}: {commands:?} is neither {old} nor {new}"
        );
    }
}

/// The clear comes in any clock of a pass: from the first clock of step 14 on, in which the sum of Σe and e begins,
/// this e is dropped.
#[test]
fn a_clear_of_the_integral_drops_the_sum_under_way_and_no_other() {
    let mut settings = settings(0.0);
    settings.set_gain(SettingRow::Integral, Gain::nearest(1.0, SettingRow::Integral).unwrap());
    // Number of the clock in which step 14 of a pass begins; the clock after `start` is 1.
    let sum_begins = 454;
    for clear in 0..=CONTROL_CLOCKS {
        let mut controller = SlidingMode::new();
        let mut address = 0;
        let mut commands = Vec::new();
        for clock in 0..3 * CONTROL_CLOCKS + 1 {
            let shown = controller.step(&Inputs {
                start: clock % CONTROL_CLOCKS == 0,
                law: Law::Pid as u8,
                position_reference: 3 << 8,
                setting: settings.word(address),
                clear_integral: clock == clear + CONTROL_CLOCKS,
                ..Inputs::default()
            });
            address = usize::from(shown.setting_address);
            commands.extend(shown.valid.then_some(shown.command));
        }
        // The third pass finds the e of the second in the integral, or nothing.
        let found = i32::from(clear < sum_begins);
        assert_eq!(commands[2], found * 3 * 4096, "cleared in clock {clear}: {commands:?}");
    }
}
