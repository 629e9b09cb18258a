//! The command FIFO in RustHDL's simulator compared with its model.

use posicast_blocks::ClockedBlock;
use posicast_blocks::segments::{CUBIC, INPUT_PORTS, OUTPUT_PORTS, Segments};
use posicast_hdl::segments::simulate;

/// A cubic of two ticks without a successor: the command keeps its velocity for three more ticks, then stops.
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
    // The command has stopped because of an underrun.
    assert_eq!([expected[18], expected[4], expected[10]], [3, 3, 1]);
}
