//! The stand-ins of a bare board: their Verilog, in Icarus, beside their model.

#![cfg(test)] // lets clippy see that this is test code

use posicast_bitstream::boards::{PinUse, board};
use posicast_bitstream::top::stage::bare;
use posicast_bitstream::top::stand_in::{StandIn, StandInDrive, StandInGates, StandInModel, StandInPins};
use posicast_system::tool::{self, Ended};
use std::fmt::Write;
use std::time::Duration;

const CLOCKS: usize = 60_000;
const INPUTS: [&str; 6] = ["clk", "rst", "uart_rx", "x_a", "x_b", "x_limit_plus_n"];
const GATES: [&str; 6] = [
    "x_a_high",
    "x_a_low",
    "x_b_high",
    "x_b_low",
    "x_drive_enable",
    "x_brake_release",
];

/// A stage whose gates are random and change seldom enough that the axis moves by many counts. Its own inputs are shown in every clock.
fn stage() -> String {
    let mut text = String::from("module stage (\n");
    for port in INPUTS {
        let _ = writeln!(text, "    input wire {port},");
    }
    for port in GATES {
        let _ = writeln!(text, "    output wire {port},");
    }
    text + "    output wire uart_tx
);
    assign uart_tx = uart_rx;
    reg [5:0] pins = 6'd0;
    reg [31:0] seed = 32'd7;
    integer draw;
    assign {x_a_high, x_a_low, x_b_high, x_b_low, x_drive_enable, x_brake_release} = pins;
    always @(posedge clk) begin
        $display(\"%b %b%b %b\", pins, x_a, x_b, x_limit_plus_n);
        draw = $random(seed);
        // The drive stays on for long, the gates for some clocks.
        if (draw[4:0] == 5'd0) pins[5:2] <= draw[11:8];
        if (draw[16:8] == 9'd0) pins[1:0] <= draw[20] ? 2'b11 : draw[22:21];
    end
endmodule
module bench;
    reg clk = 1'b0;
    wire uart_tx, led_n;
    m_colorlight_i5_bare top (.clk(clk), .uart_rx(1'b1), .uart_tx(uart_tx), .led_n(led_n));
    initial begin
        repeat (60000) begin
            #1 clk = 1'b1;
            #1 clk = 1'b0;
        end
        $finish;
    end
endmodule
"
}

/// Lines of the run: pins, lines A and B, and a limit, in every clock.
fn run(stand_in: &StandIn) -> String {
    let as_ports = |names: &[&str], direction| -> Vec<(String, PinUse)> {
        names.iter().map(|name| ((*name).to_owned(), direction)).collect()
    };
    let mut ports = as_ports(&INPUTS, PinUse::Input);
    ports.extend(as_ports(&GATES, PinUse::Output));
    ports.push(("uart_tx".to_owned(), PinUse::Output));
    let board = board("colorlight-i5").unwrap();
    let top = bare("m", board, "stage", &ports, std::slice::from_ref(stand_in)).unwrap();
    let names: Vec<&str> = top.pins.iter().map(|pin| pin.port.as_str()).collect();
    assert_eq!(
        names,
        ["clk", "uart_rx", "uart_tx", "led_n"],
        "nothing else can switch anything"
    );
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("all.v"), top.verilog + &stage()).unwrap();
    for (program, arguments) in [
        ("iverilog", ["-o", "run", "all.v"].as_slice()),
        ("vvp", ["run"].as_slice()),
    ] {
        let mut command = tool::command_in(program, folder.path());
        let ended = tool::run_within(command.args(arguments), Duration::from_secs(60)).unwrap();
        match ended {
            Ended::Well(printed) if program == "vvp" => return printed,
            Ended::Well(_) => {}
            Ended::Badly { printed, .. } => panic!("{program}: {printed}"),
            Ended::TimeOut => panic!("{program} did not end"),
        }
    }
    unreachable!("vvp returns")
}

#[test]
fn the_verilog_of_a_stand_in_is_its_model_in_every_clock() {
    let gates = [StandInGates::Direction, StandInGates::HalfBridge, StandInGates::Bridge];
    let drives = [StandInDrive::Velocity(0.03), StandInDrive::Acceleration(3e-5)];
    for (index, (gates, drive)) in gates
        .into_iter()
        .flat_map(|gates| drives.map(|drive| (gates, drive)))
        .enumerate()
    {
        for active_low in [false, true] {
            let reversed = index % 2 == 1;
            let stand_in = StandIn::new("x", (gates, active_low), drive, reversed).unwrap();
            let mut model = StandInModel::new(&stand_in);
            let (mut clocks, mut most) = (0, 0);
            for line in run(&stand_in).lines().filter(|line| line.len() == 11) {
                let digits: Vec<bool> = line
                    .bytes()
                    .filter(|byte| *byte != b' ')
                    .map(|byte| byte == b'1')
                    .collect();
                let [g0, g1, g2, g3, drive_enable, brake_release, a, b, limit] = digits[..] else {
                    panic!("{line}");
                };
                assert_eq!([a, b], model.lines(), "{stand_in:?}, clock {clocks}");
                assert!(limit, "an input of which low is a fault is high");
                model.clock(StandInPins {
                    gates: [g0, g1, g2, g3],
                    drive_enable,
                    brake_release,
                });
                clocks += 1;
                most = most.max(model.count().abs());
            }
            assert_eq!(clocks, CLOCKS);
            // Two periods of the lines.
            assert!(most >= 8, "{stand_in:?} moved by {most} counts");
        }
    }
}
