//! Typed values before they become text. Widths and signs change only here.
//!
//! A part of a net stays a part of a net until it is written, so that a slice of a slice of a cast needs no
//! temporary. Text can no longer change its width, because Verilog has no part select of an expression.

use super::error::EmitCause;
use super::ir::{Expression, Reads};
use super::scope::{NetId, Role, Scope};
use super::types::{BIT, Type, mask};

/// A typed value.
#[derive(Debug, Clone)]
pub(super) enum Value {
    /// Bits of a net from `low` on, with the type `ty`.
    Part { net: NetId, low: u32, ty: Type },
    /// A bit pattern.
    Literal { pattern: u64, ty: Type },
    /// Text, and its operator outside all parentheses, if it has one.
    Text {
        text: String,
        ty: Type,
        operator: Option<&'static str>,
    },
}

impl Value {
    /// Makes text that has this operator outside all parentheses.
    pub(super) fn open(text: String, operator: &'static str, ty: Type) -> Self {
        let operator = Some(operator);
        Self::Text { text, ty, operator }
    }

    /// Makes text that can be an operand as it is.
    pub(super) fn closed(text: String, ty: Type) -> Self {
        let operator = None;
        Self::Text { text, ty, operator }
    }

    pub(super) fn ty(&self) -> Type {
        match self {
            Self::Part { ty, .. } | Self::Literal { ty, .. } | Self::Text { ty, .. } => *ty,
        }
    }
}

/// Converts values to text, and records what they read.
pub(super) struct Values<'a> {
    pub(super) scope: &'a Scope,
    reads: Reads,
}

impl<'a> Values<'a> {
    pub(super) fn new(scope: &'a Scope) -> Self {
        let reads = Reads::new();
        Self { scope, reads }
    }

    pub(super) fn finish(mut self, value: &Value) -> Expression {
        let plain = match value {
            Value::Part { net, low: 0, ty } if self.scope.net(*net).ty == *ty => Some(*net),
            _ => None,
        };
        let text = self.text(value);
        let reads = self.reads;
        Expression { text, reads, plain }
    }

    // Changes of width and sign.

    /// The same bits with the other sign.
    pub(super) fn reinterpret(&self, value: Value, ty: Type) -> Value {
        match value {
            Value::Part { net, low, .. } => Value::Part { net, low, ty },
            Value::Literal { pattern, .. } => Value::Literal { pattern, ty },
            Value::Text { text, .. } if ty.signed => Value::closed(format!("$signed({text})"), ty),
            Value::Text { text, .. } => Value::closed(format!("$unsigned({text})"), ty),
        }
    }

    /// Truncates a value, or extends it by the sign of its type.
    pub(super) fn resize(&mut self, value: Value, ty: Type) -> Result<Value, EmitCause> {
        let from = value.ty();
        if ty.width == from.width {
            return Ok(value);
        }
        if ty.width < from.width {
            return self.part(value, 0, ty);
        }
        let extra = ty.width - from.width;
        if let Some(pattern) = self.constant(&value) {
            let negative = from.signed && pattern >> (from.width - 1) & 1 == 1;
            let extension = if negative { mask(from.width, extra) } else { 0 };
            let pattern = pattern | extension;
            return Ok(Value::Literal { pattern, ty });
        }
        let Value::Part { net, low, .. } = value else {
            return Err(self.needs_local(&value));
        };
        let bits = self.select(net, low, from.width);
        let text = if from.signed {
            let sign = self.select(net, low + from.width - 1, 1);
            format!("$signed({{{{{extra}{{{sign}}}}}, {bits}}})")
        } else {
            format!("{{{extra}'d0, {bits}}}")
        };
        Ok(Value::closed(text, ty))
    }

    /// Bits of `value` from `low` on, with the type `ty`; they must exist.
    pub(super) fn part(&mut self, value: Value, low: u32, ty: Type) -> Result<Value, EmitCause> {
        if let Some(pattern) = self.constant(&value) {
            let pattern = pattern >> low & ty.mask();
            return Ok(Value::Literal { pattern, ty });
        }
        match value {
            Value::Part { net, low: base, .. } => {
                let low = base + low;
                Ok(Value::Part { net, low, ty })
            }
            _ => Err(self.needs_local(&value)),
        }
    }

    /// The bit of `value` that the signal `index` selects. Verilog-2001 can select only from nets, not from
    /// constants.
    pub(super) fn bit(&mut self, value: &Value, index: &str) -> Result<Value, EmitCause> {
        match *value {
            Value::Part { net, low: 0, ty } if ty.width == self.scope.net(net).ty.width && !self.is_constant(net) => {
                let name = self.select(net, 0, ty.width);
                Ok(Value::closed(format!("{name}[{index}]"), BIT))
            }
            _ => Err(self.needs_local(value)),
        }
    }

    /// Checks that `width` bits from `low` on exist in `value`.
    pub(super) fn check_range(&mut self, value: &Value, low: i128, width: usize) -> Result<u32, EmitCause> {
        let available = value.ty().width;
        let high = low.saturating_add(width as i128) - 1;
        if low < 0 || width == 0 || high >= i128::from(available) {
            let found = self.text(value);
            return Err(EmitCause::OutOfRange {
                found,
                low,
                high,
                width: available,
            });
        }
        Ok(low as u32)
    }

    fn is_constant(&self, id: NetId) -> bool {
        matches!(self.scope.net(id).role, Role::Constant(_))
    }

    /// The pattern of a literal or of (a part of) a constant.
    fn constant(&self, value: &Value) -> Option<u64> {
        match value {
            Value::Literal { pattern, .. } => Some(*pattern),
            Value::Part { net, low, ty } => match self.scope.net(*net).role {
                Role::Constant(pattern) => Some(pattern >> low & ty.mask()),
                _ => None,
            },
            Value::Text { .. } => None,
        }
    }

    // Text.

    /// Text of `value`; its bits count as read.
    pub(super) fn text(&mut self, value: &Value) -> String {
        match value {
            Value::Text { text, .. } => text.clone(),
            Value::Literal { pattern, ty } => ty.literal(*pattern),
            Value::Part { net: id, low, ty } => {
                let net = self.scope.net(*id);
                if let (Role::Constant(pattern), true) = (net.role, *ty != net.ty) {
                    return ty.literal(pattern >> low & ty.mask());
                }
                let bits = self.select(*id, *low, ty.width);
                // A part select is unsigned, even of a signed net.
                match (ty.signed, ty.width == net.ty.width && net.ty.signed) {
                    (true, false) => format!("$signed({bits})"),
                    (false, true) => format!("$unsigned({bits})"),
                    _ => bits,
                }
            }
        }
    }

    /// Text of `value`, in parentheses where a neighbouring operator could bind into it.
    pub(super) fn operand(&mut self, value: &Value) -> String {
        let text = self.text(value);
        match value {
            Value::Text { operator: Some(_), .. } => format!("({text})"),
            Value::Literal { .. } if text.starts_with('-') => format!("({text})"),
            _ => text,
        }
    }

    /// Text of `value` as an operand of the operator `of`: a chain of the same bitwise or logical operator needs no
    /// parentheses.
    pub(super) fn link(&mut self, value: &Value, of: &str) -> String {
        match value {
            Value::Text { text, operator, .. } if *operator == Some(of) && is_associative(of) => text.clone(),
            _ => self.operand(value),
        }
    }

    /// A net, or bits of it, regardless of sign; they count as read.
    fn select(&mut self, id: NetId, low: u32, width: u32) -> String {
        self.reads.push((id, mask(low, width)));
        self.scope.net(id).select(low, width)
    }

    // Errors that quote the value.

    pub(super) fn expect(&mut self, value: &Value, expected: Type) -> Result<(), EmitCause> {
        if value.ty() == expected {
            return Ok(());
        }
        let found = self.text(value);
        Err(EmitCause::TypeMismatch {
            found,
            found_type: value.ty(),
            expected,
        })
    }

    pub(super) fn needs_local(&mut self, value: &Value) -> EmitCause {
        EmitCause::NeedsLocal(self.text(value))
    }
}

fn is_associative(operator: &str) -> bool {
    matches!(operator, "&" | "|" | "^" | "&&" | "||")
}
