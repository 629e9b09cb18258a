//! A register map as Markdown: the page `docs/TOP.md` of a package.

use super::description::{Access, Field, Format, Register, WINDOW_WORDS};
use super::map::RegisterMap;
use std::fmt::Write;

/// The tables of a map, for each of its windows: one of its registers, one of their fields, one of each enumeration.
pub fn markdown(map: &RegisterMap) -> String {
    let windows = map.words() / WINDOW_WORDS;
    let mut text = format!("## {}\n\n{}\n\n", map.name(), map.about());
    let has_windows = map.words() > WINDOW_WORDS;
    let parts = (0..windows).map(|window| {
        let is_in = |register: &&Register| register.offset / WINDOW_WORDS == window;
        let registers: Vec<&Register> = map.registers().iter().filter(is_in).collect();
        if has_windows {
            format!("### {}\n\n{}", heading(window, &registers), tables(&registers))
        } else {
            tables(&registers)
        }
    });
    text.push_str(&parts.collect::<Vec<_>>().join("\n"));
    text
}

/// Name of a window: that of its axis, with which the names of all its registers begin.
fn heading(window: u32, registers: &[&Register]) -> String {
    let names = || registers.iter().map(|register| register.name.as_str());
    let first = names().next().unwrap_or_default();
    let begins = first.match_indices('_').map(|(end, _)| &first[..=end]);
    let common = begins.rev().find(|begin| names().all(|name| name.starts_with(*begin)));
    match common {
        Some(axis) if window > 0 => format!("window {window}: axis `{}`", axis.trim_end_matches('_')),
        _ => format!("window {window}: all axes"),
    }
}

fn tables(registers: &[&Register]) -> String {
    let mut text = "| word | register | access | reset | meaning |\n|---|---|---|---|---|\n".to_owned();
    for register in registers {
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "| {} | `{}` | {} | {} | {} |",
            place(register),
            register.name.to_uppercase(),
            access(register),
            reset(register),
            register.meaning,
        );
    }
    text.push_str("\n| register | bits | field | format | unit | reset | meaning |\n|---|---|---|---|---|---|---|\n");
    for register in registers {
        // A shadow has the same fields, which are listed once.
        if matches!(
            register.access,
            Access::Shadow { .. } | Access::InterruptEnable | Access::InterruptTest
        ) {
            continue;
        }
        for field in &register.fields {
            let _ = writeln!(
                text,
                "| `{}` | {} | `{}` | {} | {} | {} | {} |",
                register.name.to_uppercase(),
                bits(field),
                field.name,
                format(field),
                field.unit,
                field_reset(register, field),
                meaning(field),
            );
        }
    }
    for (register, field) in registers.iter().flat_map(|r| r.fields.iter().map(move |f| (r, f))) {
        if let Format::Enumeration(choices) = &field.format {
            let register = register.name.to_uppercase();
            let _ = writeln!(
                text,
                "\n| `{register}.{}` | name | meaning |\n|---|---|---|",
                field.name
            );
            for choice in choices {
                let _ = writeln!(
                    text,
                    "| {} | `{}` | {} |",
                    choice.value,
                    choice.name.to_uppercase(),
                    choice.meaning
                );
            }
        }
    }
    text
}

/// The offset of the word, or of the words.
fn place(register: &Register) -> String {
    match register.words() {
        1 => format!("{:#04x}", register.offset),
        words => format!("{:#04x} to {:#04x}", register.offset, register.offset + words - 1),
    }
}

fn access(register: &Register) -> String {
    match &register.access {
        Access::Shadow { of } => format!("shadow of `{}`", of.to_uppercase()),
        Access::Guarded { while_low } => format!("guarded: while `{while_low}` is low"),
        Access::Command { strobe } => format!("command `{strobe}`"),
        Access::Words { strobe, word, .. } => format!("command `{strobe}`, the place in `{word}`"),
        Access::Commit { tick } => format!("commit at `{tick}`"),
        other => other.words().to_owned(),
    }
}

/// The reset value, of registers that have a value of their own.
fn reset(register: &Register) -> String {
    match register.access {
        Access::Live | Access::Command { .. } | Access::Words { .. } | Access::Snapshot | Access::InterruptTest => {
            String::new()
        }
        _ => format!("{:#x}", register.reset()),
    }
}

fn field_reset(register: &Register, field: &Field) -> String {
    match register.access {
        Access::Live => String::new(),
        _ if field.is_signed() => {
            let unused = 32 - field.width;
            (((field.reset << unused) as i32) >> unused).to_string()
        }
        _ if field.reset > 0xffff => format!("{:#x}", field.reset),
        _ => field.reset.to_string(),
    }
}

fn bits(field: &Field) -> String {
    match field.width {
        1 => field.low.to_string(),
        width => format!("{}:{}", field.low + width - 1, field.low),
    }
}

fn format(field: &Field) -> String {
    match &field.format {
        Format::Unsigned => "unsigned".to_owned(),
        Format::Signed => "signed".to_owned(),
        Format::Fixed { fraction } => format!("signed Q{}.{fraction}", field.width - fraction),
        Format::Flag => "flag".to_owned(),
        Format::Enumeration(_) => "one of".to_owned(),
    }
}

fn meaning(field: &Field) -> String {
    let least = match field.minimum {
        0 => String::new(),
        minimum => format!("; at least {minimum}"),
    };
    format!("{}{least}", field.meaning)
}
