//! The declarations of a VCD.

use std::collections::HashMap;

use vcd::{Command, IdCode, ReferenceIndex, VarType};

use super::Reader;
use crate::Error;

const SIGNALS: usize = 1 << 18;
const NAME_BYTES: usize = 1 << 25;
const DEPTH: usize = 256;
const TOTAL_BITS: u64 = 1 << 24;

/// How a signal's values are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// So many bits.
    Bits(u32),
    /// A real number.
    Real,
    /// Text or an event: no value that can be compared.
    Other,
}

/// A declared signal.
#[derive(Debug, Clone)]
pub(crate) struct Named {
    /// Scopes and name, joined by dots; without the range of a vector, with the index of a single bit.
    pub(crate) path: String,
    /// Its value.
    pub(crate) slot: u32,
}

impl Reader {
    pub(super) fn read_header(&mut self) -> Result<(), Error> {
        let mut header = Header::default();
        loop {
            let Some(command) = self.command()? else {
                return Err(self.truncated("before $enddefinitions"));
            };
            match command {
                Command::Enddefinitions => break,
                Command::Timescale(number, unit) => {
                    let exponent = match unit {
                        vcd::TimescaleUnit::S => 15,
                        vcd::TimescaleUnit::MS => 12,
                        vcd::TimescaleUnit::US => 9,
                        vcd::TimescaleUnit::NS => 6,
                        vcd::TimescaleUnit::PS => 3,
                        vcd::TimescaleUnit::FS => 0,
                    };
                    if ![1, 10, 100].contains(&number) {
                        return Err(self.problem(format!("timescale {number} {unit}: the number is 1, 10 or 100")));
                    }
                    self.unit_fs = u64::from(number) * 10u64.pow(exponent);
                }
                Command::ScopeDef(_, name) => header.enter(&name).map_err(|what| self.problem(what))?,
                Command::Upscope => {
                    if header.scope_ends.pop().is_none() {
                        return Err(self.problem("$upscope without $scope: the file is damaged".to_owned()));
                    }
                    let end = header.scope_ends.last().copied().unwrap_or(0);
                    header.scope.truncate(end);
                }
                Command::VarDef(var_type, width, id, name, index) => {
                    self.declare(&mut header, var_type, width, id, &name, index)?;
                }
                Command::Comment(_) | Command::Date(_) | Command::Version(_) => {}
                _ => return Err(self.problem("a value before $enddefinitions: the file is damaged".to_owned())),
            }
        }
        if !header.scope_ends.is_empty() {
            return Err(self.problem("a $scope is still open at $enddefinitions: the file is damaged".to_owned()));
        }
        Ok(())
    }

    fn declare(
        &mut self,
        header: &mut Header,
        var_type: VarType,
        width: u32,
        id: IdCode,
        name: &str,
        index: Option<ReferenceIndex>,
    ) -> Result<(), Error> {
        let kind = match var_type {
            VarType::Real => Kind::Real,
            VarType::String | VarType::Event => Kind::Other,
            _ => Kind::Bits(width),
        };
        if kind == Kind::Bits(0) {
            return Err(self.problem(format!("signal `{name}` has 0 bits: the file is damaged")));
        }
        let slot = match self.slots.get(&id).copied() {
            Some(slot) if self.values.kind(slot) == kind => slot,
            Some(_) => {
                return Err(self.problem(format!("`{id}` is declared twice, with different widths or types")));
            }
            None => {
                header.bits += u64::from(width);
                if header.bits > TOTAL_BITS {
                    return Err(self.problem(format!(
                        "the signals have more than {TOTAL_BITS} bits together: leave out memories and wide arrays when \
                         dumping"
                    )));
                }
                let slot = self.values.add(kind);
                self.slots.insert(id, slot);
                slot
            }
        };
        let Some(path) = header.path(name, index, slot).map_err(|what| self.problem(what))? else {
            return Ok(());
        };
        if self.names.len() == SIGNALS {
            return Err(self.problem(format!("more than {SIGNALS} signals: dump fewer scopes")));
        }
        self.names.push(Named { path, slot });
        Ok(())
    }
}

#[derive(Default)]
struct Header {
    /// The open scopes, each followed by a dot, and where each ends.
    scope: String,
    scope_ends: Vec<usize>,
    name_bytes: usize,
    bits: u64,
    /// How often a path was declared, and its slot at first.
    seen: HashMap<String, (u32, u32)>,
}

impl Header {
    fn enter(&mut self, name: &str) -> Result<(), String> {
        if self.scope_ends.len() == DEPTH || self.scope.len() + name.len() > NAME_BYTES {
            return Err(format!("scopes more than {DEPTH} deep: the file is damaged"));
        }
        self.scope.push_str(name);
        self.scope.push('.');
        self.scope_ends.push(self.scope.len());
        Ok(())
    }

    /// The full name of a signal; `None` if it was declared before, for the same value.
    fn path(&mut self, name: &str, index: Option<ReferenceIndex>, slot: u32) -> Result<Option<String>, String> {
        // An escaped name that needs no escape is the plain one.
        let name = name.strip_prefix('\\').unwrap_or(name);
        // Some writers join the range to the name.
        let name = match name.rfind('[') {
            Some(at) if at > 0 && name.ends_with(']') && name[at..].contains(':') => &name[..at],
            _ => name,
        };
        self.name_bytes += self.scope.len() + name.len();
        if self.name_bytes > NAME_BYTES {
            return Err(format!("more than {NAME_BYTES} bytes of names: dump fewer scopes"));
        }
        let mut path = format!("{}{name}", self.scope);
        if let Some(ReferenceIndex::BitSelect(bit)) = index {
            path.push_str(&format!("[{bit}]"));
        }
        let (count, first) = self.seen.entry(path.clone()).or_insert((0, slot));
        *count += 1;
        if *count > 1 && *first == slot {
            return Ok(None);
        }
        if *count > 1 {
            // Twice the same name: kept apart by their order, so that neither is lost.
            path.push_str(&format!("#{count}"));
        }
        Ok(Some(path))
    }
}
