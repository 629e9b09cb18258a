//! Writes register maps as documents that other tools read.
//!
//! | file | format | for |
//! |---|---|---|
//! | `docs/NAME.md` | Markdown | people |
//! | `docs/NAME.rdl` | SystemRDL 2.0 | PeakRDL and similar tools: HTML, UVM, IP-XACT |
//! | `docs/NAME.svd` | CMSIS-SVD 1.3 | debuggers, and generators of register access in C and Rust |
//!
//! All three come from the one [`RegisterMap`]. IP-XACT is written for cores on AXI4-Lite only ([`crate::amd`]); PeakRDL makes it from the
//! SystemRDL, too.
//!
//! On the bus each word has an address of its own; in these formats addresses count bytes: word · 4.

mod svd;
mod systemrdl;

use crate::datasheets::FOLDER;
use posicast_blocks::registers::{Access, Field, Register, RegisterMap, markdown};

/// Bytes per word.
pub(crate) const WORD_BYTES: u32 = 4;

/// The documents `name` of the registers that all components `tops` have, as path in the output folder and text.
pub fn files(name: &str, tops: &[String], map: &RegisterMap) -> [(String, String); 3] {
    let path = |ending: &str| format!("{FOLDER}/{name}.{ending}");
    let components = match tops {
        [top] if top == name => String::new(),
        tops => format!("Components with these registers: {}.", tops.join(", ")),
    };
    let table = match components.as_str() {
        "" => markdown(map),
        components => format!("{components}\n\n{}", markdown(map)),
    };
    [
        (path("md"), format!("# Registers of {name}\n\n{table}")),
        (path("rdl"), systemrdl::document(name, &components, map)),
        (path("svd"), svd::document(name, &components, map)),
    ]
}

/// The descriptive text of a map, and the components that have it.
fn about(components: &str, map: &RegisterMap) -> String {
    format!("{} {components}", map.about()).trim_end().to_owned()
}

/// Access of software to a register.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Software {
    Read,
    ReadWrite,
    /// Reads flags; writing one clears them.
    ReadClear,
    Write,
}

pub(crate) fn software(access: &Access) -> Software {
    match access {
        Access::Constant | Access::Live | Access::Shadow { .. } => Software::Read,
        Access::Configuration
        | Access::Guarded { .. }
        | Access::Staged
        | Access::InterruptEnable
        | Access::Commit { .. } => Software::ReadWrite,
        Access::Sticky | Access::InterruptState => Software::ReadClear,
        Access::Command { .. } | Access::Words { .. } | Access::Snapshot | Access::InterruptTest => Software::Write,
    }
}

/// Returns its fields; one for the whole word if a write of any value has an effect.
pub(crate) fn fields(map: &RegisterMap, register: &Register) -> Vec<Field> {
    match map.fields(register) {
        [] => vec![Field::new("any", 0, 32, "any value: the write itself counts")],
        fields => fields.to_vec(),
    }
}

/// Whether it has a value after reset that software can rely on.
fn has_reset(access: &Access) -> bool {
    !matches!(access, Access::Live | Access::Shadow { .. }) && software(access) != Software::Write
}

/// The text in XML.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// Meaning of a field, with its unit in brackets.
pub(crate) fn meaning(field: &Field) -> String {
    match field.unit.as_str() {
        "" => field.meaning.clone(),
        unit => format!("{} [{unit}]", field.meaning),
    }
}
