//! Decides which construct drives each net: a direct connection to its source, a continuous `assign`, or the
//! `always @(*)` block.
//!
//! A net that is assigned once and unconditionally needs no `always`. That reads better, and the net has a value from
//! the start: nothing would trigger an `always` block of constants, and the net would stay X in an event simulator.

use super::error::{EmitCause, EmitError};
use super::ir::{Expression, Statement, each};
use super::scope::{Net, NetId, Role, Scope};
use super::types::mask;
use std::collections::{BTreeMap, BTreeSet};

/// A kernel, sorted by construct. A comment is kept once, with the statement that follows it.
#[derive(Debug, Default)]
pub(super) struct Drivers {
    /// Inputs of registers and sub-blocks that are driven by another net or by a short expression.
    pub(super) direct: BTreeMap<NetId, Expression>,
    /// The comments for the wiring of these inputs.
    pub(super) notes: BTreeMap<NetId, Vec<String>>,
    /// Comments and assignments.
    pub(super) continuous: Vec<Statement>,
    pub(super) procedural: Vec<Statement>,
}

impl Drivers {
    /// Sorts `kernel`, which has passed the [`flow`](super::flow) check.
    pub(super) fn new(kernel: Vec<Statement>, path: &str, scope: &Scope) -> Result<Self, EmitError> {
        let kernel = drop_overridden(kernel);
        let mut writes: BTreeMap<NetId, usize> = BTreeMap::new();
        each(&kernel, &mut |statement| {
            if let Statement::Assign { target, .. } = statement {
                *writes.entry(*target).or_default() += 1;
            }
        });
        let mut drivers = Self::default();
        let mut comments = Vec::new();
        for statement in kernel {
            match statement {
                Statement::Comment(text) => comments.push(text),
                Statement::Assign { target, ref value } if writes.get(&target) == Some(&1) => {
                    if is_direct(value, scope.net(target)) {
                        drivers.notes.entry(target).or_default().append(&mut comments);
                        drivers.direct.insert(target, value.clone());
                    } else {
                        drivers.continuous.extend(comments.drain(..).map(Statement::Comment));
                        drivers.continuous.push(statement);
                    }
                }
                _ => {
                    drivers.procedural.extend(comments.drain(..).map(Statement::Comment));
                    drivers.procedural.push(statement);
                }
            }
        }
        drivers.check_trigger(path, scope)?;
        Ok(drivers)
    }

    /// The bits of each net that the kernel and the wires read.
    pub(super) fn bits_read(&self) -> BTreeMap<NetId, u64> {
        let mut bits: BTreeMap<NetId, u64> = BTreeMap::new();
        let mut collect = |statement: &Statement| {
            for (id, mask) in statement.own_reads() {
                *bits.entry(*id).or_default() |= mask;
            }
        };
        each(&self.continuous, &mut collect);
        each(&self.procedural, &mut collect);
        for (id, mask) in self.direct.values().flat_map(|source| &source.reads) {
            *bits.entry(*id).or_default() |= mask;
        }
        bits
    }

    /// The nets that the `always` block drives.
    pub(super) fn procedural_targets(&self) -> BTreeSet<NetId> {
        let mut targets = BTreeSet::new();
        each(&self.procedural, &mut |statement| {
            if let Statement::Assign { target, .. } = statement {
                targets.insert(*target);
            }
        });
        targets
    }

    fn check_trigger(&self, path: &str, scope: &Scope) -> Result<(), EmitError> {
        let Some(target) = self.procedural_targets().first().copied() else {
            return Ok(());
        };
        let mut triggers = false;
        each(&self.procedural, &mut |statement| {
            triggers |= statement
                .own_reads()
                .any(|(id, _)| !matches!(scope.net(*id).role, Role::Constant(_)));
        });
        let signal = scope.net(target).raw.replace('$', ".");
        if triggers {
            Ok(())
        } else {
            Err(EmitError::new(path, &signal, EmitCause::ConstantCondition))
        }
    }
}

/// Length in characters of the longest expression that is written where it is used: in the connection of a sub-block's
/// port, and after `<=`.
const SHORT: (usize, usize) = (40, 80);

/// Whether the driver of this net is written where the net is used.
fn is_direct(value: &Expression, net: &Net) -> bool {
    let is_short = match net.role {
        // Yosys loses the sign of a signed expression in a connection.
        Role::PinIn => !net.ty.signed && !value.text.contains('$') && value.text.len() <= SHORT.0,
        Role::Next => value.text.len() <= SHORT.1,
        _ => false,
    };
    net.role.is_input_below() && (value.plain.is_some() || is_short)
}

/// Bits of each net that nothing reads, as contiguous ranges `(low, width)`.
///
/// # Errors
/// [`EmitCause::NeverRead`] for a Local or a register without a bit that is read.
pub(super) fn unread(
    bits_read: &BTreeMap<NetId, u64>,
    path: &str,
    scope: &Scope,
) -> Result<Vec<(NetId, u32, u32)>, EmitError> {
    let mut ranges = Vec::new();
    for (id, net) in scope.iter() {
        if !matches!(net.role, Role::Input | Role::Local | Role::Register | Role::PinOut) {
            continue;
        }
        let read = bits_read.get(&id).copied().unwrap_or(0) & net.ty.mask();
        if read == 0 && matches!(net.role, Role::Local | Role::Register) {
            return Err(EmitError::new(path, &net.raw.replace('$', "."), EmitCause::NeverRead));
        }
        let is_unread = |bit: u32| bit < net.ty.width && read & mask(bit, 1) == 0;
        let mut bit = 0;
        while bit < net.ty.width {
            let low = bit;
            while is_unread(bit) {
                bit += 1;
            }
            if bit > low {
                ranges.push((id, low, bit - low));
            }
            bit += 1;
        }
    }
    Ok(ranges)
}

/// Removes each assignment that a later, unconditional one of the same block overrides. The flow check has made sure
/// that nothing reads in between.
fn drop_overridden(block: Vec<Statement>) -> Vec<Statement> {
    let mut later = BTreeSet::new();
    let mut kept = Vec::new();
    for statement in block.into_iter().rev() {
        kept.push(match statement {
            Statement::Assign { target, .. } if !later.insert(target) => continue,
            Statement::If { test, then, otherwise } => Statement::If {
                test,
                then: drop_overridden(then),
                otherwise: drop_overridden(otherwise),
            },
            Statement::Case { subject, mut arms } => {
                for arm in &mut arms {
                    arm.block = drop_overridden(std::mem::take(&mut arm.block));
                }
                Statement::Case { subject, arms }
            }
            other => other,
        });
    }
    kept.reverse();
    kept
}
