//! A typed kernel: statements whose expressions are Verilog text, with the nets that each reads and drives.

use super::scope::NetId;

/// Bits of nets that an expression reads.
pub(super) type Reads = Vec<(NetId, u64)>;

/// A typed expression as Verilog text.
#[derive(Debug, Clone)]
pub(super) struct Expression {
    pub(super) text: String,
    pub(super) reads: Reads,
    /// The net, if the expression is only that net.
    pub(super) plain: Option<NetId>,
}

/// One statement; loops are unrolled.
#[derive(Debug, Clone)]
pub(super) enum Statement {
    Comment(String),
    Assign {
        target: NetId,
        value: Expression,
    },
    If {
        test: Expression,
        then: Vec<Statement>,
        otherwise: Vec<Statement>,
    },
    Case {
        subject: Expression,
        arms: Vec<Arm>,
    },
}

/// One arm of a case; the last arm has no label and is the default.
#[derive(Debug, Clone)]
pub(super) struct Arm {
    pub(super) label: Option<Expression>,
    pub(super) block: Vec<Statement>,
}

/// Calls `visit` for each statement in `block`, at every depth, in order.
pub(super) fn each<'a>(block: &'a [Statement], visit: &mut dyn FnMut(&'a Statement)) {
    for statement in block {
        visit(statement);
        match statement {
            Statement::If { then, otherwise, .. } => {
                each(then, visit);
                each(otherwise, visit);
            }
            Statement::Case { arms, .. } => arms.iter().for_each(|arm| each(&arm.block, visit)),
            Statement::Comment(_) | Statement::Assign { .. } => {}
        }
    }
}

impl Statement {
    /// Bits that the statement itself reads, without the statements inside it.
    pub(super) fn own_reads(&self) -> impl Iterator<Item = &(NetId, u64)> {
        let (first, labels) = match self {
            Self::Comment(_) => (None, [].as_slice()),
            Self::Assign { value, .. } => (Some(value), [].as_slice()),
            Self::If { test, .. } => (Some(test), [].as_slice()),
            Self::Case { subject, arms } => (Some(subject), arms.as_slice()),
        };
        let labels = labels.iter().filter_map(|arm| arm.label.as_ref());
        first.into_iter().chain(labels).flat_map(|expression| &expression.reads)
    }
}
