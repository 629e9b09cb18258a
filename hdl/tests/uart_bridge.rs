//! The bridge in RustHDL's simulator compared with its model.

use crate::random;

use posicast_blocks::ClockedBlock;
use posicast_blocks::link::Request;
use posicast_blocks::uart_bridge::{INPUT_PORTS, OUTPUT_PORTS, UartBridge, ports};
use posicast_hdl::uart_bridge::{emit, simulate};
use random::Random;

#[test]
fn lockstep_requests_of_a_few_words() {
    let mut model = UartBridge::new();
    let mut rusthdl = simulate().unwrap();
    let mut random = Random(5);
    let (mut expected, mut actual) = ([0; OUTPUT_PORTS], [0; OUTPUT_PORTS]);
    // An eighth of a bit per clock.
    let mut inputs: [u64; INPUT_PORTS] = [1, 1, 0xffff, 400, 300, 0, 0];
    let mut accesses = 0;
    for sequence in 1..=6_u8 {
        let words = vec![random.word() as u32, 0];
        let request = match sequence % 2 {
            0 => Request::Write { address: 7, words },
            _ => Request::ReadList(vec![3, 299]),
        };
        let line = request.encode(sequence / 2 + 1).unwrap().into_iter().flat_map(|byte| {
            let bits = 0x200 | u64::from(byte) << 1;
            (0..80).map(move |clock| bits >> (clock / 8) & 1)
        });
        for uart_rx in line.chain(std::iter::repeat_n(1, 2500)) {
            inputs[1] = uart_rx;
            inputs[5] = random.word() & 0xffff_ffff;
            inputs[6] = random.below(2);
            ClockedBlock::step(&mut model, &inputs, &mut expected).unwrap();
            rusthdl.step(&inputs, &mut actual).unwrap();
            assert_eq!(actual, expected, "request {sequence}, {inputs:?}");
            accesses += (expected[2] | expected[3]) & !inputs[6];
            inputs[0] = 0;
        }
    }
    // Numbers 1 2 2 3 3 4: two are taken for repetitions.
    assert_eq!(accesses, 8);
}

#[test]
fn the_verilog_has_the_ports_of_the_model() {
    let modules = emit("stage").unwrap();
    let top = modules.last().unwrap();
    assert_eq!((modules.len(), top.name.as_str()), (9, "posicast_uart_bridge"));
    assert_eq!(top.ports, ports());
}
