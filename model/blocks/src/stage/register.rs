//! Makes the registers of an axis for the parts of its window.

use crate::registers::{Access, Field, Register};

/// Access of registers that change the loop's feedback: written only while the axis's drive is off.
pub(super) fn with_the_drive_off() -> Access {
    Access::Guarded {
        while_low: "drive_enable".to_owned(),
    }
}

pub(super) fn command(strobe: &str) -> Access {
    Access::Command {
        strobe: strobe.to_owned(),
    }
}

/// A register of an axis, without the axis's name.
pub(super) fn register(name: &str, offset: u32, access: Access, meaning: &str, fields: Vec<Field>) -> Register {
    Register {
        name: name.to_owned(),
        offset,
        access,
        meaning: meaning.to_owned(),
        fields,
    }
}
