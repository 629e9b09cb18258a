//! The blocks of the measurement: an encoder's edges, and the divisions for its velocity.

use crate::{Block, CLOCKS, TICK_CLOCKS};
use posicast_blocks::divider::{DIVISION_CLOCKS, Divider, DividerConfig};
use posicast_blocks::pulse_counter::{Inputs, PulseCounter};
use posicast_hdl::{divider, pulse_counter};
use std::hint::black_box;

/// Returns a pulse counter with an encoder that has an edge every 230 to 370 clocks, glitches of two clocks, and a
/// reversal; a divider answers it.
pub(crate) fn pulse_counter() -> Block {
    let events = encoder();
    let mut inputs = Vec::new();
    for (held, clocks) in &events {
        for clock in 0..*clocks {
            let time_stamp = (held.time_stamp + clock as u32) & 0xff_ffff;
            inputs.extend(Inputs { time_stamp, ..*held }.to_raw());
        }
    }
    let mut counter = PulseCounter::new();
    Block {
        name: "pulse_counter",
        modules: pulse_counter::emit("").unwrap(),
        model: Box::new(PulseCounter::new()),
        inputs,
        fast: Box::new(move || {
            let hold = |(inputs, clocks): &(Inputs, u64)| {
                counter.hold(black_box(inputs), *clocks);
                i64::from(counter.outputs().velocity)
            };
            events.iter().map(hold).sum()
        }),
    }
}

/// Returns the inputs, each with the number of clocks for which it stays.
fn encoder() -> Vec<(Inputs, u64)> {
    let config = DividerConfig::new(TICK_CLOCKS).unwrap();
    let mut counter = PulseCounter::new();
    let mut inputs = Inputs {
        filter_clocks: 5,
        smoothing: 2,
        timeout: 8,
        ..Inputs::default()
    };
    let mut events = Vec::new();
    let mut angle = 0usize;
    let mut edge_at = 300;
    let mut clock = 0;
    while clock < CLOCKS {
        if clock == edge_at {
            // The encoder counts up in the first half and down in the second.
            angle += if clock < CLOCKS / 2 { 1 } else { 3 };
            (inputs.a, inputs.b) = [(false, false), (true, false), (true, true), (false, true)][angle % 4];
            edge_at += 230 + clock % 141;
        }
        inputs.z = angle % 400 < 2 || clock % TICK_CLOCKS == 700;
        inputs.tick = clock % TICK_CLOCKS == TICK_CLOCKS - 1;
        inputs.quotient_valid = clock % TICK_CLOCKS == u64::from(DIVISION_CLOCKS);
        let shown = counter.outputs();
        inputs.quotient = config.divide(shown.steps, shown.elapsed).0 as i32;
        inputs.time_stamp = clock as u32 & 0xff_ffff;
        counter.step(&inputs);
        match events.last_mut() {
            Some((held, clocks)) if same_but_for_time(held, &inputs) => *clocks += 1,
            _ => events.push((inputs, 1)),
        }
        clock += 1;
    }
    events
}

fn same_but_for_time(held: &Inputs, inputs: &Inputs) -> bool {
    let time_stamp = held.time_stamp;
    Inputs { time_stamp, ..*inputs } == *held
}

/// Returns a divider with the divisions of four channels after every tick.
pub(crate) fn divider() -> Block {
    let config = DividerConfig::new(TICK_CLOCKS).unwrap();
    let operands = |clock: u64| {
        let division = clock % TICK_CLOCKS;
        let starts = division.is_multiple_of(110) && division < 440;
        starts.then(|| (clock as i32 % 77 - 38, 4000 + clock as u32 % 2000))
    };
    let row = |clock| {
        let (steps, elapsed) = operands(clock).unwrap_or_default();
        let start = u64::from(operands(clock).is_some());
        [0, start, steps as u64 & 0x3_ffff, u64::from(elapsed), 0]
    };
    let divisions: Vec<(i32, u32)> = (0..CLOCKS).filter_map(operands).collect();
    Block {
        name: "divider",
        modules: divider::emit(&config, "").unwrap(),
        model: Box::new(Divider::new(&config)),
        inputs: (0..CLOCKS).flat_map(row).collect(),
        fast: Box::new(move || {
            let divide = |&(steps, elapsed): &(i32, u32)| config.divide(black_box(steps), black_box(elapsed)).0;
            divisions.iter().map(divide).sum()
        }),
    }
}
