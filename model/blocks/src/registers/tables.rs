//! Registers of the tables that a host loads: the taps of a shaper and the settings of a controller. The stand-alone components and
//! the axes have them at different offsets; the axes of a stage and of an inline shaper have those of the shaper at the same ones.

use posicast_taps::COEFFICIENT_BITS;

use super::{Access, Field, Register};
use crate::shaper::ShaperConfig;

/// A constant in a word of its own.
pub(crate) fn parameter(name: &str, offset: u32, meaning: &str, value: u32) -> Register {
    let field = Field::new(name, 0, 32, meaning).with_reset(value);
    Register::new(name, offset, Access::Constant, "parameter of the build", vec![field])
}

/// The sizes of an axis's shaper, in words of the axis's window.
pub(crate) fn axis_shaper(config: &ShaperConfig) -> Vec<Register> {
    vec![
        parameter(
            "ring_samples",
            0x01,
            "size of the ring buffer: delays of a table reach up to this minus 2",
            1 << config.ring_address_bits(),
        ),
        parameter("most_taps", 0x02, "taps per bank", config.most_taps()),
        parameter(
            "machine_taps",
            0x03,
            "number of taps of bank 0",
            config.table().taps().len() as u32,
        ),
        parameter(
            "coefficient_fraction",
            0x04,
            "number of fraction bits F of the coefficients",
            config.coefficient_fraction(),
        ),
    ]
}

/// The registers by which a host loads an axis's tables and reads them back; [`tap_loaded`] is another word of the window.
pub(crate) fn axis_taps(config: &ShaperConfig) -> Vec<Register> {
    vec![
        tap_address(config, 0x14),
        tap(config, 0x15),
        swap(config, 0x16),
        tap_read(0x27),
    ]
}

/// The register `tap_address`.
pub(crate) fn tap_address(config: &ShaperConfig, offset: u32) -> Register {
    let index = Field::new(
        "tap_index",
        0,
        config.tap_index_bits(),
        "index in the table: taps are written from 0 on, in order",
    );
    Register::new(
        "tap_address",
        offset,
        Access::Configuration,
        "address of the tap to write or read",
        vec![index, Field::new("tap_bank", 8, 2, "bank 1 or 2")],
    )
}

/// The register `tap`.
pub(crate) fn tap(config: &ShaperConfig, offset: u32) -> Register {
    let delay = "delay; all ones is not allowed";
    let fields = tap_word(config, ["tap_coefficient", "tap_delay"], delay);
    Register::new("tap", offset, Access::command("tap_write"), "writes a tap", fields)
}

/// The register `tap_loaded`, with the fields of [`tap`].
pub(crate) fn tap_loaded(config: &ShaperConfig, offset: u32) -> Register {
    Register::new(
        "tap_loaded",
        offset,
        Access::Live,
        "tap read back by `TAP_READ`; 0 where no tap is loaded",
        tap_word(config, ["loaded_coefficient", "loaded_delay"], "delay"),
    )
}

fn tap_word(config: &ShaperConfig, [coefficient, delay]: [&str; 2], meaning: &str) -> Vec<Field> {
    vec![
        Field::new(coefficient, 0, COEFFICIENT_BITS, "coefficient").fixed(config.coefficient_fraction()),
        Field::new(delay, COEFFICIENT_BITS, config.ring_address_bits(), meaning).with_unit("samples"),
    ]
}

/// The register `tap_read`.
pub(crate) fn tap_read(offset: u32) -> Register {
    Register::new(
        "tap_read",
        offset,
        Access::command("tap_read"),
        "reads back the tap at `TAP_ADDRESS`, which must stay until `tap_read_waits` is low",
        vec![],
    )
}

/// The register `swap`. Only a shaper for motion has the choice of how a swap takes effect.
pub(crate) fn swap(config: &ShaperConfig, offset: u32) -> Register {
    let ways = [
        (0, "at_once", "from the next sample on"),
        (1, "handover", "each increment passes one table"),
        (2, "when_settled", "once the command stands still"),
    ];
    let how = config
        .motion()
        .map(|_| Field::choice("swap_how", 4, 2, "when the swap takes effect", &ways));
    let bank = Field::new("swap_bank", 0, 2, "bank 0, 1 or 2");
    let fields = [bank].into_iter().chain(how).collect();
    Register::new("swap", offset, Access::command("swap"), "makes a bank active", fields)
}

/// The field `law` of the register of the same name.
pub(crate) fn law() -> Field {
    let laws = [
        (0, "sliding_mode", "c de + k s + eps sat(s / phi)"),
        (1, "pd", "proportional and derivative"),
        (2, "pid", "proportional, integral and derivative"),
    ];
    Field::choice("law", 0, 2, "control law", &laws)
}

/// The field of the register `law` that chooses the settings.
pub(crate) fn setting_bank(name: &str) -> Field {
    let banks = [
        (0, "machine", "settings of the machine, in a ROM"),
        (1, "loaded_1", "settings loaded into bank 1"),
        (2, "loaded_2", "settings loaded into bank 2"),
    ];
    Field::choice(name, 8, 2, "settings in use; bank 3 is all 0", &banks)
}

/// The register `setting_address`.
pub(crate) fn setting_address(offset: u32) -> Register {
    Register::new(
        "setting_address",
        offset,
        Access::Configuration,
        "address of the setting to write or read",
        vec![
            Field::new("setting_row", 0, 4, "row of the setting: see docs/sliding_mode.md"),
            Field::new("setting_bank", 8, 2, "bank 1 or 2"),
        ],
    )
}

/// The register `setting`.
pub(crate) fn setting(offset: u32) -> Register {
    let fields = vec![setting_word("setting_word")];
    Register::new(
        "setting",
        offset,
        Access::command("setting_write"),
        "writes a setting",
        fields,
    )
}

/// The register `setting_read`.
pub(crate) fn setting_read(offset: u32) -> Register {
    Register::new(
        "setting_read",
        offset,
        Access::command("setting_read"),
        "reads back the word at `SETTING_ADDRESS`, which must stay until `setting_read_waits` is low",
        vec![],
    )
}

/// The register `setting_loaded`.
pub(crate) fn setting_loaded(offset: u32) -> Register {
    Register::new(
        "setting_loaded",
        offset,
        Access::Live,
        "word read back by `SETTING_READ`; 0 where nothing was written since the reset",
        vec![setting_word("setting_loaded")],
    )
}

fn setting_word(name: &str) -> Field {
    Field::new(name, 0, 32, "mantissa and shift, or the limit")
}
