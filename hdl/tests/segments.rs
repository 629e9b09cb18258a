//! The command FIFO in RustHDL's simulator compared with its model.

use crate::random;

use posicast_blocks::ClockedBlock;
use posicast_blocks::segments::{CUBIC, INPUT_PORTS, MORE, OUTPUT_PORTS, POINT, Segments, ports};
use posicast_hdl::segments::{emit, simulate};
use random::Random;

#[test]
fn lockstep_everything_at_random() {
    let mut model = Segments::new(5);
    let mut rusthdl = simulate().unwrap();
    let mut random = Random(9);
    let (mut expected, mut actual) = ([0; OUTPUT_PORTS], [0; OUTPUT_PORTS]);
    let mut moved = 0;
    for clock in 0..20_000 {
        let word = clock % 4;
        let data = match word {
            3 if random.once_in(3) => u64::from(POINT) + 1 + random.below(3),
            3 if random.once_in(2) => u64::from(CUBIC) + random.below(2) * u64::from(MORE) + 1 + random.below(3),
            3 => 1 + random.below(5),
            _ => random.word() >> (32 + random.below(32)),
        };
        let inputs = [
            u64::from(clock < 2 || random.once_in(3000)),
            u64::from(random.once_in(9)),
            u64::from(!random.once_in(100)),
            u64::from(!random.once_in(30)),
            word,
            data,
            u64::from(random.once_in(500)),
            u64::from(random.once_in(500)),
            u64::from(random.once_in(40)),
            u64::from(random.once_in(500)),
            random.word() & 0xffff_ffff,
            (random.word() & 0x7fff_ffff) >> random.below(31),
            random.below(64),
            u64::from(random.once_in(50)),
            u64::from(random.once_in(2)),
            u64::from(random.once_in(4)),
            random.below(4),
        ];
        ClockedBlock::step(&mut model, &inputs, &mut expected).unwrap();
        rusthdl.step(&inputs, &mut actual).unwrap();
        assert_eq!(actual, expected, "clock {clock}, {inputs:?}");
        moved += u64::from(expected[4] == 1);
    }
    assert!(moved > 3000, "{moved} clocks in a move");
}

/// A cubic of two ticks with nothing after it: three more ticks at its velocity, then the stop.
#[test]
fn lockstep_an_entry_that_is_missing() {
    let mut model = Segments::new(5);
    let mut rusthdl = simulate().unwrap();
    let (mut expected, mut actual) = ([0; OUTPUT_PORTS], [0; OUTPUT_PORTS]);
    let words = [7, 1 << 16, 1 << 20, u64::from(CUBIC) + 2];
    for clock in 0..600 {
        let mut inputs = [0; INPUT_PORTS];
        inputs[0] = u64::from(clock < 2);
        inputs[1] = u64::from(clock % 60 == 59);
        inputs[2] = 1;
        if let Some(word) = (10..14).position(|at| at == clock) {
            [inputs[3], inputs[4], inputs[5]] = [1, word as u64, words[word]];
        }
        (inputs[11], inputs[16]) = (1 << 24, 3);
        ClockedBlock::step(&mut model, &inputs, &mut expected).unwrap();
        rusthdl.step(&inputs, &mut actual).unwrap();
        assert_eq!(actual, expected, "clock {clock}");
    }
    // It has stopped because of an underrun.
    assert_eq!([expected[18], expected[4], expected[10]], [3, 3, 1]);
}

#[test]
fn the_verilog_has_the_ports_of_the_model() {
    let modules = emit("stage").unwrap();
    let top = modules.last().unwrap();
    assert_eq!((modules.len(), top.name.as_str()), (5, "posicast_segments"));
    assert_eq!(top.ports, ports());
}
