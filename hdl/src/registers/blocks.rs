//! The clocked block of each register, with the declarations that it needs.

use super::text::{bits, joined, part, type_of};
use crate::emit::Type;
use crate::emit::print::Lines;
use posicast_blocks::registers::{Access, Field, FlagSource, Register, RegisterMap};

/// A flip-flop of the bank, as type, name and reset value.
pub(super) type Flop = (Type, String, u32);

/// Writes the declarations and the clocked block of one register.
pub(super) fn register_block(lines: &mut Lines, map: &RegisterMap, register: &Register) {
    let flops = flops(register);
    let title = |lines: &mut Lines| {
        let name = register.name.to_uppercase();
        lines.line(&format!("// {name}: {}; {}", register.access.words(), register.meaning));
    };
    let name = &register.name;
    let fields = &register.fields;
    match &register.access {
        Access::Configuration => {
            title(lines);
            clocked(lines, &flops, "else", |lines| {
                by_bytes(lines, &format!("write_{name}"), fields, "");
            });
        }
        Access::Guarded { .. } => {
            title(lines);
            clocked(
                lines,
                &flops,
                &format!("else if (write_{name} && allow_{name})"),
                |lines| {
                    for field in fields {
                        lines.line(&format!("{0} <= next_{0};", field.name));
                    }
                },
            );
        }
        Access::Staged => {
            title(lines);
            declare(lines, &flops, "staged_");
            clocked(lines, &flops, "else", |lines| {
                by_bytes(lines, &format!("write_{name} && !waits"), fields, "staged_");
                lines.nest("if (applies) begin", "end", |lines| {
                    for field in fields {
                        lines.line(&format!("{0} <= staged_{0};", field.name));
                    }
                });
            });
        }
        Access::Command { strobe } if fields.is_empty() => {
            title(lines);
            lines.line(&format!(
                "always @(posedge clk) {strobe} <= !rst && write_{name} && whole;"
            ));
        }
        Access::Command { strobe } => {
            title(lines);
            clocked(lines, &flops, "else", |lines| {
                lines.line(&format!("{strobe} <= write_{name} && whole;"));
                lines.nest(&format!("if (write_{name} && whole) begin"), "end", |lines| {
                    for field in fields {
                        lines.line(&format!("{} <= {};", field.name, part("avs_writedata", field)));
                    }
                });
            });
        }
        Access::Words { strobe, word, words } => {
            title(lines);
            clocked(lines, &flops, "else", |lines| {
                lines.line(&format!("{strobe} <= write_{name} && whole;"));
                lines.nest(&format!("if (write_{name} && whole) begin"), "end", |lines| {
                    lines.line(&format!("{word} <= avs_address[{}:0];", words.trailing_zeros() - 1));
                    for field in fields {
                        lines.line(&format!("{} <= {};", field.name, part("avs_writedata", field)));
                    }
                });
            });
        }
        Access::Sticky | Access::InterruptState => {
            title(lines);
            let prefix = sticky_prefix(register);
            declare(lines, &flops, "");
            clocked(lines, &flops, "else", |lines| {
                for field in fields {
                    let (flag, bit) = (format!("{prefix}{}", field.name), field.low);
                    let test = match (&register.access, map.find(|access| *access == Access::InterruptTest)) {
                        (Access::InterruptState, Some(test)) => {
                            format!(" || (write_{} && whole && avs_writedata[{bit}])", test.name)
                        }
                        _ => String::new(),
                    };
                    let kept = format!("({flag} && !(write_{name} && written[{bit}]))");
                    lines.line(&format!("{flag} <= {}{test} || {kept};", source(field)));
                }
            });
        }
        Access::InterruptEnable => {
            title(lines);
            declare(lines, &flops, "");
            clocked(lines, &flops, "else", |lines| {
                by_bytes(lines, &format!("write_{name}"), fields, "irq_enable_");
            });
        }
        Access::Commit { .. } => {
            title(lines);
            clocked(lines, &flops, "else", |lines| {
                lines.line(&format!("waits <= !applies && (waits || (write_{name} && whole));"));
            });
        }
        Access::Constant | Access::Live | Access::Shadow { .. } | Access::Snapshot | Access::InterruptTest => {}
    }
}

/// Writes each enabled byte of the bus. With one enable per byte a flip-flop needs no logic of its own.
fn by_bytes(lines: &mut Lines, condition: &str, fields: &[Field], prefix: &str) {
    for byte in 0..4 {
        let in_byte = |field: &Field| {
            let low = field.low.max(8 * byte);
            let end = (field.low + field.width).min(8 * byte + 8);
            (low < end).then(|| Field::new(&field.name, low, end - low, ""))
        };
        let parts = fields.iter().filter_map(|field| Some((field, in_byte(field)?)));
        let taken: Vec<String> = parts
            .map(|(field, taken)| {
                let name = format!("{prefix}{}", field.name);
                let target = if taken.width == field.width {
                    name
                } else {
                    part(&name, &Field::new("", taken.low - field.low, taken.width, ""))
                };
                format!("{target} <= {};", part("avs_writedata", &taken))
            })
            .collect();
        let test = format!("if ({condition} && avs_byteenable[{byte}])");
        match taken.as_slice() {
            [] => {}
            [one] => lines.line(&format!("{test} {one}")),
            several => lines.nest(&format!("{test} begin"), "end", |lines| {
                several.iter().for_each(|line| lines.line(line));
            }),
        }
    }
}

pub(super) fn guarded(lines: &mut Lines, register: &Register, while_low: &str) {
    for field in &register.fields {
        let declaration = type_of(field).declaration();
        let space = if declaration.is_empty() { "" } else { " " };
        let (name, written, mask) = (&field.name, part("written", field), part("mask", field));
        lines.line(&format!(
            "wire {declaration}{space}next_{name} = {written} | ({name} & ~{mask});"
        ));
    }
    let minima = register.fields.iter().filter(|field| field.minimum > 0).map(|field| {
        // A concatenation is unsigned, even of signed values.
        let next = if field.is_signed() {
            format!("{{next_{}}}", field.name)
        } else {
            format!("next_{}", field.name)
        };
        format!("{next} >= {}", bits(field.width).literal(field.minimum.into()))
    });
    let terms: Vec<String> = std::iter::once(format!("!{while_low}")).chain(minima).collect();
    joined(lines, &format!("wire allow_{} = ", register.name), &terms, " && ", ";");
}

pub(super) fn sticky_prefix(register: &Register) -> &'static str {
    match register.access {
        Access::InterruptState => "irq_state_",
        _ => "flag_",
    }
}

fn source(field: &Field) -> &str {
    match field.source {
        FlagSource::Input => &field.name,
        FlagSource::PartialWrite => "bus_partial",
        FlagSource::GuardRefused => "bus_refused",
        FlagSource::CommitRejected => "bus_rejected",
    }
}

/// The flip-flops of a register, outputs and others, without its shadow.
pub(super) fn flops(register: &Register) -> Vec<Flop> {
    let fields = |prefix: &str| -> Vec<Flop> {
        let flop = |field: &Field| (type_of(field), format!("{prefix}{}", field.name), field.reset);
        register.fields.iter().map(flop).collect()
    };
    match &register.access {
        Access::Configuration | Access::Guarded { .. } => fields(""),
        Access::Staged => [fields("staged_"), fields("")].concat(),
        Access::Command { strobe } => [vec![(bits(1), strobe.clone(), 0)], fields("")].concat(),
        Access::Words { strobe, word, words } => {
            let place = (bits(words.trailing_zeros()), word.clone(), 0);
            [vec![(bits(1), strobe.clone(), 0), place], fields("")].concat()
        }
        Access::Sticky | Access::InterruptState => fields(sticky_prefix(register)),
        Access::InterruptEnable => fields("irq_enable_"),
        Access::Commit { .. } => vec![(bits(1), "waits".to_owned(), 0)],
        Access::Constant | Access::Live | Access::Shadow { .. } | Access::Snapshot | Access::InterruptTest => {
            Vec::new()
        }
    }
}

/// Declares the flip-flops whose names begin with `prefix`: those that are not outputs.
pub(super) fn declare(lines: &mut Lines, flops: &[Flop], prefix: &str) {
    for (ty, name, _) in flops.iter().filter(|(_, name, _)| name.starts_with(prefix)) {
        let declaration = ty.declaration();
        let space = if declaration.is_empty() { "" } else { " " };
        lines.line(&format!("reg {declaration}{space}{name};"));
    }
}

/// Writes a clocked block that resets `flops`; `inner` writes the other branch, and `otherwise` is its `else` or
/// `else if (..)`.
pub(super) fn clocked(lines: &mut Lines, flops: &[Flop], otherwise: &str, inner: impl FnOnce(&mut Lines)) {
    lines.nest(
        "always @(posedge clk) if (rst) begin",
        &format!("end {otherwise} begin"),
        |lines| {
            for (ty, name, reset) in flops {
                lines.line(&format!("{name} <= {};", ty.literal((*reset).into())));
            }
        },
    );
    lines.nest_rest("end", inner);
}

/// The registers that have a shadow.
fn shadowed(map: &RegisterMap) -> impl Iterator<Item = &Register> {
    map.registers()
        .iter()
        .filter(|register| matches!(register.access, Access::Shadow { .. }))
}

pub(super) fn shadow_flops(map: &RegisterMap) -> Vec<Flop> {
    let fields = shadowed(map).flat_map(|register| map.fields(register));
    fields
        .map(|field| (type_of(field), format!("shadow_{}", field.name), 0))
        .collect()
}

pub(super) fn shadows(lines: &mut Lines, map: &RegisterMap) {
    let Some(snapshot) = map.find(|access| *access == Access::Snapshot) else {
        return;
    };
    lines.line(&format!("// {}: {}", snapshot.name.to_uppercase(), snapshot.meaning));
    let flops = shadow_flops(map);
    declare(lines, &flops, "");
    clocked(
        lines,
        &flops,
        &format!("else if (write_{} && whole)", snapshot.name),
        |lines| {
            for field in shadowed(map).flat_map(|register| map.fields(register)) {
                lines.line(&format!("shadow_{0} <= {0};", field.name));
            }
        },
    );
}

pub(super) fn interrupt(lines: &mut Lines, map: &RegisterMap) {
    let Some(state) = map.find(|access| *access == Access::InterruptState) else {
        return;
    };
    let terms: Vec<String> = state
        .fields
        .iter()
        .map(|field| format!("(irq_state_{0} && irq_enable_{0})", field.name))
        .collect();
    let irq = [(bits(1), "irq".to_owned(), 0)];
    clocked(lines, &irq, "else", |lines| {
        joined(lines, "irq <= ", &terms, " || ", ";")
    });
}
