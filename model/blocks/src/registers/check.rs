//! Checks a description for consistency.

use super::description::{
    Access, Description, Field, FlagSource, Format, MOST_WINDOWS, Register, WINDOW_WORDS, WORD_BITS,
};
use super::error::MapError;

/// Names that the bank's Verilog uses itself.
const RESERVED: [&str; 9] = [
    "clk", "rst", "irq", "mask", "whole", "written", "waits", "applies", "unused",
];
/// Prefixes of such names.
const RESERVED_PREFIXES: [&str; 9] = [
    "avs_",
    "bus_",
    "write_",
    "next_",
    "allow_",
    "shadow_",
    "staged_",
    "flag_",
    "interrupt_",
];

pub(super) fn check(description: &Description) -> Result<(), MapError> {
    form(&description.name)?;
    if !(1..=MOST_WINDOWS).contains(&description.windows) {
        return Err(MapError::Windows(description.windows));
    }
    let registers = &description.registers;
    beginning(registers)?;
    for (at, register) in registers.iter().enumerate() {
        form(&register.name)?;
        let before = &registers[..at];
        if before.iter().any(|other| other.name == register.name) {
            return Err(MapError::RegisterTwice(register.name.clone()));
        }
        let end = |register: &Register| u64::from(register.offset) + u64::from(register.words());
        let overlaps =
            |other: &Register| u64::from(other.offset) < end(register) && u64::from(register.offset) < end(other);
        if before.iter().any(overlaps) || end(register) > u64::from(description.windows * WINDOW_WORDS) {
            return Err(MapError::Offset {
                register: register.name.clone(),
                offset: register.offset,
                last: description.windows * WINDOW_WORDS - 1,
            });
        }
        fields(register)?;
        access(register, registers)?;
    }
    for access in [Access::Live, Access::Sticky] {
        once(registers, &access)?;
    }
    together(registers)
}

/// Checks that each field name occurs once among the registers of an access, so that its flag or shadow has a unique
/// name.
fn once(registers: &[Register], access: &Access) -> Result<(), MapError> {
    let mut seen = Vec::new();
    for register in registers.iter().filter(|register| register.access == *access) {
        for field in &register.fields {
            if seen.contains(&&field.name) {
                return Err(MapError::Port {
                    register: register.name.clone(),
                    port: field.name.clone(),
                });
            }
            seen.push(&field.name);
        }
    }
    Ok(())
}

fn form(name: &str) -> Result<(), MapError> {
    let mut characters = name.chars();
    let formed = characters.next().is_some_and(|first| first.is_ascii_lowercase())
        && characters.all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_');
    if formed {
        Ok(())
    } else {
        Err(MapError::Name(name.to_owned()))
    }
}

/// Checks that a name can be that of a port.
fn port_name(name: &str) -> Result<(), MapError> {
    form(name)?;
    if RESERVED.contains(&name) || RESERVED_PREFIXES.iter().any(|prefix| name.starts_with(prefix)) {
        return Err(MapError::Name(name.to_owned()));
    }
    Ok(())
}

fn beginning(registers: &[Register]) -> Result<(), MapError> {
    let is = |at: usize, name: &str| {
        let register = registers.get(at);
        register.is_some_and(|r| r.name == name && r.offset as usize == at && r.access == Access::Constant)
    };
    if is(0, "magic") && is(1, "version") {
        Ok(())
    } else {
        Err(MapError::Beginning)
    }
}

fn fields(register: &Register) -> Result<(), MapError> {
    let mut taken = 0;
    for (at, field) in register.fields.iter().enumerate() {
        port_name(&field.name)?;
        if register.fields[..at].iter().any(|other| other.name == field.name) {
            return Err(MapError::Port {
                register: register.name.clone(),
                port: field.name.clone(),
            });
        }
        let high = i64::from(field.low) + i64::from(field.width) - 1;
        let fits = (1..=WORD_BITS).contains(&field.width) && high < i64::from(WORD_BITS);
        if !fits || taken & field.mask() != 0 {
            return Err(MapError::Bits {
                register: register.name.clone(),
                field: field.name.clone(),
                low: field.low,
                high,
            });
        }
        taken |= field.mask();
        values(register, field)?;
    }
    Ok(())
}

fn values(register: &Register, field: &Field) -> Result<(), MapError> {
    let wrong = |what, found| MapError::Value {
        register: register.name.clone(),
        field: field.name.clone(),
        what,
        found,
        width: field.width,
    };
    let fits = |value: u32| value <= field.ones();
    if !fits(field.reset) || field.reset < field.minimum {
        return Err(wrong("the reset value", field.reset));
    }
    if field.minimum > 0 && !(fits(field.minimum) && matches!(register.access, Access::Guarded { .. })) {
        return Err(wrong("the minimum", field.minimum));
    }
    match &field.format {
        Format::Flag if field.width != 1 => Err(wrong("the width of the flag", field.width)),
        Format::Fixed { fraction } if *fraction > field.width => Err(wrong("the fraction", *fraction)),
        Format::Enumeration(choices) => {
            for (at, choice) in choices.iter().enumerate() {
                form(&choice.name)?;
                let twice = choices[..at]
                    .iter()
                    .any(|other| other.value == choice.value || other.name == choice.name);
                if twice || !fits(choice.value) {
                    return Err(wrong("a choice", choice.value));
                }
            }
            Ok(())
        }
        _ => Ok(()),
    }
}

/// Checks the requirements of an access on its own register.
fn access(register: &Register, registers: &[Register]) -> Result<(), MapError> {
    let wrong = |rule| {
        Err(MapError::Fields {
            register: register.name.clone(),
            rule,
        })
    };
    let bits = register.fields.iter().all(|field| field.width == 1 && field.reset == 0);
    match &register.access {
        Access::Shadow { of } => {
            let live = registers.iter().any(|r| r.name == *of && r.access == Access::Live);
            if !live || !register.fields.is_empty() {
                return Err(MapError::Shadow {
                    shadow: register.name.clone(),
                    of: of.clone(),
                });
            }
        }
        Access::Words { strobe, word, words } => {
            port_name(strobe)?;
            port_name(word)?;
            let formed = words.is_power_of_two() && (2..=64).contains(words);
            if !formed || !register.offset.is_multiple_of(*words) {
                return wrong("2, 4, … 64 words, the first at a multiple of that");
            }
        }
        Access::Guarded { while_low: input } | Access::Commit { tick: input } | Access::Command { strobe: input } => {
            port_name(input)?;
            let fields = register.fields.len();
            match register.access {
                Access::Commit { .. } if !bits || fields != 1 || register.fields[0].low != 0 => {
                    return wrong("a commit has one flag, at bit 0");
                }
                Access::Guarded { .. } if fields == 0 => return wrong("it needs a field"),
                _ => {}
            }
        }
        Access::Snapshot if !register.fields.is_empty() => return wrong("a snapshot has none"),
        Access::Sticky | Access::InterruptState | Access::InterruptEnable | Access::InterruptTest
            if !bits || register.fields.is_empty() =>
        {
            return wrong("flags of one bit, 0 after reset");
        }
        Access::Live if register.reset() != 0 => return wrong("a live register has no reset value"),
        Access::Live | Access::Configuration | Access::Staged if register.fields.is_empty() => {
            return wrong("it needs a field");
        }
        _ => {}
    }
    let may_choose = register.access.is_sticky();
    if !may_choose && !matches!(register.access, Access::InterruptEnable | Access::InterruptTest) {
        let chosen = register.fields.iter().any(|field| field.source != FlagSource::Input);
        if chosen {
            return wrong("only flags have a source");
        }
    }
    Ok(())
}

/// Checks the requirements of registers on each other.
fn together(registers: &[Register]) -> Result<(), MapError> {
    let count = |holds: &dyn Fn(&Access) -> bool| registers.iter().filter(|r| holds(&r.access)).count();
    let shadows = count(&|a| matches!(a, Access::Shadow { .. }));
    let staged = count(&|a| *a == Access::Staged);
    let guarded = count(&|a| matches!(a, Access::Guarded { .. }));
    let whole_words = count(&Access::whole_words);
    let interrupts = count(&|a| *a == Access::InterruptState);
    let has_flag = |source: FlagSource| {
        let flags = registers
            .iter()
            .filter(|r| r.access.is_sticky())
            .flat_map(|r| &r.fields);
        flags.into_iter().any(|field| field.source == source)
    };
    let exactly = |access, found: usize, wanted: bool, rule| {
        if found == usize::from(wanted) {
            Ok(())
        } else {
            Err(MapError::Missing { access, found, rule })
        }
    };
    let snapshots = count(&|a| *a == Access::Snapshot);
    exactly(
        "snapshot",
        snapshots,
        shadows > 0,
        "one where there are shadows, else none",
    )?;
    let commits = count(&|a| matches!(a, Access::Commit { .. }));
    exactly(
        "commit",
        commits,
        staged > 0,
        "one where there are staged registers, else none",
    )?;
    let any = interrupts > 0;
    exactly("interrupt state", interrupts, any, "one at most")?;
    let rule = "one where there is an interrupt state, with the same fields";
    let flags = registers.iter().find(|r| r.access == Access::InterruptState);
    for (access, words) in [
        (Access::InterruptEnable, "interrupt enable"),
        (Access::InterruptTest, "interrupt test"),
    ] {
        let alike = |r: &&Register| r.access == access && flags.is_none_or(|flags| flags.fields == r.fields);
        exactly(words, count(&|a| *a == access), any, rule)?;
        exactly(words, registers.iter().filter(alike).count(), any, rule)?;
    }
    for (access, needed, source, rule) in [
        (
            "command",
            whole_words,
            FlagSource::PartialWrite,
            "a flag set by `PartialWrite` is needed",
        ),
        (
            "guarded",
            guarded,
            FlagSource::GuardRefused,
            "a flag set by `GuardRefused` is needed",
        ),
        (
            "staged",
            staged,
            FlagSource::CommitRejected,
            "a flag set by `CommitRejected` is needed",
        ),
    ] {
        if needed > 0 && !has_flag(source) {
            return Err(MapError::Missing {
                access,
                found: needed,
                rule,
            });
        }
    }
    Ok(())
}
