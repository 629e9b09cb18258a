//! Random inputs for any block: held for a while, with rare strobes and values that reach deep states.

use posicast_blocks::{Direction, Port};

/// splitmix64 (Steele, Lea, Flood 2014).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut word = self.0;
        word = (word ^ (word >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        word = (word ^ (word >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        word ^ (word >> 31)
    }

    pub(crate) fn below(&mut self, end: u64) -> u64 {
        self.next() % end.max(1)
    }

    pub(crate) fn choice<'a, T>(&mut self, from: &'a [T]) -> &'a T {
        &from[self.below(from.len() as u64) as usize]
    }
}

/// Values of an input, by its name; one of them is taken.
pub(crate) type Hints = &'static [(&'static str, &'static [u64])];

/// Number of clocks per tick; a pass of the controller fits.
pub(crate) const TICK_CLOCKS: u64 = 800;

/// Values of the inputs of a stage and its axes, chosen such that axes move and stop.
pub(crate) const STAGE: Hints = &[
    ("write", &[0, 1]),
    ("word", &[0, 1, 2, 3, 3]),
    ("data", &[0, 0, 3, 1 << 31 | 2, 1 << 30 | 1, 5]),
    ("flush", RARE),
    ("stop_deceleration", &[0, 1 << 24]),
    ("clear_flags", &[1]),
    ("tap_write", RARE),
    ("swap", RARE),
    // Only one line moves, so that no step is illegal.
    ("a", &[0, 1]),
    ("b", &[0]),
    ("differential", &[0]),
    ("filter_clocks", &[0, 3, 9]),
    ("tick", RARE),
    ("divide", RARE),
    ("feed_hold", RARE),
    ("line_mode", &[0]),
    // Positions are arbitrary: without modulo they would always be out of range.
    ("modulo", &[1]),
    ("emergency_stop_n", USUAL),
    ("limit_plus_n", &[1]),
    ("limit_minus_n", &[1]),
    ("drive_ready", USUAL),
    ("axis_enable", &[0, 1, 1, 1]),
    ("axis_start", &[0, 1]),
    ("axis_stop", RARE),
    ("clear_faults", &[0, 1]),
    ("group_stop", &[0]),
    ("group_emergency_stop", &[0]),
    ("scale_illegal", &[0]),
    ("scale_disagreement", &[0]),
    ("off_causes", &[0]),
    ("brake_release_ticks", &[0, 2]),
    ("brake_apply_ticks", &[0, 2]),
    ("settle_ticks", &[0, 2]),
    ("soft_limit_plus", &[0]),
    ("soft_limit_minus", &[0]),
    ("following_error_limit", &[0]),
    ("deviation_limit", &[0]),
    ("saturation_ticks", &[0]),
    ("lost_ticks", &[0]),
    ("watchdog_ticks", &[0]),
    ("pwm_mode", &[1, 2]),
    ("period", &[100]),
    ("pwm_duty", &[0, 50, 90, 0x1_ffc0]),
    ("max_duty", &[400]),
    ("dead_time", &[3]),
    ("minimum_pulse", &[4]),
    ("fault_n", USUAL),
    ("pll_locked", &[1]),
    ("filtered_fault_n", &[3]),
    ("watchdog_periods", &[0]),
    ("clear_trip", &[0, 1]),
];

const RARE: &[u64] = &{
    let mut values = [0; 100];
    values[0] = 1;
    values
};
const USUAL: &[u64] = &{
    let mut values = [1; 100];
    values[0] = 0;
    values
};

/// The inputs of a block.
pub(crate) struct RandomInputs {
    pub(crate) ports: Vec<Port>,
    hints: Hints,
    pub(crate) values: Vec<u64>,
}

impl RandomInputs {
    /// Creates the inputs among these ports.
    pub(crate) fn new(ports: &[Port], hints: Hints) -> Self {
        let inputs = ports.iter().filter(|port| port.direction == Direction::Input);
        let ports: Vec<Port> = inputs.cloned().collect();
        Self {
            values: vec![0; ports.len()],
            ports,
            hints,
        }
    }

    /// Gives some of them new values, and returns for how many clocks they stay.
    pub(crate) fn change(&mut self, random: &mut Random) -> u64 {
        let share = *random.choice(&[2, 8, 40]);
        for at in 0..self.values.len() {
            let resets = self.ports[at].name == "rst" && self.values[at] != 0;
            if resets || random.below(share) == 0 || (self.ports[at].width == 1 && random.below(3) == 0) {
                self.change_one(at, random);
            }
        }
        let longest = *random.choice(&[1, 2, 20, 300, 3000]);
        1 + random.below(longest)
    }

    /// Gives the input of this name a value.
    pub(crate) fn set(&mut self, name: &str, value: u64) {
        let at = self.ports.iter().position(|port| port.name == name);
        self.values[at.unwrap_or_else(|| panic!("there is no input {name}"))] = value;
    }

    /// Gives one of them a new value.
    pub(crate) fn change_one(&mut self, at: usize, random: &mut Random) {
        let port = &self.ports[at];
        let ones = u64::MAX >> (64 - port.width);
        let bare = port.name.trim_start_matches("x_").trim_start_matches("y_");
        let hint = self.hints.iter().find(|(name, _)| *name == bare);
        self.values[at] = match hint {
            Some((_, values)) => *random.choice(values),
            None if port.name == "rst" => u64::from(random.below(40) == 0),
            None if port.width == 1 => u64::from(random.below(5) == 0),
            None => match random.below(4) {
                0 => 0,
                1 => random.below(8) & ones,
                2 => ones >> random.below(port.width.into()),
                _ => random.next() & ones,
            },
        };
    }
}
