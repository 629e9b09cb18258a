//! Registers of the error table: when it counts, what is loaded into it, and the error in force.

use crate::error_table::{ENTRY_BITS, ErrorTableConfig};
use crate::registers::{Access, Field, Register};

/// The registers, in words of the axis's window.
pub(super) fn registers(table: &ErrorTableConfig) -> Vec<Register> {
    [what_is_built(table), loading(table), vec![now(), events()]].concat()
}

fn what_is_built(table: &ErrorTableConfig) -> Vec<Register> {
    let format = table.format();
    let constant =
        |name: &str, low, width, meaning: &str, value| Field::new(name, low, width, meaning).with_reset(value);
    vec![
        Register::new(
            "error_format",
            0x60,
            Access::Constant,
            "parameters of the build",
            vec![
                constant(
                    "error_entries",
                    0,
                    9,
                    "entries of a table",
                    table.entries().len() as u32,
                ),
                constant(
                    "error_spacing_bits",
                    16,
                    5,
                    "entries are 2 to this counts apart",
                    format.spacing_bits,
                ),
                constant(
                    "error_fraction_bits",
                    24,
                    4,
                    "an entry of 1 is 2 to the minus this counts",
                    format.unit.fraction_bits(),
                ),
            ],
        ),
        Register::new(
            "error_first",
            0x61,
            Access::Constant,
            "parameter of the build",
            vec![
                Field::new("error_first", 0, 32, "position of entry 0, from the origin")
                    .signed()
                    .with_unit("counts")
                    .with_reset(format.first_counts as u32),
            ],
        ),
    ]
}

fn loading(table: &ErrorTableConfig) -> Vec<Register> {
    let banks = [(0, "machine", "the machine's, a ROM"), (1, "loaded", "what was loaded")];
    let entry = |name: &str, meaning: &str| {
        Field::new(name, 0, ENTRY_BITS, meaning)
            .fixed(table.format().unit.fraction_bits())
            .with_unit("counts")
    };
    vec![
        Register::new(
            "error_control",
            0x62,
            Access::Configuration,
            "whether the error is taken from the reference once the axis is homed, and by which table",
            vec![
                Field::flag("error_enable", 0, "compensate, from HOLD on; it comes and goes slowly").with_reset(1),
                Field::choice(
                    "error_select",
                    1,
                    1,
                    "the table; another one comes in force through 0",
                    &banks,
                ),
            ],
        ),
        Register::new(
            "error_address",
            0x63,
            Access::Configuration,
            "which entry `ERROR_ENTRY` is",
            vec![
                Field::new("error_index", 0, 8, "its place"),
                Field::choice("error_bank", 8, 1, "1 to write", &banks),
            ],
        ),
        Register::new(
            "error_entry",
            0x64,
            Access::command("error_write"),
            "writes an entry: the first begins anew, others follow in turn",
            vec![entry("error_entry", "true less counted position")],
        ),
        Register::new(
            "error_read",
            0x65,
            Access::command("error_read"),
            "reads the entry at `ERROR_ADDRESS` back, which stays until `error_read_waits` is low",
            vec![],
        ),
        Register::new(
            "error_loaded",
            0x66,
            Access::Live,
            "what `ERROR_READ` found: 0 where no entry is loaded",
            vec![entry("error_loaded", "true less counted position")],
        ),
        Register::new(
            "error_status",
            0x67,
            Access::Live,
            "how much the table counts",
            vec![
                Field::new("error_weight", 0, 11, "0 nothing, 1024 all of the error"),
                Field::flag("error_bank_used", 16, "the table in use; taken while the weight is 0"),
                Field::flag("error_complete", 17, "all entries are loaded"),
                Field::flag("error_read_waits", 18, "`ERROR_READ` was not served yet"),
            ],
        ),
    ]
}

fn now() -> Register {
    Register::new(
        "error_now",
        0x68,
        Access::Live,
        "the error in force: the axis stands at `POSITION` and this",
        vec![
            Field::new("table_error", 0, 32, "true less counted position")
                .fixed(8)
                .with_unit("counts"),
        ],
    )
}

fn events() -> Register {
    Register::new(
        "error_events",
        0x69,
        Access::Sticky,
        "what has happened since the flag was cleared",
        vec![Field::flag(
            "error_refused",
            0,
            "an entry was refused: bank 1 in use, out of turn, or too steep",
        )],
    )
}
