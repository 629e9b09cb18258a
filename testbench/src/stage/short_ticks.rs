//! The bench of a stage with the shortest ticks that its schedule allows, on the stage's own Verilog.
//!
//! A wire between two blocks of a stage changes once per tick. At 5,000 clocks per tick a million clocks are 200 ticks,
//! which are too few for everything that a stage does. So the same files run a second time with other *constants*:
//! clocks per tick, period of the PWM, times of step lines, and the waiting times of the supervisor. Nothing else is changed:
//!
//! ```text
//! emitted with the machine's constants ─┐ line by line
//! emitted with short ticks ─────────────┴─► lines that differ ─► replaced in the files under test, if they are unedited
//! ```
//!
//! A line that was edited stays as it is, and the lock step checks it. A module in which short ticks change more than
//! constants is taken as emitted; its own row and the stage's row at the machine's ticks check it as it is.

use std::collections::HashMap;

use posicast_blocks::ClockedBlock;
use posicast_blocks::absolute_encoder::{AbsoluteEncoderConfig, AbsoluteTimes};
use posicast_blocks::divider::DividerConfig;
use posicast_blocks::stage::{Follower, StageAxis, StageConfig, StageError, StageLoop};
use posicast_blocks::step_generator::{StepGeneratorConfig, StepTimes};
use posicast_hdl::SimulationError;
use posicast_hdl::emit::{EmitError, Module};

use super::BARS;
use super::StageBlock;
use crate::Error;
use crate::blocks::{Bins, Block, Reach, Sources, not_in_rusthdl};
use crate::stimuli::Stimuli;

/// Smallest period of the PWM, as a multiple of dead time plus minimum pulse. Below 2, a leg is never on.
const PERIOD_TO_TIMES: u32 = 4;
/// Smallest period of the PWM in clocks.
const LEAST_PERIOD_CLOCKS: u32 = 80;
/// Longest waiting times of the supervisor in ticks: of the brake, and until a monitor acts. A monitor that is off
/// stays off.
const MOST_WAIT_TICKS: u16 = 4;

/// Times of the lines of an absolute encoder, which answers at once.
const ENCODER_TIMES: AbsoluteTimes = AbsoluteTimes {
    half_period_clocks: 2,
    pause_clocks: 40,
    answer_clocks: 40,
};

/// Number of clocks of the first scenes, which drive most wires.
const LEAST_CLOCKS: u64 = 60_000;

/// A stage with short ticks, with the name of its top module.
#[derive(Debug, Clone)]
pub struct ShortTicksBlock {
    machine: StageBlock,
    short: StageBlock,
    instance: String,
}

impl ShortTicksBlock {
    /// Creates the stage with the top module `top`; returns `None` if its ticks are already as short as its schedule
    /// allows, or if short ticks would change its list of modules.
    ///
    /// # Errors
    /// As `Component::stage`.
    pub fn new(config: &StageConfig, top: &str) -> Result<Option<Self>, StageError> {
        let Some(short) = shortened(config) else {
            return Ok(None);
        };
        let (machine, block) = (StageBlock::new(config, top)?, StageBlock::new(&short, top)?);
        // Files are replaced one by one. A stage that cannot be emitted is an error of the stage's own row.
        let count = |block: &StageBlock| block.modules().map(|modules| modules.len()).ok();
        if count(&machine) != count(&block) {
            return Ok(None);
        }
        Ok(Some(Self {
            machine,
            instance: format!("{}, {} clocks per tick", block.instance(), short.tick.tick_clocks()),
            short: block,
        }))
    }

    /// Returns the stage with short ticks alone, as it is emitted with them.
    pub fn stage(&self) -> &StageBlock {
        &self.short
    }

    /// Sets the prefix of a package: see [`StageBlock::with_prefix`].
    pub fn with_prefix(self, prefix: &str) -> Self {
        Self {
            machine: self.machine.with_prefix(prefix),
            short: self.short.with_prefix(prefix),
            ..self
        }
    }
}

/// The modules of a machine by their names, each with its text as emitted and with other constants.
pub(crate) type Pairs = HashMap<String, (String, String)>;

/// Returns the modules of `machine` by their names, each with its text in `other`, which is the same with other constants. Sizes
/// are part of the names of modules, and those change with the constants.
pub(crate) fn pairs(machine: &dyn Block, other: &dyn Block) -> Result<Pairs, EmitError> {
    let (machine, other) = (machine.modules()?, other.modules()?);
    let names: HashMap<&str, &str> = other
        .iter()
        .zip(&machine)
        .map(|(other, machine)| (other.name.as_str(), machine.name.as_str()))
        .collect();
    let named = |text: &str| {
        let words = text.split_inclusive(|c: char| !(c.is_ascii_alphanumeric() || c == '_'));
        let word = |word: &str| {
            let end = word
                .trim_end_matches(|c: char| !(c.is_ascii_alphanumeric() || c == '_'))
                .len();
            let (name, rest) = word.split_at(end);
            format!("{}{rest}", names.get(name).unwrap_or(&name))
        };
        words.map(word).collect::<String>()
    };
    let pairs = machine.iter().zip(&other);
    Ok(pairs
        .map(|(machine, other)| (machine.name.clone(), (machine.text.clone(), named(&other.text))))
        .collect())
}

/// Returns these files with the other constants, in lines that are still as emitted.
pub(crate) fn adapted(sources: &Sources, pairs: &Pairs) -> Result<Sources, Error> {
    sources.rewritten(|name, text| match pairs.get(name) {
        Some((emitted, other)) => exchanged(text, emitted, other),
        None => text.to_owned(),
    })
}

/// Returns the stage with its shortest tick, if that is less than half of its own.
pub(crate) fn shortened(config: &StageConfig) -> Option<StageConfig> {
    let mut short = config.clone();
    for axis in &mut short.axes {
        if let Some(absolute) = axis.closed_loop_mut().and_then(|of| of.absolute.as_mut()) {
            let of = &absolute.encoder;
            absolute.encoder =
                AbsoluteEncoderConfig::new(of.protocol(), *of.frame(), ENCODER_TIMES, of.limits()).ok()?;
        }
    }
    let times =
        |of: &StageLoop| u32::from(of.pwm.dead_time_floor_clocks()) + u32::from(of.pwm.minimum_pulse_floor_clocks());
    let loops = config.axes.iter().filter_map(StageAxis::closed_loop);
    let least = (PERIOD_TO_TIMES * loops.map(times).max().unwrap_or(0)).max(LEAST_PERIOD_CLOCKS);
    // The tick has as many periods as fit into the schedule, and is not longer than that.
    let readings = short.axes.iter().filter_map(StageAxis::absolute);
    let reading = readings.map(|of| of.encoder.least_tick_clocks() as u32).max();
    let schedule = (short.timing().duty_clocks() + 1).max(reading.unwrap_or(0));
    let periods = (schedule / least).max(1);
    let period = schedule.div_ceil(periods).max(least);
    short.tick = DividerConfig::new(u64::from(periods * period)).ok()?;
    if 2 * short.tick.tick_clocks() > config.tick.tick_clocks() {
        return None;
    }
    for axis in &mut short.axes {
        match &mut axis.follower {
            Follower::Loop(of) => of.pwm_period_clocks = period,
            Follower::Steps(steps) => *steps = shortened_steps(steps, short.tick.tick_clocks())?,
        }
        let watched = &mut axis.supervision;
        for ticks in [
            &mut watched.brake_release_ticks,
            &mut watched.brake_apply_ticks,
            &mut watched.saturation_ticks,
            &mut watched.lost_ticks,
            &mut watched.direct_hold_ticks,
        ] {
            *ticks = (*ticks).min(MOST_WAIT_TICKS);
        }
        watched.direct_limit = watched.direct_limit.min(period as u16 / 2);
    }
    Some(short)
}

/// Returns the step generator for ticks of this many clocks. The times of its lines shrink in proportion, so that a tick has as many
/// steps at the largest rate.
fn shortened_steps(steps: &StepGeneratorConfig, tick_clocks: u32) -> Option<StepGeneratorConfig> {
    let shrunk = |clocks: u64| (clocks * u64::from(tick_clocks) / u64::from(steps.tick_clocks())).max(1);
    let times = steps.times();
    let times = StepTimes {
        pulse_clocks: shrunk(times.pulse_clocks),
        space_clocks: shrunk(times.space_clocks),
        direction_setup_clocks: shrunk(times.direction_setup_clocks),
        direction_hold_clocks: shrunk(times.direction_hold_clocks),
    };
    let limit = u64::from(steps.owed_limit());
    let short = StepGeneratorConfig::new(
        u64::from(tick_clocks),
        steps.fraction_bits(),
        steps.mode(),
        times,
        limit,
    );
    Some(short.ok()?.active_low(steps.lines_active_low()))
}

impl Block for ShortTicksBlock {
    fn name(&self) -> &str {
        self.short.name()
    }

    fn instance(&self) -> &str {
        &self.instance
    }

    fn modules(&self) -> Result<Vec<Module>, EmitError> {
        self.short.modules()
    }

    fn top(&self) -> String {
        self.short.top()
    }

    fn adapted(&self, sources: Sources) -> Result<Sources, Error> {
        adapted(&sources, &pairs(&self.machine, &self.short)?)
    }

    fn model(&self, seed: u64) -> Box<dyn ClockedBlock> {
        self.short.model(seed)
    }

    fn simulate(&self) -> Result<Box<dyn ClockedBlock>, SimulationError> {
        Err(not_in_rusthdl("stage"))
    }

    fn in_rusthdl(&self) -> bool {
        false
    }

    fn stimuli(&self, cycles: u64, seed: u64) -> Box<dyn Stimuli + '_> {
        self.short.stimuli(cycles, seed)
    }

    fn least_clocks(&self) -> u64 {
        LEAST_CLOCKS
    }

    fn reach(&self) -> Box<dyn Reach + '_> {
        Box::new(self.short.reach_with(&self.instance, BARS))
    }

    fn coverage(&self) -> Box<dyn Bins + '_> {
        self.short.coverage()
    }
}

/// Returns `text`, in which lines of `emitted` that differ in `short` are replaced by those of `short`; the k-th
/// occurrence of a line in one belongs to the k-th in the other. Returns `short` if the two differ in their number of
/// lines.
fn exchanged(text: &str, emitted: &str, short: &str) -> String {
    if emitted == short {
        return text.to_owned();
    }
    if emitted.lines().count() != short.lines().count() {
        return short.to_owned();
    }
    let mut others: HashMap<&str, std::collections::VecDeque<&str>> = HashMap::new();
    for (line, other) in emitted.lines().zip(short.lines()) {
        others.entry(line).or_default().push_back(other);
    }
    let mut new = String::with_capacity(text.len());
    for line in text.lines() {
        let other = others.get_mut(line).and_then(std::collections::VecDeque::pop_front);
        new.push_str(other.unwrap_or(line));
        new.push('\n');
    }
    new
}

#[cfg(test)]
mod tests {
    use super::*;

    const EMITTED: &str = "a = 5000;\nb = 1;\nc = d;\na = 5000;\n";
    const SHORT: &str = "a = 300;\nb = 1;\nc = d;\na = 5000;\n";

    #[test]
    fn constants_are_exchanged_and_edits_stay() {
        assert_eq!(exchanged(EMITTED, EMITTED, SHORT), SHORT);
        let edited = EMITTED.replace("c = d;", "c = e;");
        assert_eq!(exchanged(&edited, EMITTED, SHORT), SHORT.replace("c = d;", "c = e;"));
        let constant = EMITTED.replacen("a = 5000;", "a = 4999;", 1);
        assert!(exchanged(&constant, EMITTED, SHORT).contains("a = 4999;"));
        let longer = format!("initial x;\n{EMITTED}");
        assert_eq!(exchanged(&longer, EMITTED, SHORT), format!("initial x;\n{SHORT}"));
    }

    #[test]
    fn another_module_is_taken_whole() {
        assert_eq!(exchanged(EMITTED, EMITTED, "z;\n"), "z;\n");
        assert_eq!(exchanged("edited\n", EMITTED, EMITTED), "edited\n");
    }
}
