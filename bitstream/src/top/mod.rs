//! The board's top module: power-on reset, and the machine's shapers behind a serial line.
//!
//! ```text
//! host ─► board   A5, a word of each axis, checksum   the commands of all axes; those of the last frame with a right checksum count
//! board ─► host   5A, a word of each axis, checksum   the shaped commands of every sample
//! ```
//!
//! The checksum of all bytes before it is a [`crc`]. A word has as many bytes as hold a command word, the lowest first. A byte is 8 data bits after a start bit, lowest bit first, with one
//! stop bit and no parity. A pause of [`PAUSE_BITS`] bits before a byte begins a new frame. The LED is lit while a shaper has clamped an
//! output or lost a sample.
//!
//! The registers power up as 0, so that a counter can make the reset. It is long, because block RAMs of iCE40 cannot be read in the first
//! microseconds after configuration.

pub mod crc;
pub mod stage;
pub mod stand_in;
mod verilog;

use crate::BitstreamError;
use crate::boards::{FpgaBoard, FpgaFamily, TopPin};
use posicast_blocks::shaper::ShaperConfig;
use std::fmt::Write;

/// Speed of the serial line in bits per second.
pub const BAUD: u32 = 1_000_000;
/// Length of the pause that begins a new frame, in bits of the line.
pub const PAUSE_BITS: u32 = 40;
/// Clocks of the power-on reset.
pub const RESET_CLOCKS: u32 = 255;
/// First byte of a frame from the host.
pub const COMMAND_MARK: u8 = 0xA5;
/// First byte of a frame to the host.
pub const RESULT_MARK: u8 = 0x5A;
/// Bits of a byte on the line.
const BYTE_BITS: u32 = 10;

/// A board's top module.
#[derive(Debug, Clone)]
pub struct BoardTop {
    machine: String,
    board: FpgaBoard,
    sample_clocks: u32,
    axes: Vec<TopAxis>,
}

/// An axis of the top.
#[derive(Debug, Clone)]
pub struct TopAxis {
    /// Its name.
    pub name: String,
    /// Its shaper.
    pub config: ShaperConfig,
}

impl BoardTop {
    /// The top of a machine with these axes, all of the same word width, whose samples are `sample_clocks` clocks of the board's
    /// oscillator apart.
    ///
    /// # Errors
    /// [`BitstreamError::LineTooSlow`] if the line does not carry the results of a sample before the next.
    pub fn new(
        machine: &str,
        board: FpgaBoard,
        sample_clocks: u32,
        axes: Vec<TopAxis>,
    ) -> Result<Self, BitstreamError> {
        let top = Self {
            machine: machine.to_owned(),
            board,
            sample_clocks,
            axes,
        };
        let frame_clocks = BYTE_BITS * top.frame_bytes() * top.bit_clocks();
        if frame_clocks > sample_clocks {
            return Err(BitstreamError::LineTooSlow {
                board: board.name,
                frame_clocks,
                sample_clocks,
                highest_hz: board.oscillator_hz / frame_clocks,
                axes: top.axes.len(),
                word_bits: top.word_bits(),
            });
        }
        Ok(top)
    }

    /// Name of the machine, and of the module with its shapers.
    #[must_use]
    pub fn machine(&self) -> &str {
        &self.machine
    }

    /// Name of the module.
    #[must_use]
    pub fn module(&self) -> String {
        format!("{}_{}", self.machine, self.board.name.replace('-', "_"))
    }

    /// The board.
    #[must_use]
    pub fn board(&self) -> &FpgaBoard {
        &self.board
    }

    /// The axes.
    #[must_use]
    pub fn axes(&self) -> &[TopAxis] {
        &self.axes
    }

    /// Clocks between two samples.
    #[must_use]
    pub fn sample_clocks(&self) -> u32 {
        self.sample_clocks
    }

    /// Clocks per bit of the line.
    #[must_use]
    pub fn bit_clocks(&self) -> u32 {
        self.board.oscillator_hz / BAUD
    }

    /// Width of a command word.
    #[must_use]
    pub fn word_bits(&self) -> u32 {
        self.axes.first().map_or(0, |axis| axis.config.word_bits())
    }

    /// Bytes of a word on the line.
    #[must_use]
    pub fn word_bytes(&self) -> u32 {
        self.word_bits().div_ceil(8)
    }

    /// Bytes of the words of all axes.
    #[must_use]
    pub fn words_bytes(&self) -> u32 {
        self.word_bytes() * self.axes.len() as u32
    }

    /// Bytes of a frame, with its mark and its checksum.
    #[must_use]
    pub fn frame_bytes(&self) -> u32 {
        self.words_bytes() + 2
    }

    /// Index of the axis whose result comes last; at its `valid` all results stand.
    #[must_use]
    pub fn slowest_axis(&self) -> usize {
        let clocks = |axis: &TopAxis| axis.config.pass_clocks(axis.config.table().taps().len() as u32);
        let indexed = self.axes.iter().enumerate();
        indexed
            .max_by_key(|(_, axis)| clocks(axis))
            .map_or(0, |(index, _)| index)
    }

    /// The top as files are made of it.
    #[must_use]
    pub fn files(&self) -> TopFiles {
        TopFiles {
            module: self.module(),
            board: self.board,
            pins: self.board.own_pins().to_vec(),
            verilog: self.verilog(),
            is_bare: false,
        }
    }
}

/// A top, as the steps of a bitstream see it.
#[derive(Debug, Clone)]
pub struct TopFiles {
    /// Name of the module.
    pub module: String,
    /// The board.
    pub board: FpgaBoard,
    /// The pins of all its ports.
    pub pins: Vec<TopPin>,
    /// The module.
    pub verilog: String,
    /// Whether the board has no wires: only the line and the LED have pins, and [`stand_in`]s take the place of the machine.
    pub is_bare: bool,
}

impl TopFiles {
    /// The constraints: lines for every pin, none of which is left to the tool.
    #[must_use]
    pub fn constraints(&self) -> String {
        let family = self.board.device.family();
        let mark = match family {
            FpgaFamily::Ice40 | FpgaFamily::Ecp5 => "#",
            FpgaFamily::Gowin => "//",
        };
        let mut text = format!(
            "{mark} Pins of {} for {}.v; each names two sources of its pin.\n",
            self.board.title, self.module
        );
        for pin in &self.pins {
            let TopPin {
                port,
                pin,
                header,
                sources,
                ..
            } = pin;
            let header = match *header {
                "" => String::new(),
                header => format!("{header}; "),
            };
            let comment = format!("{header}{}", sources.join("; "));
            let _ = match family {
                FpgaFamily::Ice40 => writeln!(text, "set_io {port} {pin:<4} # {comment}"),
                FpgaFamily::Ecp5 => writeln!(
                    text,
                    "LOCATE COMP \"{port}\" SITE \"{pin}\"; # {comment}\nIOBUF PORT \"{port}\" IO_TYPE=LVCMOS33{};",
                    self.pull(port)
                ),
                // Comments stand in lines of their own.
                FpgaFamily::Gowin => writeln!(
                    text,
                    "// {comment}\nIO_LOC \"{port}\" {pin};\nIO_PORT \"{port}\" IO_TYPE={}{};",
                    self.standard(pin),
                    self.pull(port)
                ),
            };
        }
        text
    }

    /// Name of the packed bitstream.
    #[must_use]
    pub fn bitstream(&self) -> String {
        format!("{}.{}", self.module, self.board.device.family().bitstream_ending())
    }

    /// A Makefile that writes the bitstream into the board.
    #[must_use]
    pub fn makefile(&self) -> String {
        let (loader, bits) = (self.board.loader, self.bitstream());
        let mut text = format!(
            "# Writes the bitstream into {} by openFPGALoader. Nobody has tried it yet.\n\n.PHONY: flash load\n\n\
             # For good: the board starts with it.\nflash:\n\topenFPGALoader -b {loader} -f {bits}\n",
            self.board.title
        );
        // The memory of an iCE40 board's device is not reached past its flash.
        if self.board.device.family() != FpgaFamily::Ice40 {
            let _ = write!(
                text,
                "\n# Until power is switched off.\nload:\n\topenFPGALoader -b {loader} {bits}\n"
            );
        }
        text
    }

    /// The setting for the level of an open input.
    fn pull(&self, port: &str) -> String {
        let pin = self.pins.iter().find(|pin| pin.port == port);
        let key = match self.board.device.family() {
            FpgaFamily::Gowin => "PULL_MODE",
            _ => "PULLMODE",
        };
        match pin.and_then(|pin| pin.open_level) {
            Some(true) => format!(" {key}=UP"),
            Some(false) => format!(" {key}=DOWN"),
            None => String::new(),
        }
    }

    /// The standard of a pin by its voltage.
    fn standard(&self, pin: &str) -> &'static str {
        let is_led = pin == self.board.led.pin;
        let volts = if is_led { self.board.led_volts } else { self.board.volts };
        if volts < 3.0 { "LVCMOS18" } else { "LVCMOS33" }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::boards::board;
    use posicast_taps::{Tap, TapTable};

    fn axis(name: &str, word_bits: u32) -> TopAxis {
        let half = |delay_samples| Tap {
            delay_samples,
            coefficient: 1 << 15,
        };
        let table = TapTable::new(16, vec![half(0), half(3)]).unwrap();
        TopAxis {
            name: name.to_owned(),
            config: ShaperConfig::new(word_bits, table).unwrap(),
        }
    }

    #[test]
    fn a_line_that_cannot_carry_every_sample_names_the_highest_rate() {
        let board = board("icebreaker").unwrap();
        let axes = || ["x", "y", "z"].map(|name| axis(name, 32)).to_vec();
        let message = BoardTop::new("m", board, 1200, axes()).unwrap_err().to_string();
        assert!(
            message.contains("a frame takes 1680 clocks") && message.contains("at most 7142 Hz"),
            "{message}"
        );
        assert!(BoardTop::new("m", board, 1680, axes()).is_ok());
    }

    /// An axis may be called as the line is.
    #[test]
    fn no_name_of_an_axis_collides_with_one_of_the_top() {
        let names = [
            "rx", "tx", "line", "crc", "led", "clk", "idle", "words", "result", "unused",
        ];
        for name in names {
            // Of equal axes, the flag of the last one is in use.
            let axes = vec![axis("x", 20), axis(name, 20)];
            let top = BoardTop::new("m", board("icebreaker").unwrap(), 12_000, axes).unwrap();
            let verilog = top.verilog();
            let declared = verilog.lines().filter_map(|line| {
                let line = line.trim_end_matches(',').split(" = ").next()?;
                let words: Vec<&str> = line.trim_end_matches(';').split_whitespace().collect();
                let is_declaration = matches!(words.first(), Some(&("wire" | "reg" | "input" | "output")));
                is_declaration.then(|| words.into_iter().filter(|word| !word.starts_with('[')))
            });
            let of_kind = ["wire", "reg", "input", "output", "signed"];
            let declared = declared.flatten().map(|word| word.trim_end_matches(','));
            let declared: Vec<&str> = declared.filter(|word| !of_kind.contains(word)).collect();
            assert!(declared.len() > 25 && declared.contains(&"tx_clocks"), "{declared:?}");
            for (index, one) in declared.iter().enumerate() {
                assert!(!declared[..index].contains(one), "{name}: {one} is declared twice");
            }
        }
    }

    #[test]
    fn every_port_has_a_pin() {
        for board in crate::boards::BOARDS {
            let top = BoardTop::new("m", board, 12_000, vec![axis("x", 32)]).unwrap();
            let (verilog, constraints) = (top.verilog(), top.files().constraints());
            let header = verilog
                .split_once("module ")
                .unwrap()
                .1
                .split_once(");")
                .unwrap()
                .0
                .to_owned();
            let ports = header
                .lines()
                .filter(|line| line.contains("wire"))
                .map(|line| line.trim_end_matches(','));
            let ports: Vec<&str> = ports.map(|line| line.rsplit(' ').next().unwrap()).collect();
            assert_eq!(ports.len(), 4);
            for port in ports {
                let line = match board.device.family() {
                    FpgaFamily::Ice40 => format!("set_io {port} "),
                    FpgaFamily::Ecp5 => format!("LOCATE COMP \"{port}\" SITE "),
                    FpgaFamily::Gowin => format!("IO_LOC \"{port}\" "),
                };
                assert_eq!(constraints.matches(&line).count(), 1, "{port}");
            }
        }
    }
}
