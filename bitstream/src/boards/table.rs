//! The table of the boards.

use super::{BoardDevice, BoardPin, FpgaBoard};

const ICEBREAKER: [&str; 2] = [
    "YosysHQ/icestorm examples/icebreaker/icebreaker.pcf",
    "amaranth-lang/amaranth-boards amaranth_boards/icebreaker.py",
];
const HX8K: [&str; 2] = [
    "YosysHQ/icestorm examples/hx8kboard/hx8kboard.pcf",
    "amaranth-lang/amaranth-boards amaranth_boards/ice40_hx8k_b_evn.py",
];
/// The first file of [`HX8K`] does not name the serial line.
const HX8K_SERIAL: [&str; 2] = [
    "YosysHQ/picorv32 picosoc/hx8kdemo.pcf",
    "amaranth-lang/amaranth-boards amaranth_boards/ice40_hx8k_b_evn.py",
];

const COLORLIGHT_I5: [&str; 2] = [
    "FPiorski/colorlight-i5-vhdl-examples common/ext_board.lpf",
    "LukeMoll/amaranth-boards amaranth_boards/muselab_ext.py",
];
const ULX3S: [&str; 2] = [
    "emard/ulx3s doc/constraints/ulx3s_v20.lpf",
    "amaranth-lang/amaranth-boards amaranth_boards/ulx3s.py",
];
const TANG_NANO_9K: [&str; 2] = [
    "litex-hub/litex-boards litex_boards/platforms/sipeed_tang_nano_9k.py",
    "amaranth-lang/amaranth-boards amaranth_boards/tang_nano_9k.py",
];
const TANG_NANO_20K: [&str; 2] = [
    "litex-hub/litex-boards litex_boards/platforms/sipeed_tang_nano_20k.py",
    "ryomuk/tangnano-5V applications/TangNano6809MEM/TangNano6809MEM_project/src/tn20k.cst",
];
/// The second file of [`TANG_NANO_20K`] uses the LED's pin for a wire.
const TANG_NANO_20K_LED: [&str; 2] = [
    "litex-hub/litex-boards litex_boards/platforms/sipeed_tang_nano_20k.py",
    "YosysHQ/apicula examples/himbaechel/tangnano20k.cst",
];
/// Pins of the headers P2, P3 and P6 that have no other use, by header and pin. Those of bank 8 are left out: the configuration drives
/// some of them.
const COLORLIGHT_I5_HEADER: [(&str, &str); 40] = [
    ("P2 pin 4", "T18"),
    ("P2 pin 5", "R17"),
    ("P2 pin 6", "M17"),
    ("P2 pin 12", "N18"),
    ("P2 pin 13", "L20"),
    ("P2 pin 14", "K20"),
    ("P2 pin 15", "G20"),
    ("P2 pin 16", "J20"),
    ("P2 pin 17", "L18"),
    ("P2 pin 18", "M18"),
    ("P2 pin 19", "N17"),
    ("P2 pin 25", "P17"),
    ("P2 pin 26", "R18"),
    ("P2 pin 27", "C18"),
    ("P3 pin 3", "D20"),
    ("P3 pin 4", "B19"),
    ("P3 pin 5", "A19"),
    ("P3 pin 6", "A18"),
    ("P3 pin 13", "B1"),
    ("P3 pin 14", "D2"),
    ("P3 pin 15", "E2"),
    ("P3 pin 16", "D1"),
    ("P3 pin 17", "C1"),
    ("P3 pin 18", "C2"),
    ("P3 pin 19", "E3"),
    ("P3 pin 25", "C17"),
    ("P3 pin 26", "B18"),
    ("P3 pin 27", "B20"),
    ("P3 pin 28", "F20"),
    ("P6 pin 3", "J18"),
    ("P6 pin 4", "P16"),
    ("P6 pin 5", "L4"),
    ("P6 pin 6", "N4"),
    ("P6 pin 12", "N2"),
    ("P6 pin 19", "M1"),
    ("P6 pin 22", "N3"),
    ("P6 pin 24", "M3"),
    ("P6 pin 26", "M4"),
    ("P6 pin 27", "L5"),
    ("P6 pin 28", "J16"),
];
/// Pins of the headers J1 and J2 that neither the radio nor the converter uses.
const ULX3S_HEADER: [(&str, &str); 42] = [
    ("gp0", "B11"),
    ("gn0", "C11"),
    ("gp1", "A10"),
    ("gn1", "A11"),
    ("gp2", "A9"),
    ("gn2", "B10"),
    ("gp3", "B9"),
    ("gn3", "C10"),
    ("gp4", "A7"),
    ("gn4", "A8"),
    ("gp5", "C8"),
    ("gn5", "B8"),
    ("gp6", "C6"),
    ("gn6", "C7"),
    ("gp7", "A6"),
    ("gn7", "B6"),
    ("gp8", "A4"),
    ("gn8", "A5"),
    ("gp9", "A2"),
    ("gn9", "B1"),
    ("gp10", "C4"),
    ("gn10", "B4"),
    ("gp18", "H18"),
    ("gn18", "H17"),
    ("gp19", "F17"),
    ("gn19", "G18"),
    ("gp20", "D18"),
    ("gn20", "E17"),
    ("gp21", "C18"),
    ("gn21", "D17"),
    ("gp22", "B15"),
    ("gn22", "C15"),
    ("gp23", "B17"),
    ("gn23", "C17"),
    ("gp24", "C16"),
    ("gn24", "D16"),
    ("gp25", "D14"),
    ("gn25", "E14"),
    ("gp26", "B13"),
    ("gn26", "C13"),
    ("gp27", "D13"),
    ("gn27", "E13"),
];
/// The ULX3S without its device.
const ULX3S_BOARD: FpgaBoard = FpgaBoard {
    name: "ulx3s-25f",
    title: "ULX3S",
    device: BoardDevice::Lfe5u25f,
    package: "CABGA381",
    oscillator_hz: 25_000_000,
    volts: 3.3,
    led_volts: 3.3,
    clock: pin("G2", ULX3S),
    serial_rx: pin("M1", ULX3S),
    serial_tx: pin("L4", ULX3S),
    led: pin("B2", ULX3S),
    led_is_active_low: false,
    loader: "ulx3s",
    header: &ULX3S_HEADER,
    header_sources: ULX3S,
};

/// All boards.
pub const BOARDS: [FpgaBoard; 8] = [
    FpgaBoard {
        name: "icebreaker",
        title: "iCEBreaker",
        device: BoardDevice::Up5k,
        package: "sg48",
        oscillator_hz: 12_000_000,
        volts: 3.3,
        led_volts: 3.3,
        clock: pin("35", ICEBREAKER),
        serial_rx: pin("6", ICEBREAKER),
        serial_tx: pin("9", ICEBREAKER),
        led: pin("11", ICEBREAKER),
        led_is_active_low: true,
        loader: "ice40_generic",
        header: &[],
        header_sources: ["", ""],
    },
    FpgaBoard {
        name: "ice40-hx8k",
        title: "iCE40-HX8K Breakout Board",
        device: BoardDevice::Hx8k,
        package: "ct256",
        oscillator_hz: 12_000_000,
        volts: 3.3,
        led_volts: 3.3,
        clock: pin("J3", HX8K),
        serial_rx: pin("B10", HX8K_SERIAL),
        serial_tx: pin("B12", HX8K_SERIAL),
        led: pin("B5", HX8K),
        led_is_active_low: false,
        loader: "ice40_generic",
        header: &[],
        header_sources: ["", ""],
    },
    FpgaBoard {
        name: "colorlight-i5",
        title: "Colorlight i5 v7.0 on its extension board",
        device: BoardDevice::Lfe5u25f,
        package: "CABGA381",
        oscillator_hz: 25_000_000,
        volts: 3.3,
        led_volts: 3.3,
        clock: pin("P3", COLORLIGHT_I5),
        serial_rx: pin("H18", COLORLIGHT_I5),
        serial_tx: pin("J17", COLORLIGHT_I5),
        led: pin("U16", COLORLIGHT_I5),
        led_is_active_low: true,
        loader: "colorlight-i5",
        header: &COLORLIGHT_I5_HEADER,
        header_sources: [
            "wuxx/Colorlight-FPGA-Projects src/i5/common/io.lpf",
            "LukeMoll/amaranth-boards amaranth_boards/muselab_ext.py",
        ],
    },
    FpgaBoard {
        name: "ulx3s-12f",
        device: BoardDevice::Lfe5u12f,
        ..ULX3S_BOARD
    },
    ULX3S_BOARD,
    FpgaBoard {
        name: "ulx3s-85f",
        device: BoardDevice::Lfe5u85f,
        ..ULX3S_BOARD
    },
    FpgaBoard {
        name: "tang-nano-9k",
        title: "Tang Nano 9K",
        device: BoardDevice::Gw1nr9c,
        package: "QN88P",
        oscillator_hz: 27_000_000,
        volts: 3.3,
        // Its bank has the voltage of the memory in the package.
        led_volts: 1.8,
        clock: pin("52", TANG_NANO_9K),
        serial_rx: pin("18", TANG_NANO_9K),
        serial_tx: pin("17", TANG_NANO_9K),
        led: pin("10", TANG_NANO_9K),
        led_is_active_low: true,
        loader: "tangnano9k",
        header: &[],
        header_sources: ["", ""],
    },
    FpgaBoard {
        name: "tang-nano-20k",
        title: "Tang Nano 20K",
        device: BoardDevice::Gw2ar18c,
        package: "QN88",
        oscillator_hz: 27_000_000,
        volts: 3.3,
        led_volts: 3.3,
        clock: pin("4", TANG_NANO_20K),
        serial_rx: pin("70", TANG_NANO_20K),
        serial_tx: pin("69", TANG_NANO_20K),
        led: pin("15", TANG_NANO_20K_LED),
        led_is_active_low: true,
        loader: "tangnano20k",
        header: &[],
        header_sources: ["", ""],
    },
];

const fn pin(pin: &'static str, sources: [&'static str; 2]) -> BoardPin {
    BoardPin { pin, sources }
}
