//! The blocks of the command: segments, and shapers for them.

use crate::{Block, CLOCKS, TICK_CLOCKS, TICKS, hold};
use posicast_blocks::cascade::{self as cascade_model, Cascade, CascadeConfig, SampleCascade};
use posicast_blocks::segments::{self as segments_model, ENTRY_WORDS, Entry, Segments};
use posicast_blocks::shaper::{self as shaper_model, MotionShaper, SampleShaper, Shaper, ShaperConfig, ShaperMotion};
use posicast_hdl::{cascade, segments, shaper};
use posicast_taps::{Tap, TapTable};
use std::hint::black_box;

/// Returns a configuration with six taps: ZVD digitised with two taps per impulse.
fn shaper_config() -> ShaperConfig {
    let taps = [(0, 25431), (38, 12000), (39, 18787), (77, 4000), (78, 5317), (79, 1)];
    let tap = |(delay_samples, coefficient)| Tap {
        delay_samples,
        coefficient,
    };
    ShaperConfig::new(32, TapTable::new(16, taps.map(tap).to_vec()).unwrap()).unwrap()
}

/// Returns the command of a tick, which is a ramp.
fn command(tick: u64) -> i64 {
    12_345 * tick as i64
}

/// Returns whether a clock has a strobe: the first one of a tick has.
fn strobe(clock: u64) -> bool {
    clock.is_multiple_of(TICK_CLOCKS)
}

/// Returns a shaper with one sample per tick.
pub(crate) fn shaper() -> Block {
    let config = shaper_config();
    let row = |clock| {
        let inputs = shaper_model::Inputs {
            strobe: strobe(clock),
            x: if strobe(clock) { command(clock / TICK_CLOCKS) } else { 0 },
            ..shaper_model::Inputs::default()
        };
        inputs.to_raw(&config)
    };
    let mut fast = SampleShaper::new(&config);
    Block {
        name: "shaper",
        modules: shaper::emit(&config, "").unwrap(),
        model: Box::new(Shaper::new(&config, 1)),
        inputs: (0..CLOCKS).flat_map(row).collect(),
        fast: Box::new(move || (0..TICKS).map(|tick| fast.push(black_box(command(tick)))).sum()),
    }
}

/// Returns a shaper of position, velocity and acceleration with one sample per tick.
pub(crate) fn shaper_in_motion() -> Block {
    let motion = ShaperMotion {
        channels: 3,
        modulo: false,
    };
    let config = shaper_config().for_motion(motion).unwrap();
    let words = |tick| [command(tick), 12_345 << 8, 0];
    let row = |clock| {
        let [x, velocity, acceleration] = if strobe(clock) {
            words(clock / TICK_CLOCKS)
        } else {
            [0; 3]
        };
        let inputs = shaper_model::Inputs {
            strobe: strobe(clock),
            x,
            x_rates: [velocity, acceleration],
            ..shaper_model::Inputs::default()
        };
        inputs.to_raw(&config)
    };
    let mut fast = MotionShaper::new(&config);
    Block {
        name: "shaper, 3 channels",
        modules: shaper::emit(&config, "").unwrap(),
        model: Box::new(Shaper::new(&config, 1)),
        inputs: (0..CLOCKS).flat_map(row).collect(),
        fast: Box::new(move || {
            let push = |tick| fast.push(black_box(words(tick))).iter().sum::<i64>();
            (0..TICKS).map(push).sum()
        }),
    }
}

/// Returns a cascade of four half-sum stages with one sample per tick.
pub(crate) fn cascade() -> Block {
    let config = CascadeConfig::new(32, vec![20, 30, 40, 50]).unwrap();
    let row = |clock| {
        let inputs = cascade_model::Inputs {
            strobe: strobe(clock),
            x: if strobe(clock) { command(clock / TICK_CLOCKS) } else { 0 },
            ..cascade_model::Inputs::default()
        };
        inputs.to_raw(config.word_bits() as usize)
    };
    let mut fast = SampleCascade::new(&config);
    Block {
        name: "cascade",
        modules: cascade::emit(&config, "").unwrap(),
        model: Box::new(Cascade::new(&config, 1)),
        inputs: (0..CLOCKS).flat_map(row).collect(),
        fast: Box::new(move || (0..TICKS).map(|tick| fast.push(black_box(command(tick)))).sum()),
    }
}

/// Returns segments that move back and forth, with an entry of one tick in every tick.
pub(crate) fn segments() -> Block {
    let input = |clock: u64| {
        let (tick, clock) = (clock / TICK_CLOCKS, clock % TICK_CLOCKS);
        let jerk = [1i64, -1, -1, 1][tick as usize % 4] << 30;
        let entry = Entry {
            ticks: 1,
            motion: segments_model::EntryMotion::Jerk(jerk),
            notify: false,
        };
        let word = (100..100 + ENTRY_WORDS as u64)
            .contains(&clock)
            .then(|| clock as usize - 100);
        let (write, data) = word.map_or((0, 0), |word| (1, u64::from(entry.words()[word])));
        let tick = u64::from(clock == 0 && tick > 0);
        // The inputs are rst, tick, enable, write, word, data, then the settings.
        let word = word.unwrap_or(0) as u64;
        [0, tick, 1, write, word, data, 0, 0, 0, 0, 0, 1 << 24, 0, 0, 0, 0, 0]
    };
    let typed = |clock| segments_model::Inputs::from_raw(&input(clock));
    let events = hold((0..CLOCKS).map(typed));
    let mut fast = Segments::new(1);
    Block {
        name: "segments",
        modules: segments::emit("").unwrap(),
        model: Box::new(Segments::new(1)),
        inputs: (0..CLOCKS).flat_map(input).collect(),
        fast: Box::new(move || {
            let hold = |(inputs, clocks): &(segments_model::Inputs, u64)| {
                fast.hold(black_box(inputs), *clocks);
                i64::from(fast.outputs(0).position)
            };
            events.iter().map(hold).sum()
        }),
    }
}
