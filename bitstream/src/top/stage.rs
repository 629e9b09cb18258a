//! The board's top for a whole stage with its line to the host: power-on reset, and every port of the stage at a pin.
//!
//! An open input is in the state that stops the axes: limits, faults and the emergency stop are low when they are asserted, and drives are
//! not ready. So all inputs have resistors to ground in the device, but for those of [`OPEN_IS_HIGH`].

use super::TopFiles;
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
    let pins = pins(&board, ports)?;
    let verilog = verilog(&module, &board, stage, ports);
    Ok(TopFiles {
        module,
        board,
        pins,
        verilog,
    })
}

fn pins(board: &FpgaBoard, ports: &[(String, PinUse)]) -> Result<Vec<TopPin>, BitstreamError> {
    let [clock, rx, tx, led] = board.own_pins();
    let mut header = board.header.iter();
    let mut pins = vec![clock];
    let mut missing = 0;
    for (port, direction) in ports.iter().filter(|(port, _)| !INSIDE.contains(&port.as_str())) {
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

fn verilog(module: &str, board: &FpgaBoard, stage: &str, ports: &[(String, PinUse)]) -> String {
    let (led, lit) = match board.led_is_active_low {
        true => ("led_n", "!"),
        false => ("led", ""),
    };
    let mut header = String::from("    input  wire clk,\n");
    let mut connections = String::new();
    for (port, direction) in ports {
        let direction = match direction {
            PinUse::Input => "input ",
            PinUse::Output => "output",
        };
        let inside = INSIDE.contains(&port.as_str());
        if !inside {
            let _ = writeln!(header, "    {direction} wire {port},");
        }
        let net = if port == "rst" { "!running" } else { port };
        let _ = writeln!(connections, "        .{port}({net}),");
    }
    let connections = connections.trim_end_matches(",\n");
    format!(
        "\
// The stage {stage} on {title} ({device}): every port at a pin, and a reset at power-up. {led} is lit after it.
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
