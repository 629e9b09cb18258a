//! The bridge in RustHDL's simulator compared with its model.

use crate::random;

use posicast_blocks::ClockedBlock;
use posicast_blocks::link::Request;
use posicast_blocks::spi_bridge::{INPUT_PORTS, OUTPUT_PORTS, SpiBridge, ports};
use posicast_hdl::spi_bridge::{emit, simulate};
use random::Random;

#[test]
fn lockstep_requests_of_a_few_words() {
    let mut model = SpiBridge::new();
    let mut rusthdl = simulate().unwrap();
    let mut random = Random(5);
    let (mut expected, mut actual) = ([0; OUTPUT_PORTS], [0; OUTPUT_PORTS]);
    let mut inputs: [u64; INPUT_PORTS] = [1, 0, 1, 0, 400, 300, 0, 0];
    let (mut accesses, mut ones) = (0, 0);
    for sequence in 1..=6_u8 {
        let words = vec![random.word() as u32, 0];
        let request = match sequence % 2 {
            0 => Request::Write { address: 7, words },
            _ => Request::ReadList(vec![3, 299]),
        };
        // The frame, then bytes 00 for the reply, each with four clocks for half a period.
        let bytes = request.encode(sequence / 2 + 1).unwrap().into_iter().chain([0; 40]);
        let lines = bytes.flat_map(|byte| {
            (0..64).map(move |clock| [u64::from(clock % 8 >= 4), 0, u64::from(byte >> (7 - clock / 8) & 1)])
        });
        for lines in std::iter::repeat_n([0, 1, 0], 9).chain(lines) {
            inputs[1..4].copy_from_slice(&lines);
            inputs[6] = random.word() & 0xffff_ffff;
            inputs[7] = random.below(2);
            ClockedBlock::step(&mut model, &inputs, &mut expected).unwrap();
            rusthdl.step(&inputs, &mut actual).unwrap();
            assert_eq!(actual, expected, "request {sequence}, {inputs:?}");
            accesses += (expected[2] | expected[3]) & !inputs[7];
            ones += expected[0];
            inputs[0] = 0;
        }
    }
    // Numbers 1 2 2 3 3 4: two are taken for repetitions.
    assert_eq!(accesses, 8);
    assert!(ones > 1000, "{ones}");
}

#[test]
fn the_verilog_has_the_ports_of_the_model() {
    let modules = emit("stage").unwrap();
    let top = modules.last().unwrap();
    assert_eq!((modules.len(), top.name.as_str()), (8, "posicast_spi_bridge"));
    assert_eq!(top.ports, ports());
}
