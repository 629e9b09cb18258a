//! Converts statements: a kernel's tree becomes the typed form of [`ir`](super::ir), with loops unrolled, and the
//! wiring of registers checked and removed.

use super::collect::{Connection, Node, literal_value};
use super::error::{EmitCause, EmitError};
use super::expressions::{expression, free_expression};
use super::ir::{Arm, Expression, Statement};
use super::paths;
use super::scope::{NetId, Role, Scope};
use super::types::{BIT, Type};
use rust_hdl_core::ast::{
    VerilogBlockOrConditional, VerilogConditional, VerilogExpression as Tree, VerilogLoop, VerilogMatch,
    VerilogStatement,
};
use std::collections::{BTreeMap, BTreeSet};

/// Largest number of turns of a loop that is unrolled.
const MAXIMUM_TURNS: i128 = 1024;

/// The typed kernel of the block at `path`.
pub(super) fn statements(kernel: &[VerilogStatement], node: &Node, scope: &Scope) -> Result<Vec<Statement>, EmitError> {
    let mut reader = Reader {
        path: &node.path,
        scope,
        loops: Vec::new(),
        clocked: BTreeSet::new(),
    };
    let mut block = reader.kept_registers()?;
    block.extend(reader.block(kernel)?);
    block.extend(reader.connections(&node.connections)?);
    for register in &scope.registers {
        if !reader.clocked.contains(&register.clock) {
            let cause = EmitCause::RegisterWiring {
                port: "clock",
                expected: "clk",
            };
            return Err(reader.error(&scope.net(register.now).name, cause));
        }
    }
    Ok(block)
}

/// The text of a `comment!`, however the compiler printed its tokens; `None` for other macros that become comments.
pub(super) fn comment_text(raw: &str) -> Option<String> {
    let is_other = ["assert", "println"]
        .iter()
        .any(|name| raw.trim_start().starts_with(name));
    if is_other {
        return None;
    }
    // RustHDL removes `comment ! ("` and `")` only where the compiler has printed the tokens exactly like that.
    let text = raw.split_once('"').map_or(raw, |(_, rest)| rest).trim_end();
    let closed = text
        .strip_suffix(')')
        .map(|text| text.trim_end().trim_end_matches(',').trim_end());
    let text = closed.and_then(|text| text.strip_suffix('"')).unwrap_or(text);
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    (!text.is_empty()).then_some(text)
}

struct Reader<'a> {
    path: &'a str,
    scope: &'a Scope,
    loops: Vec<(String, i128)>,
    /// Clock inputs of the registers that the kernel wires.
    clocked: BTreeSet<NetId>,
}

impl Reader<'_> {
    fn error(&self, signal: &str, cause: EmitCause) -> EmitError {
        EmitError::new(self.path, &signal.replace('$', "."), cause)
    }

    fn block(&mut self, statements: &[VerilogStatement]) -> Result<Vec<Statement>, EmitError> {
        let mut block = Vec::new();
        for statement in statements {
            self.statement(statement, &mut block)?;
        }
        Ok(block)
    }

    /// Registers that keep their value unless the kernel assigns another.
    fn kept_registers(&mut self) -> Result<Vec<Statement>, EmitError> {
        let mut block = Vec::new();
        for register in self.scope.registers.iter().filter(|register| register.tag.is_kept) {
            self.clocked.insert(register.clock);
            let (now, target) = (self.scope.net(register.now), register.next);
            let value = expression(&Tree::Signal(now.raw.clone()), now.ty, self.scope, &[])
                .map_err(|cause| self.error(&now.raw, cause))?;
            block.push(Statement::Assign { target, value });
        }
        Ok(block)
    }

    /// What `kernel!` connects, behind everything that the sources depend on. The outputs come first, because a comment
    /// at the end of the kernel is about them.
    fn connections(&mut self, connections: &[Connection]) -> Result<Vec<Statement>, EmitError> {
        let mut block = Vec::new();
        for connection in connections {
            if let Connection::Output { port, source } = connection {
                block.extend(self.assignment(&Tree::Signal(port.clone()), &Tree::Signal(source.clone()))?);
            }
        }
        for connection in connections {
            let joined = match connection {
                Connection::Output { .. } => Vec::new(),
                Connection::Input { port, source } => vec![(port.clone(), source.clone())],
                Connection::Clocking { part } => clocking(part, self.scope),
            };
            for (port, source) in joined {
                block.extend(self.assignment(&Tree::Signal(port), &Tree::Signal(source))?);
            }
        }
        Ok(block)
    }

    fn statement(&mut self, statement: &VerilogStatement, block: &mut Vec<Statement>) -> Result<(), EmitError> {
        match statement {
            VerilogStatement::Assignment(target, value) => block.extend(self.assignment(target, value)?),
            VerilogStatement::If(conditional) => block.push(self.conditional(conditional)?),
            VerilogStatement::Match(arms) => block.push(self.case(arms)?),
            VerilogStatement::Loop(turns) => self.unroll(turns, block)?,
            VerilogStatement::Macro(inner) => block.extend(self.block(inner)?),
            VerilogStatement::Comment(raw) => {
                // Tags such as `@module` are meant for the emitter.
                let text = comment_text(raw).filter(|text| !text.starts_with('@'));
                block.extend(text.map(Statement::Comment));
            }
            VerilogStatement::SliceAssignment { base, .. } => {
                return Err(self.unsupported(base, "an assignment to a part of a signal", "assign the whole signal"));
            }
            VerilogStatement::Link(_) => {
                let none = Tree::Signal(String::new());
                return Err(self.unsupported(&none, "an interface `join` or `link`", "wire each signal"));
            }
        }
        Ok(())
    }

    fn unsupported(&self, signal: &Tree, found: &str, remedy: &'static str) -> EmitError {
        let name = if let Tree::Signal(name) = signal { name } else { "" };
        self.error(
            name,
            EmitCause::Unsupported {
                found: found.to_owned(),
                remedy,
            },
        )
    }

    fn assignment(&mut self, target: &Tree, value: &Tree) -> Result<Option<Statement>, EmitError> {
        let Tree::Signal(text) = target else {
            return Err(self.unsupported(target, "an assignment to an expression", "assign to a signal's `next`"));
        };
        let raw = paths::resolve(text, &self.loops).map_err(|cause| self.error(text, cause))?;
        let unknown = || self.error(&raw, EmitCause::UnknownSignal(text.clone()));
        let target = self.scope.find(&raw).ok_or_else(unknown)?;
        let net = self.scope.net(target);
        match net.role {
            Role::RegisterClock => {
                self.wire_register(&raw, value, "clock", "clk")?;
                self.clocked.insert(target);
                Ok(None)
            }
            Role::RegisterReset => self.wire_register(&raw, value, "rst", "rst").map(|()| None),
            Role::ClockPin if !is_signal(value, "clk") => Err(self.error(&raw, EmitCause::ClockWiring)),
            role if role.is_driven() => {
                let value =
                    expression(value, net.ty, self.scope, &self.loops).map_err(|cause| self.error(&raw, cause))?;
                Ok(Some(Statement::Assign { target, value }))
            }
            role => Err(self.error(&raw, EmitCause::NotDrivable(role.describe()))),
        }
    }

    /// Checks that a register's `clock` or `rst` is assigned from the block's own, the only allowed source.
    fn wire_register(
        &self,
        raw: &str,
        value: &Tree,
        port: &'static str,
        expected: &'static str,
    ) -> Result<(), EmitError> {
        if is_signal(value, expected) {
            return Ok(());
        }
        Err(self.error(raw, EmitCause::RegisterWiring { port, expected }))
    }

    fn conditional(&mut self, conditional: &VerilogConditional) -> Result<Statement, EmitError> {
        let test = self.test(&conditional.test)?;
        let then = self.block(&conditional.then)?;
        let otherwise = match &conditional.otherwise {
            VerilogBlockOrConditional::None => Vec::new(),
            VerilogBlockOrConditional::Block(block) => self.block(block)?,
            VerilogBlockOrConditional::Conditional(inner) => self.block(std::slice::from_ref(&**inner))?,
        };
        Ok(Statement::If { test, then, otherwise })
    }

    fn test(&self, tree: &Tree) -> Result<Expression, EmitError> {
        expression(tree, BIT, self.scope, &self.loops).map_err(|cause| self.error("", cause))
    }

    fn case(&mut self, tree: &VerilogMatch) -> Result<Statement, EmitError> {
        let located = free_expression(&tree.test, self.scope, &self.loops);
        let (subject, ty) = located.map_err(|cause| self.error("", cause))?;
        let mut labels = BTreeMap::new();
        let mut arms = Vec::new();
        for case in &tree.cases {
            if case.condition == "default" {
                arms.push(Arm {
                    label: None,
                    block: self.block(&case.block)?,
                });
                return Ok(Statement::Case { subject, arms });
            }
            let label = self.label(&case.condition, ty)?;
            labels.insert(label.text.clone(), ());
            arms.push(Arm {
                label: Some(label),
                block: self.block(&case.block)?,
            });
        }
        let values = match tree.cases.first().and_then(|case| case.condition.split_once('$')) {
            Some((type_name, _)) => self.scope.enum_sizes.get(type_name).copied(),
            None => (ty == BIT).then_some(2),
        };
        if Some(labels.len()) != values {
            return Err(self.error("", EmitCause::MatchNotExhaustive(subject.text)));
        }
        // Rust knows that there are no further values; Verilog does not, and would keep the old value for them.
        if let Some(last) = arms.last_mut() {
            last.label = None;
        }
        Ok(Statement::Case { subject, arms })
    }

    fn label(&self, condition: &str, ty: Type) -> Result<Expression, EmitError> {
        let tree = match condition {
            "true" => Tree::Literal(true.into()),
            "false" => Tree::Literal(false.into()),
            _ => Tree::Signal(condition.to_owned()),
        };
        expression(&tree, ty, self.scope, &self.loops).map_err(|cause| self.error("", cause))
    }

    fn unroll(&mut self, turns: &VerilogLoop, block: &mut Vec<Statement>) -> Result<(), EmitError> {
        if self.scope.find(&turns.index).is_some() {
            return Err(self.error(&turns.index, EmitCause::LoopVariable(turns.index.clone())));
        }
        let bound = |literal| literal_value(literal).map_or(i128::MAX, |(_, value)| value);
        let (from, to) = (bound(&turns.from), bound(&turns.to));
        if to.saturating_sub(from) > MAXIMUM_TURNS {
            return Err(self.error("", EmitCause::Loop { from, to }));
        }
        for value in from..to {
            self.loops.push((turns.index.clone(), value));
            block.extend(self.block(&turns.block)?);
            self.loops.pop();
        }
        Ok(())
    }
}

/// The clock and reset inputs of a part, or of an array of parts, with their sources.
fn clocking(part: &str, scope: &Scope) -> Vec<(String, String)> {
    let inputs = scope.iter().filter(|(_, net)| net.role.is_input_below());
    let found = inputs.filter_map(|(_, net)| {
        let (owner, port) = net.raw.rsplit_once('$')?;
        let index = owner.strip_prefix(part)?;
        let is_part = index.is_empty() || index.strip_prefix('$')?.parse::<usize>().is_ok();
        (is_part && matches!(port, "clk" | "rst")).then(|| (net.raw.clone(), port.to_owned()))
    });
    found.collect()
}

fn is_signal(tree: &Tree, name: &str) -> bool {
    matches!(tree, Tree::Signal(found) if found == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_lose_their_macro() {
        assert_eq!(comment_text("comment! (\"tap table").as_deref(), Some("tap table"));
        assert_eq!(comment_text("comment!(\"a\n   b\")").as_deref(), Some("a b"));
        assert_eq!(comment_text("@module mac").as_deref(), Some("@module mac"));
        assert_eq!(comment_text("comment! (\"a; b (c);").as_deref(), Some("a; b (c);"));
        assert_eq!(comment_text("comment!\n(\"a (b);\",\n)").as_deref(), Some("a (b);"));
        assert_eq!(comment_text("assert! (x)"), None);
        assert_eq!(comment_text("comment! (\""), None);
    }
}
