//! Seeded inputs for the error table.
//!
//! A run begins with directed scenes, which reach every event three times, whatever the seed is. Then a random mixture follows: an axis
//! that creeps over the table, beyond both of its ends and to those of its word; bank 1 loaded as it should be and otherwise, also while
//! it is in use; enabled and not, homed and not; passes that begin before the previous one is over.

use posicast_blocks::error_table::{ErrorTableConfig, FULL_WEIGHT, INPUT_PORTS, Inputs, OUTPUT_PORTS, Outputs};
use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::lockstep::Clock;
use crate::stimuli::Stimuli;
use crate::stimuli::table::pick;

/// Where positions are drawn from.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
enum Where {
    #[default]
    Table,
    Ends,
    Word,
    /// Both ends of the position's word in turn, so that the sum is cut at each.
    BothCuts,
}

/// A directed period of a run. Each begins with weight 0 and, except for [`Scene::Full`], ends with the drive off.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Scene {
    /// After a reset, a host loads bank 1 completely, after an entry out of turn, which is refused.
    Load,
    /// Bank 1 in sixteenths at the reference, at both ends of the word. While the weight is not 0, the origin changes,
    /// the axis is not homed for two passes, and an entry of the bank in use is written, which is refused.
    LoadedBank,
    /// The machine's bank at the measured position, in and around the table.
    MachineBank,
    /// Each pass begins one clock before the previous one is over.
    TooEarly,
    /// So many passes that the whole error counts.
    Full,
}

/// A run begins with this many rounds of these scenes, and then [`Scene::Full`].
const ROUNDS: usize = 3;
const ROUND: [Scene; 4] = [Scene::Load, Scene::LoadedBank, Scene::MachineBank, Scene::TooEarly];

/// Number of passes of a directed period.
const SCENE_PASSES: u32 = 24;
/// A host writes an entry of [`Scene::Load`] once in this many clocks.
const LOAD_CLOCKS: u32 = 3;

/// Settings of the stimuli that hold for `clocks` clocks.
#[derive(Debug, Clone, Copy, Default)]
struct Life {
    clocks: u32,
    pace: u32,
    on_measured: bool,
    coarse: bool,
    origin: i32,
    positions: Where,
    /// A disturbance happens once in so many clocks.
    off_pace: u32,
    write_pace: u32,
    scene: Option<Scene>,
}

/// A mixture of everything, without end.
#[derive(Debug, Clone)]
pub struct ErrorTableRandom {
    rng: Xoshiro256PlusPlus,
    config: ErrorTableConfig,
    clock: u64,
    lives: usize,
    /// Number of passes begun so far.
    passes: u64,
    life: Life,
    inputs: Inputs,
    /// Next entry to be loaded, and the one before.
    next: u16,
    before: i32,
}

impl ErrorTableRandom {
    /// Equal seeds give equal inputs.
    pub fn new(config: &ErrorTableConfig, seed: u64) -> Self {
        Self {
            rng: Xoshiro256PlusPlus::seed_from_u64(seed),
            config: config.clone(),
            clock: 0,
            lives: 0,
            passes: 0,
            life: Life::default(),
            inputs: Inputs::default(),
            next: 0,
            before: 0,
        }
    }

    fn new_life(&mut self) {
        let rng = &mut self.rng;
        let latency = self.config.latency_clocks();
        // Weights reach their end within 1024 passes.
        let long = 3 * latency * u32::from(FULL_WEIGHT) / 2;
        let any = rng.random_range(-(1 << 21)..1 << 21);
        let anywhere = rng.next_u32() as i32;
        self.life = Life {
            clocks: *pick(rng, &[500, 2000, 20_000, long, long]),
            pace: *pick(rng, &[latency + 1, latency, latency, latency - 1, 2 * latency, 40]),
            on_measured: rng.random_range(0..2) == 0,
            coarse: rng.random_range(0..3) == 0,
            origin: *pick(rng, &[0, any, any, any, anywhere]),
            positions: *pick(rng, &[Where::Table, Where::Table, Where::Ends, Where::Word]),
            off_pace: *pick(rng, &[1000, 30_000, 1 << 30, 1 << 30]),
            write_pace: *pick(rng, &[3, 40, 1 << 30]),
            scene: None,
        };
        self.inputs = Inputs {
            on_measured: self.life.on_measured,
            coarse: self.life.coarse,
            origin: self.life.origin,
            drive_enable: true,
            homed: true,
            error_enable: true,
            error_select: rng.random_range(0..2) == 0,
            ..Inputs::default()
        };
        match self.lives {
            rounds if rounds < ROUNDS * ROUND.len() => self.direct(ROUND[rounds % ROUND.len()]),
            last if last == ROUNDS * ROUND.len() => self.direct(Scene::Full),
            _ => {}
        }
        self.lives += 1;
    }

    /// Replaces what was drawn for a period by what its scene requires.
    fn direct(&mut self, scene: Scene) {
        let latency = self.config.latency_clocks();
        let entries = u32::from(self.config.last()) + 1;
        let loaded = scene == Scene::LoadedBank;
        let clocks = match scene {
            Scene::Load => LOAD_CLOCKS * (entries + 1),
            Scene::Full => (u32::from(FULL_WEIGHT) + SCENE_PASSES) * latency,
            _ => SCENE_PASSES * latency,
        };
        self.life = Life {
            clocks,
            pace: if scene == Scene::TooEarly { latency - 1 } else { latency },
            on_measured: scene == Scene::MachineBank,
            coarse: loaded,
            origin: 0,
            positions: if loaded { Where::BothCuts } else { Where::Table },
            off_pace: 1 << 30,
            write_pace: 1 << 30,
            scene: Some(scene),
        };
        self.inputs = Inputs {
            on_measured: self.life.on_measured,
            coarse: loaded,
            drive_enable: true,
            homed: true,
            error_enable: scene != Scene::Load,
            error_select: loaded,
            ..Inputs::default()
        };
    }

    /// Changes the inputs in the course of a scene.
    fn go_on_with(&mut self, scene: Scene) {
        let (left, latency) = (self.life.clocks, self.config.latency_clocks());
        if scene == Scene::LoadedBank {
            match left {
                _ if left == 12 * latency => self.inputs.origin = 100,
                _ if left == 8 * latency => self.inputs.homed = false,
                _ if left == 6 * latency => self.inputs.homed = true,
                _ if left == 5 * latency => self.loads(self.config.last().into()),
                _ => {}
            }
        }
        if scene != Scene::Full && left <= 2 * latency {
            self.inputs.drive_enable = false;
        }
        if scene == Scene::Load && left.is_multiple_of(LOAD_CLOCKS) {
            self.loads(left / LOAD_CLOCKS);
        }
    }

    /// Writes an entry of bank 1; `left` more follow it. The first entry is positive, the last one is negative, and no two differ by more
    /// than the largest step. Entry 1 is written before the first one, which is out of turn.
    fn loads(&mut self, left: u32) {
        let half = self.config.format().most_step() / 2;
        let any = self.rng.random_range(-half..=half);
        let last = self.config.last();
        self.inputs.error_write = true;
        self.inputs.error_bank = true;
        self.inputs.error_index = u32::from(last).checked_sub(left).map_or(1, |index| index as u8);
        self.inputs.error_entry = match self.inputs.error_index {
            0 => half,
            index if index == last => -half,
            _ => any,
        };
    }

    /// A position near the table, in 256ths of a count.
    fn position(&mut self) -> i64 {
        let format = self.config.format();
        let (rng, spacing) = (&mut self.rng, 1i64 << (format.spacing_bits + 8));
        let length = spacing * i64::from(self.config.last());
        let from_first = match self.life.positions {
            Where::Table => rng.random_range(-spacing..length + spacing),
            Where::Ends => {
                let entry = spacing * rng.random_range(0..=i64::from(self.config.last()));
                let end = *pick(rng, &[0, length, entry]);
                end + rng.random_range(-300..=300)
            }
            Where::BothCuts if self.passes.is_multiple_of(2) => return i32::MAX.into(),
            Where::BothCuts => return i32::MIN.into(),
            Where::Word => return *pick(rng, &[i32::MAX.into(), i32::MIN.into(), 0]) + rng.random_range(-5000..=5000),
        };
        from_first + (i64::from(self.life.origin) + i64::from(format.first_counts)) * 256
    }

    /// A write, mostly of the entry that is next.
    fn writes(&mut self) {
        let rng = &mut self.rng;
        let most = self.config.format().most_step();
        // A table is complete now and then, however long it is.
        let index = match rng.random_range(0..3 * (u32::from(self.config.last()) + 1)) {
            0 => rng.next_u32() as u8,
            1 => 0,
            _ => self.next as u8,
        };
        let any = rng.random_range(-most..=most);
        let step = *pick(rng, &[most, -most, most / 2, -1, 0, any]);
        let too_much = i32::from(rng.random_range(0..60) == 0);
        let entry = self.before + step + too_much * step.signum();
        let bound = 1 << 17;
        self.inputs.error_write = true;
        self.inputs.error_bank = rng.random_range(0..40) != 0;
        self.inputs.error_index = index;
        self.inputs.error_entry = entry.clamp(-bound, bound - 1);
        if self.inputs.error_bank && u16::from(index) == self.next && too_much == 0 || index == 0 {
            self.before = self.inputs.error_entry;
            self.next = (u16::from(index) + 1) % (u16::from(self.config.last()) + 1);
        }
    }
}

impl Stimuli for ErrorTableRandom {
    fn fill(&mut self, _seen: &[u64], inputs: &mut [u64]) {
        let Ok(inputs) = <&mut [u64; INPUT_PORTS]>::try_from(inputs) else {
            return;
        };
        let ends = self.life.clocks == 0;
        if ends {
            self.new_life();
        }
        self.life.clocks -= 1;
        let mixes = self.life.scene.is_none();
        let begins = match self.life.scene {
            Some(scene) => scene == Scene::Load,
            None => self.rng.random_range(0..3) == 0,
        };
        self.inputs.rst = self.clock < 2 || ends && begins;
        let life = self.life;
        let once_in = |rng: &mut Xoshiro256PlusPlus, pace: u32| rng.random_range(0..pace) == 0;
        let early = mixes && once_in(&mut self.rng, 50 * life.pace);
        self.inputs.valid = self.clock.is_multiple_of(life.pace.into()) || early;
        self.passes += u64::from(self.inputs.valid);
        if self.inputs.valid || once_in(&mut self.rng, 2000) {
            self.inputs.position_reference = self.position().clamp(i32::MIN.into(), i32::MAX.into()) as i32;
            self.inputs.measured = (self.position() >> 8) as i32;
        }
        if once_in(&mut self.rng, life.off_pace) {
            let which = self.rng.random_range(0..5);
            let flag = match which {
                0 => &mut self.inputs.drive_enable,
                1 => &mut self.inputs.homed,
                2 => &mut self.inputs.error_enable,
                _ => &mut self.inputs.error_select,
            };
            *flag = !*flag;
            if which == 4 {
                self.inputs.origin = self.inputs.origin.wrapping_add(100);
            }
        }
        self.inputs.error_write = false;
        if once_in(&mut self.rng, life.write_pace) {
            self.writes();
        }
        life.scene.into_iter().for_each(|scene| self.go_on_with(scene));
        self.inputs.error_read = !self.inputs.error_write && once_in(&mut self.rng, 60);
        if self.inputs.error_read {
            self.inputs.error_bank = self.rng.random_range(0..3) != 0;
            self.inputs.error_index =
                self.rng.random_range(0..=self.config.last()) + u8::from(self.config.last() < 255);
        }
        *inputs = self.inputs.to_raw();
        self.clock += 1;
    }
}

/// Names of the counted events.
const NAMES: [&str; 20] = [
    "resets",
    "references with weight 0",
    "references with a part of the error",
    "references with all of it",
    "at the reference",
    "at the measured position",
    "below the table",
    "behind the table",
    "in the table",
    "in sixteenths",
    "cut at the upper end",
    "cut at the lower end",
    "passes begun anew",
    "with bank 1",
    "banks taken in turn",
    "weights that the drive made 0",
    "origins that waited",
    "bank 1 complete",
    "entries refused",
    "entries read back",
];

/// Counts of events in a lock step of the error table.
#[derive(Debug, Clone, Default)]
pub struct ErrorTableCoverage {
    first_counts: i32,
    length: i64,
    counts: [u64; NAMES.len()],
    before: Option<(Inputs, Outputs)>,
    /// Count of the first entry in force.
    base: i32,
    runs: bool,
}

impl ErrorTableCoverage {
    /// Starts with all counts at 0.
    pub fn new(config: &ErrorTableConfig) -> Self {
        Self {
            first_counts: config.format().first_counts,
            length: i64::from(config.last()) << (config.format().spacing_bits + 8),
            ..Self::default()
        }
    }

    /// Adds a clock.
    pub fn observe(&mut self, clock: &Clock<'_>) {
        let (Ok(inputs), Ok(shown)) = (
            <&[u64; INPUT_PORTS]>::try_from(clock.inputs).map(Inputs::from_raw),
            <&[u64; OUTPUT_PORTS]>::try_from(clock.expected).map(Outputs::from_raw),
        ) else {
            return;
        };
        let Some((earlier, outputs)) = self.before.replace((inputs, shown)) else {
            return;
        };
        let origin = inputs.origin.wrapping_add(self.first_counts);
        let is_on = shown.error_weight != 0;
        let new = shown.compensated_valid && !inputs.rst;
        let counts = if inputs.on_measured {
            inputs.measured
        } else {
            inputs.position_reference >> 8
        };
        let place = i64::from(counts.wrapping_sub(self.base)) * 256 + i64::from(inputs.position_reference & 0xff);
        let of_table = new && is_on;
        // The sum before it is cut.
        let sum = i64::from(earlier.position_reference) - i64::from(shown.table_error);
        let seen = [
            inputs.rst,
            new && !is_on,
            of_table && shown.error_weight < FULL_WEIGHT,
            of_table && shown.error_weight == FULL_WEIGHT,
            of_table && !inputs.on_measured,
            of_table && inputs.on_measured,
            of_table && place < 0,
            of_table && place >= self.length,
            of_table && (0..self.length).contains(&place),
            of_table && inputs.coarse && shown.table_error != 0,
            of_table && sum > i64::from(i32::MAX),
            of_table && sum < i64::from(i32::MIN),
            inputs.valid && self.runs && !shown.compensated_valid,
            of_table && shown.error_bank_used,
            shown.error_bank_used != outputs.error_bank_used,
            outputs.error_weight > 1 && !is_on,
            is_on && origin != self.base && inputs.valid,
            shown.error_complete && !outputs.error_complete,
            shown.error_refused,
            shown.error_loaded != outputs.error_loaded,
        ];
        for (count, seen) in self.counts.iter_mut().zip(seen) {
            *count += u64::from(seen);
        }
        if inputs.valid && !is_on {
            self.base = origin;
        }
        if inputs.rst {
            self.base = 0;
        }
        self.runs = !inputs.rst && (inputs.valid || self.runs && !shown.compensated_valid);
    }

    /// Returns each event's name and count.
    pub fn counts(&self) -> [(&'static str, u64); NAMES.len()] {
        std::array::from_fn(|bin| (NAMES[bin], self.counts[bin]))
    }
}
