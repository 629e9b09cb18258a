//! Writes C macros for registers and their fields.

use posicast_blocks::registers::{Access, Field, Format, Register};
use std::fmt::Write;

/// Address of a register's word, in C.
pub(super) enum Place {
    /// The register's offset.
    Fixed,
    /// The register's offset in the window of an axis, which is an argument of the macro.
    Axis,
}

/// The first lines of every header, with its include guard.
pub(super) fn head(guard: &str, about: &str) -> String {
    format!(
        "/*\n * {about}\n * Written by posicast from the description of the registers.\n */\n#ifndef {guard}\n#define {guard}\n"
    )
}

/// The last line of a header.
pub(super) const END: &str = "\n#endif\n";

/// The macros of a register: its word, its read and write access, its fields. `fields` are its own, or those of the
/// register that it shadows.
pub(super) fn register(text: &mut String, prefix: &str, register: &Register, fields: &[Field], place: &Place) {
    let name = format!("{prefix}_{}", register.name.to_uppercase());
    // Writing to a String cannot fail.
    let _ = writeln!(
        text,
        "\n/* {}, {}: {} */",
        register.name.to_uppercase(),
        register.access.words(),
        register.meaning
    );
    let _ = writeln!(text, "#define {name}_REG {:#04x}u", register.offset);
    let (mut arguments, mut word) = match place {
        Place::Fixed => ("base".to_owned(), format!("{name}_REG")),
        Place::Axis => ("base, axis".to_owned(), format!("POSICAST_AXIS_WORD(axis, {name}_REG)")),
    };
    if register.words() > 1 {
        arguments += ", word";
        word += " + (uint32_t)(word)";
    }
    if readable(&register.access) {
        let _ = writeln!(text, "#define IORD_{name}({arguments}) IORD(base, {word})");
    }
    if writable(&register.access) {
        let _ = writeln!(text, "#define IOWR_{name}({arguments}, data) IOWR(base, {word}, data)");
    }
    if register.access == Access::Constant && matches!(place, Place::Fixed) {
        let _ = writeln!(text, "#define {name}_RESET {:#x}u", register.reset());
    }
    for field in fields {
        write_field(text, &name, &register.name, field);
    }
}

/// The macros of a field; the only field of a register, which has its name, has it once.
fn write_field(text: &mut String, word: &str, register: &str, field: &Field) {
    let name = if field.name == register {
        word.to_owned()
    } else {
        format!("{word}_{}", field.name.to_uppercase())
    };
    let _ = writeln!(text, "#define {name}_OFST {}u", field.low);
    let _ = writeln!(text, "#define {name}_MSK {:#x}u", field.mask());
    if let Format::Enumeration(choices) = &field.format {
        for choice in choices {
            let _ = writeln!(text, "#define {name}_{} {}u", choice.name.to_uppercase(), choice.value);
        }
    }
}

fn readable(access: &Access) -> bool {
    !matches!(
        access,
        Access::Command { .. } | Access::Words { .. } | Access::Snapshot | Access::InterruptTest
    )
}

fn writable(access: &Access) -> bool {
    !matches!(access, Access::Constant | Access::Live | Access::Shadow { .. })
}
