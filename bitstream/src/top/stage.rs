//! The board's tops for a whole stage with its line to the host: power-on reset, and every port of the stage at a pin; or, for a board without
//! wires, [stand-ins](super::stand_in) in place of all pins but the line's.
//!
//! An open input is in the state that stops the axes: limits, faults and the emergency stop are low when they are asserted, and drives are
//! not ready. So all inputs have resistors to ground in the device, but for those of `OPEN_IS_HIGH`.

use super::TopFiles;
use super::stand_in::StandIn;
use crate::BitstreamError;
use crate::boards::{FpgaBoard, PinUse, TopPin};
use std::fmt::Write;

/// The register that ends the power-on reset: low during the reset, high for ever after it.
pub const RUNNING: &str = "running";
/// Clocks after configuration in which [`RUNNING`] is low.
pub const POWER_ON_CLOCKS: u64 = 256;
/// The stage's ports that have no pin of their own.
const INSIDE: [&str; 2] = ["clk", "rst"];
/// Inputs that are high while they are open: an idle line to the host, and the lock of a clock that this top does not have.
const OPEN_IS_HIGH: [&str; 3] = ["uart_rx", "spi_cs_n", "pll_locked"];

/// The line to the host, which has the board's own pins.
const LINE: [&str; 2] = ["uart_rx", "uart_tx"];
/// Inputs that are high in normal operation although their names do not end in `_n`.
const HEALTHY_IS_HIGH: [&str; 2] = ["drive_ready", "pll_locked"];

/// Whether an input of the stage is high while nothing is wrong.
#[must_use]
pub fn is_high_when_healthy(port: &str) -> bool {
    port.ends_with("_n") || HEALTHY_IS_HIGH.iter().any(|name| port.ends_with(name))
}

/// The top of a stage: the module `stage`, which has these ports, each of one bit, on a board.
///
/// # Errors
/// [`BitstreamError::TooManyPins`] if the board's headers have too few pins.
pub fn top(
    machine: &str,
    board: FpgaBoard,
    stage: &str,
    ports: &[(String, PinUse)],
) -> Result<TopFiles, BitstreamError> {
    let module = format!("{machine}_{}", board.name.replace('-', "_"));
    let at_pins: Vec<_> = ports
        .iter()
        .filter(|(port, _)| !INSIDE.contains(&port.as_str()))
        .collect();
    let pins = pins(&board, &at_pins)?;
    let what = "every port at a pin, and a reset at power-up";
    let verilog = verilog(&module, &board, (stage, what), ports, &at_pins, "");
    Ok(TopFiles {
        module,
        board,
        pins,
        verilog,
        is_bare: false,
    })
}

/// The top of a stage for a board without wires: only the line to the host and the LED have pins. Each axis has a stand-in, and all other
/// inputs have the level at which nothing is wrong.
///
/// # Errors
/// As [`top`].
pub fn bare(
    machine: &str,
    board: FpgaBoard,
    stage: &str,
    ports: &[(String, PinUse)],
    stand_ins: &[StandIn],
) -> Result<TopFiles, BitstreamError> {
    let module = format!("{machine}_{}_bare", board.name.replace('-', "_"));
    let at_pins: Vec<_> = ports.iter().filter(|(port, _)| LINE.contains(&port.as_str())).collect();
    let pins = pins(&board, &at_pins)?;
    let is_line = |port: &str| {
        stand_ins
            .iter()
            .any(|one| ["a", "b"].iter().any(|line| port == format!("{}_{line}", one.axis())))
    };
    let mut inside =
        String::from("\n    // Nothing is connected: every other input has the level at which nothing is wrong.\n");
    for (port, direction) in ports {
        if LINE.contains(&port.as_str()) || INSIDE.contains(&port.as_str()) {
            continue;
        }
        let level = u8::from(is_high_when_healthy(port));
        let _ = match direction {
            PinUse::Input if !is_line(port) => writeln!(inside, "    wire {port} = 1'b{level};"),
            _ => writeln!(inside, "    wire {port};"),
        };
    }
    for stand_in in stand_ins {
        inside += &stand_in.verilog();
    }
    let what = "stand-ins for its machine, no pin but the line's, and a reset at power-up";
    let verilog = verilog(&module, &board, (stage, what), ports, &at_pins, &inside);
    Ok(TopFiles {
        module,
        board,
        pins,
        verilog,
        is_bare: true,
    })
}

fn pins(board: &FpgaBoard, ports: &[&(String, PinUse)]) -> Result<Vec<TopPin>, BitstreamError> {
    let [clock, rx, tx, led] = board.own_pins();
    let mut header = board.header.iter();
    let mut pins = vec![clock];
    let mut missing = 0;
    for (port, direction) in ports {
        let open_level = (*direction == PinUse::Input).then(|| OPEN_IS_HIGH.contains(&port.as_str()));
        let own = match port.as_str() {
            "uart_rx" => Some(&rx),
            "uart_tx" => Some(&tx),
            _ => None,
        };
        let (pin, header, sources) = match own {
            Some(own) => (own.pin, "", own.sources),
            None => match header.next() {
                Some((header, pin)) => (*pin, *header, board.header_sources),
                None => {
                    missing += 1;
                    continue;
                }
            },
        };
        pins.push(TopPin {
            port: port.clone(),
            pin,
            header,
            sources,
            direction: *direction,
            open_level,
        });
    }
    if missing > 0 {
        return Err(BitstreamError::TooManyPins {
            board: board.name,
            needed: board.header.len() + missing,
            available: board.header.len(),
        });
    }
    pins.push(led);
    Ok(pins)
}

/// The module with an instance of `stage`; `what` describes it, `at_pins` are its own ports, and `inside` declares the nets of all others.
fn verilog(
    module: &str,
    board: &FpgaBoard,
    (stage, what): (&str, &str),
    ports: &[(String, PinUse)],
    at_pins: &[&(String, PinUse)],
    inside: &str,
) -> String {
    let (led, lit) = match board.led_is_active_low {
        true => ("led_n", "!"),
        false => ("led", ""),
    };
    let mut header = String::from("    input  wire clk,\n");
    let mut connections = String::new();
    for (port, direction) in at_pins {
        let direction = match direction {
            PinUse::Input => "input ",
            PinUse::Output => "output",
        };
        let _ = writeln!(header, "    {direction} wire {port},");
    }
    for (port, _) in ports {
        let net = if port == "rst" { "!running" } else { port };
        let _ = writeln!(connections, "        .{port}({net}),");
    }
    let connections = connections.trim_end_matches(",\n");
    format!(
        "\
// The stage {stage} on {title} ({device}): {what}. {led} is lit after it.
//
// Written by posicast {version}, for an oscillator of {mhz} MHz. Nobody has run it on hardware yet.

`default_nettype none

module {module} (
{header}    output wire {led}
);
    // The device sets registers to 0 at power-up. Its memories cannot be read in the first microseconds, so the reset is long.
    reg [7:0] resets  = 8'd0;
    (* keep *)
    reg       running = 1'b0;

    always @(posedge clk) begin
        if (resets != 8'd255) resets <= resets + 8'd1;
        running <= (resets == 8'd255);
    end

    assign {led} = {lit}running;
{inside}
    {stage} u_stage (
{connections}
    );
endmodule

`default_nettype wire
",
        title = board.title,
        device = board.device.name(),
        version = env!("CARGO_PKG_VERSION"),
        mhz = f64::from(board.oscillator_hz) / 1e6,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::boards::board;

    fn ports(inputs: usize) -> Vec<(String, PinUse)> {
        let fixed = ["clk", "rst", "uart_rx"].map(|port| (port.to_owned(), PinUse::Input));
        let inputs = (0..inputs).map(|index| (format!("in_{index}"), PinUse::Input));
        let output = ("uart_tx".to_owned(), PinUse::Output);
        fixed.into_iter().chain(inputs).chain([output]).collect()
    }

    #[test]
    fn every_port_but_the_reset_has_a_pin_of_its_own_and_open_inputs_stop() {
        let board = board("colorlight-i5").unwrap();
        let top = top("m", board, "m_link", &ports(3)).unwrap();
        let names: Vec<&str> = top.pins.iter().map(|pin| pin.port.as_str()).collect();
        assert_eq!(names, ["clk", "uart_rx", "in_0", "in_1", "in_2", "uart_tx", "led_n"]);
        let open: Vec<Option<bool>> = top.pins.iter().map(|pin| pin.open_level).collect();
        assert_eq!(
            open,
            [None, Some(true), Some(false), Some(false), Some(false), None, None]
        );
        let mut pins: Vec<&str> = top.pins.iter().map(|pin| pin.pin).collect();
        pins.sort_unstable();
        pins.dedup();
        assert_eq!(pins.len(), names.len());
        let constraints = top.constraints();
        assert!(
            constraints.contains("\"in_0\" IO_TYPE=LVCMOS33 PULLMODE=DOWN;"),
            "{constraints}"
        );
        assert!(top.verilog.contains(".rst(!running)"));
    }

    #[test]
    fn a_board_with_too_few_pins_is_refused() {
        let board = board("colorlight-i5").unwrap();
        let free = board.header.len();
        assert!(top("m", board, "m_link", &ports(free)).is_ok());
        let message = top("m", board, "m_link", &ports(free + 2)).unwrap_err().to_string();
        assert!(
            message.contains(&format!("{} pins needed, {free} available", free + 2)),
            "{message}"
        );
    }
}
