//! Checks for places where RustHDL and a Verilog `always @(*)` block could differ because of the order of statements.
//!
//! RustHDL repeats a kernel until nothing changes, so a reader sees the *final* value of what it reads. Verilog runs
//! the block once, so a reader sees the value *so far*. The two agree if, on every path, each signal is assigned
//! before it is read and not assigned after it was read. A signal that is not assigned on every path would be a
//! latch.

use super::error::{EmitCause, EmitError};
use super::ir::{Reads, Statement};
use super::scope::{NetId, Role, Scope};
use std::collections::BTreeSet;

/// Checks the kernel of the block at `path`.
pub(super) fn check(kernel: &[Statement], path: &str, scope: &Scope) -> Result<(), EmitError> {
    let mut state = State::default();
    run(kernel, scope, &mut state).map_err(|(id, cause)| error(path, scope, id, cause))?;
    for (id, net) in scope.iter() {
        if net.role.is_driven() && !state.assigned.contains(&id) {
            let cause = if state.touched.contains(&id) {
                EmitCause::Latch
            } else {
                EmitCause::NeverAssigned
            };
            return Err(error(path, scope, id, cause));
        }
    }
    Ok(())
}

fn error(path: &str, scope: &Scope, id: NetId, cause: EmitCause) -> EmitError {
    EmitError::new(path, &scope.net(id).raw.replace('$', "."), cause)
}

#[derive(Debug, Clone, Default)]
struct State {
    /// Signals assigned on every path so far.
    assigned: BTreeSet<NetId>,
    /// Signals assigned on some path so far.
    touched: BTreeSet<NetId>,
    /// Signals read on some path so far.
    read: BTreeSet<NetId>,
}

impl State {
    /// The state after one of two paths.
    fn either(mut self, other: &Self) -> Self {
        self.assigned.retain(|id| other.assigned.contains(id));
        self.touched.extend(&other.touched);
        self.read.extend(&other.read);
        self
    }
}

type Located<T> = Result<T, (NetId, EmitCause)>;

fn run(block: &[Statement], scope: &Scope, state: &mut State) -> Located<()> {
    for statement in block {
        match statement {
            Statement::Comment(_) => {}
            Statement::Assign { target, value } => {
                read(&value.reads, scope, state)?;
                if state.read.contains(target) {
                    return Err((*target, EmitCause::AssignedAfterRead));
                }
                state.assigned.insert(*target);
                state.touched.insert(*target);
            }
            Statement::If { test, then, otherwise } => {
                read(&test.reads, scope, state)?;
                let mut other = state.clone();
                run(then, scope, state)?;
                run(otherwise, scope, &mut other)?;
                *state = std::mem::take(state).either(&other);
            }
            Statement::Case { subject, arms } => {
                read(&subject.reads, scope, state)?;
                let mut merged: Option<State> = None;
                for arm in arms {
                    let mut path = state.clone();
                    run(&arm.block, scope, &mut path)?;
                    merged = Some(match merged {
                        Some(others) => path.either(&others),
                        None => path,
                    });
                }
                *state = merged.unwrap_or_else(|| std::mem::take(state));
            }
        }
    }
    Ok(())
}

fn read(reads: &Reads, scope: &Scope, state: &mut State) -> Located<()> {
    for (id, _) in reads {
        let net = scope.net(*id);
        if matches!(net.role, Role::Local | Role::Output) {
            if !state.assigned.contains(id) {
                let cause = if state.touched.contains(id) {
                    EmitCause::Latch
                } else {
                    EmitCause::ReadBeforeAssigned(net.raw.replace('$', "."))
                };
                return Err((*id, cause));
            }
            state.read.insert(*id);
        }
    }
    Ok(())
}
