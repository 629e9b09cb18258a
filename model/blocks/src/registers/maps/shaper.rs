//! Registers of the stand-alone shaper.

use super::super::{Access, Description, Field, tables};
use crate::shaper::ShaperConfig;

/// The map of a shaper. Words are called `x` and `y`, or for a motion shaper `x_0`, `y_0` and so on.
pub fn shaper(config: &ShaperConfig) -> Description {
    use Access::{Configuration, Live, Sticky};
    let about = "Input shaper: samples come from registers or pins, tables are loaded through registers.";
    let mut description = Description::new("shaper", about, *b"SHPR", (1, 1), parameters(config))
        .with(
            "control",
            0x10,
            Configuration,
            "source of the samples",
            vec![Field::flag(
                "from_pins",
                0,
                "`strobe`, `start` and `x` come from the pins, not the registers",
            )],
        )
        .with(
            "status",
            0x11,
            Live,
            "state of the shaper",
            vec![
                Field::flag("busy", 0, "a sample is being shaped"),
                Field::flag("swap_pending", 1, "a swap waits, or hands over"),
                Field::new("bank", 2, 2, "the active bank"),
                Field::flag("tap_read_waits", 4, "a read by `TAP_READ` waits"),
            ],
        )
        .with(
            "flags",
            0x12,
            Sticky,
            "events since the flag was cleared",
            vec![
                Field::flag("saturated", 0, "an output was clamped"),
                Field::flag("overrun", 1, "a sample came while another was being shaped"),
                Field::flag("refused", 2, "a tap or a swap was refused"),
                super::partial_write(3),
            ],
        )
        .with_interrupts(
            0x14,
            vec![
                Field::flag("valid", 0, "a sample was shaped"),
                Field::flag("saturated", 1, "an output was clamped"),
                Field::flag("overrun", 2, "a sample came while another was being shaped"),
                Field::flag("refused", 3, "a tap or a swap was refused"),
            ],
        );
    for (offset, channel) in (0x18..).zip(0..config.channels()) {
        let (x, word) = (word_name(config, "x", channel), format!("host_x_{channel}"));
        let field = Field::new(&word, 0, config.word_bits(), "command word").signed();
        description = description.with(&x, offset, Configuration, "the next sample", vec![field]);
    }
    description = description
        .with(
            "strobe",
            0x1c,
            Access::command("host_strobe"),
            "takes the sample",
            vec![],
        )
        .with(
            "start",
            0x1d,
            Access::command("host_start"),
            "begins anew from the sample",
            vec![],
        );
    for (offset, channel) in (0x20..).zip(0..config.channels()) {
        let y = word_name(config, "y", channel);
        let field = Field::new(&y, 0, config.word_bits(), "shaped command word").signed();
        description = description.with(&y, offset, Live, "the last sample, shaped", vec![field]);
    }
    let tables = [
        tables::tap_address(config, 0x28),
        tables::tap(config, 0x29),
        tables::swap(config, 0x2a),
        tables::tap_read(0x2b),
        tables::tap_loaded(config, 0x2c),
    ];
    tables.into_iter().fold(description, Description::with_register)
}

/// Name of a word: `x` and `y` for the plain shaper, else with the channel's number.
pub(crate) fn word_name(config: &ShaperConfig, name: &str, channel: usize) -> String {
    match config.motion() {
        None => name.to_owned(),
        Some(_) => format!("{name}_{channel}"),
    }
}

fn parameters(config: &ShaperConfig) -> Vec<Field> {
    let parameter = |name: &str, meaning: &str, value: u32| Field::new(name, 0, 32, meaning).with_reset(value);
    let modulo = config.motion().is_some_and(|motion| motion.modulo);
    vec![
        parameter("word_bits", "width of a command word", config.word_bits()).with_unit("bits"),
        parameter("channels", "words per sample", config.channels() as u32),
        parameter(
            "ring_samples",
            "size of the ring buffer: delays reach up to this minus 2",
            1 << config.ring_address_bits(),
        )
        .with_unit("samples"),
        parameter("most_taps", "taps per bank", config.most_taps()),
        parameter("machine_taps", "taps of bank 0", config.table().taps().len() as u32),
        parameter(
            "coefficient_fraction",
            "length F of the coefficients' fraction",
            config.coefficient_fraction(),
        )
        .with_unit("bits"),
        parameter("modulo", "1: the position wraps", modulo.into()),
    ]
}
