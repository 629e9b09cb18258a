//! Converts expressions: RustHDL's untyped tree becomes Verilog text whose width and sign are those of the Rust
//! types.
//!
//! Every value has its [`Type`]. Operands of an operator have equal types, as in Rust, so no operand is extended by
//! its context, and no carry survives that Rust drops. A change of width is written explicitly, and is possible only
//! for a net, a part of a net or a constant; a larger expression needs a Local for it (kernel rule 3).
//!
//! Two constructs of the tree do not state their width: a literal and `signed_bit_cast`. They take it from the other
//! operand or the target; without one they are refused.

use super::collect::literal_value;
use super::error::EmitCause;
use super::ir::Expression;
use super::names;
use super::paths::{self, Loops};
use super::scope::{Role, Scope};
use super::types::{BIT, Type};
use super::values::{Value, Values};
use rust_hdl_core::ast::{VerilogExpression as Tree, VerilogLiteral, VerilogOp, VerilogOpUnary};

/// Writes `tree` as an expression of type `ty`.
pub(super) fn expression(tree: &Tree, ty: Type, scope: &Scope, loops: &Loops) -> Result<Expression, EmitCause> {
    let mut writer = Writer::new(scope, loops);
    let value = writer.value(tree, Some(ty))?;
    writer.values.expect(&value, ty)?;
    Ok(writer.values.finish(&value))
}

/// Writes `tree`, whose type nothing else determines, and returns its type.
pub(super) fn free_expression(tree: &Tree, scope: &Scope, loops: &Loops) -> Result<(Expression, Type), EmitCause> {
    let mut writer = Writer::new(scope, loops);
    let value = writer.value(tree, None)?;
    Ok((writer.values.finish(&value), value.ty()))
}

struct Writer<'a> {
    values: Values<'a>,
    loops: &'a Loops,
}

impl<'a> Writer<'a> {
    fn new(scope: &'a Scope, loops: &'a Loops) -> Self {
        let values = Values::new(scope);
        Self { values, loops }
    }

    /// `want` is the type that the context needs, if it determines one.
    fn value(&mut self, tree: &Tree, want: Option<Type>) -> Result<Value, EmitCause> {
        if let Some(value) = self.number(tree) {
            let ty = want.ok_or(EmitCause::WidthUnknown("a literal"))?;
            let pattern = EmitCause::pattern(ty, value)?;
            return Ok(Value::Literal { pattern, ty });
        }
        match tree {
            Tree::Paren(inner) => self.value(inner, want),
            Tree::Signal(name) => self.signal(name),
            Tree::Literal(literal) => literal_bit(literal),
            Tree::Cast(inner, bits) => self.cast(inner, *bits),
            Tree::Signed(inner) => self.signed(inner, want),
            Tree::Unsigned(inner) => self.unsigned(inner, want),
            Tree::Unary(op, inner) => self.unary(op, inner, want),
            Tree::Binary(a, op, b) => match op {
                VerilogOp::Shl | VerilogOp::Shr => self.shift(a, op, b, want),
                VerilogOp::Mul => self.product(a, b, want),
                _ => self.binary(a, op, b, want),
            },
            Tree::Index(inner, index) => self.bit(inner, index),
            Tree::Slice(inner, width, offset) => self.slice(inner, *width, offset),
            Tree::IndexReplace(inner, index, bit) => self.replace_bit(inner, index, bit),
        }
    }

    fn signal(&mut self, name: &str) -> Result<Value, EmitCause> {
        let raw = paths::resolve(name, self.loops)?;
        let found = self.values.scope.find(&raw);
        let id = found.ok_or_else(|| EmitCause::UnknownSignal(name.to_owned()))?;
        let net = self.values.scope.net(id);
        match net.role {
            Role::RegisterClock | Role::RegisterReset => Err(EmitCause::ReadsSubmoduleInput(net.raw.replace('$', "."))),
            Role::Constant(pattern) if names::says_its_value(&net.name, pattern) => {
                Ok(Value::Literal { pattern, ty: net.ty })
            }
            role if role.is_input_below() => Err(EmitCause::ReadsSubmoduleInput(net.raw.replace('$', "."))),
            _ => Ok(Value::Part {
                net: id,
                low: 0,
                ty: net.ty,
            }),
        }
    }

    // Numbers without a width of their own.

    /// The value of an integer expression of literals and loop variables, by Rust's arithmetic.
    fn number(&self, tree: &Tree) -> Option<i128> {
        match tree {
            Tree::Paren(inner) => self.number(inner),
            Tree::Literal(literal) => {
                let (width, value) = literal_value(literal)?;
                (width != 1).then_some(value)
            }
            Tree::Signal(name) => paths::loop_value(name, self.loops),
            Tree::Unary(VerilogOpUnary::Neg, inner) => self.number(inner)?.checked_neg(),
            Tree::Binary(a, op, b) => {
                let (a, b) = (self.number(a)?, self.number(b)?);
                match op {
                    VerilogOp::Add => a.checked_add(b),
                    VerilogOp::Sub => a.checked_sub(b),
                    VerilogOp::Mul => a.checked_mul(b),
                    _ => None,
                }
            }
            _ => None,
        }
    }

    /// The value of an index that is a number or an unsigned constant. Arithmetic on constants is excluded, because
    /// the tree does not show whether it wraps at the constant's width.
    fn constant_index(&self, tree: &Tree) -> Option<i128> {
        match tree {
            _ if self.number(tree).is_some() => self.number(tree),
            Tree::Paren(inner) => self.constant_index(inner),
            Tree::Signal(name) => {
                let scope = self.values.scope;
                let net = scope.net(scope.find(&paths::resolve(name, self.loops).ok()?)?);
                match net.role {
                    Role::Constant(pattern) if !net.ty.signed => Some(pattern.into()),
                    _ => None,
                }
            }
            _ => None,
        }
    }

    /// Whether its width is determined by the context.
    fn takes_width(&self, tree: &Tree) -> bool {
        match tree {
            _ if self.number(tree).is_some() => true,
            Tree::Signed(_) => true,
            Tree::Paren(inner) | Tree::Unary(VerilogOpUnary::Not | VerilogOpUnary::Neg, inner) => {
                self.takes_width(inner)
            }
            Tree::Binary(a, op, b) => {
                let keeps_type = !compares(op) && !matches!(op, VerilogOp::Shl | VerilogOp::Shr | VerilogOp::Mul);
                keeps_type && self.takes_width(a) && self.takes_width(b)
            }
            _ => false,
        }
    }

    // Casts.

    /// Casts `bit_cast::<M, N>(x)` and `bits::<M>(5)`.
    fn cast(&mut self, inner: &Tree, bits: usize) -> Result<Value, EmitCause> {
        let width = u32::try_from(bits).ok().filter(|width| (1..=64).contains(width));
        let ty = Type::bits(width.ok_or(EmitCause::Width(bits))?);
        if self.takes_width(inner) {
            return self.value(inner, Some(ty));
        }
        let value = self.value(inner, None)?;
        self.values.expect(&value, Type::bits(value.ty().width))?;
        self.values.resize(value, ty)
    }

    /// Casts `signed_cast(bits)` with the same width, or `signed_bit_cast::<M, N>(signed)`; the tree has no M.
    fn signed(&mut self, inner: &Tree, want: Option<Type>) -> Result<Value, EmitCause> {
        let value = self.value(inner, None)?;
        let from = value.ty();
        if !from.signed {
            return Ok(self.values.reinterpret(value, Type { signed: true, ..from }));
        }
        let width = want.ok_or(EmitCause::WidthUnknown("`signed_bit_cast`"))?.width;
        self.values.resize(value, Type { width, signed: true })
    }

    /// Cast `unsigned_cast(signed)` with the same width. Its operand is computed at its own width, so a product is
    /// refused.
    fn unsigned(&mut self, inner: &Tree, want: Option<Type>) -> Result<Value, EmitCause> {
        let want = want.filter(|_| self.takes_width(inner));
        let value = self.value(inner, want.map(|ty| Type { signed: true, ..ty }))?;
        let ty = Type::bits(value.ty().width);
        Ok(self.values.reinterpret(value, ty))
    }

    // Bits and slices.

    fn bit(&mut self, inner: &Tree, index: &Tree) -> Result<Value, EmitCause> {
        let value = self.value(inner, None)?;
        if let Some(index) = self.constant_index(index) {
            let low = self.values.check_range(&value, index, 1)?;
            return self.values.part(value, low, BIT);
        }
        let (index, index_bits) = self.index(index)?;
        let width = value.ty().width;
        if 1u64.checked_shl(index_bits) != Some(width.into()) {
            return Err(EmitCause::IndexRange { index_bits, width });
        }
        self.values.bit(&value, &index)
    }

    fn slice(&mut self, inner: &Tree, width: usize, offset: &Tree) -> Result<Value, EmitCause> {
        let value = self.value(inner, None)?;
        let Some(low) = self.constant_index(offset) else {
            self.index(offset)?;
            let found = "a slice at an offset that is a signal".to_owned();
            let remedy = "shift by the signal into a Local, then slice that at 0";
            return Err(EmitCause::Unsupported { found, remedy });
        };
        let low = self.values.check_range(&value, low, width)?;
        let signed = value.ty().signed;
        self.values.part(
            value,
            low,
            Type {
                width: width as u32,
                signed,
            },
        )
    }

    fn replace_bit(&mut self, inner: &Tree, index: &Tree, bit: &Tree) -> Result<Value, EmitCause> {
        let value = self.value(inner, None)?;
        let (ty, bit) = (value.ty(), self.value(bit, Some(BIT))?);
        self.values.expect(&bit, BIT)?;
        let Some(index) = self.constant_index(index) else {
            self.index(index)?;
            let found = "`replace_bit` at an index that is a signal".to_owned();
            return Err(EmitCause::Unsupported {
                found,
                remedy: "compare with each index in a loop",
            });
        };
        let low = self.values.check_range(&value, index, 1)?;
        let mut pieces = Vec::new();
        if low + 1 < ty.width {
            let above = Type::bits(ty.width - low - 1);
            pieces.push(self.values.part(value.clone(), low + 1, above)?);
        }
        pieces.push(bit);
        if low > 0 {
            pieces.push(self.values.part(value, 0, Type::bits(low))?);
        }
        let pieces: Vec<_> = pieces.iter().map(|piece| self.values.text(piece)).collect();
        let whole = Value::closed(format!("{{{}}}", pieces.join(", ")), Type::bits(ty.width));
        Ok(if ty.signed {
            self.values.reinterpret(whole, ty)
        } else {
            whole
        })
    }

    /// An index or shift amount that is a signal: its text as an operand, and its width.
    fn index(&mut self, tree: &Tree) -> Result<(String, u32), EmitCause> {
        let value = self.value(tree, None)?;
        let width = value.ty().width;
        self.values.expect(&value, Type::bits(width))?;
        Ok((self.values.operand(&value), width))
    }

    // Operators.

    fn unary(&mut self, op: &VerilogOpUnary, inner: &Tree, want: Option<Type>) -> Result<Value, EmitCause> {
        let keeps_type = matches!(op, VerilogOpUnary::Not | VerilogOpUnary::Neg);
        let value = self.value(inner, want.filter(|_| keeps_type))?;
        let ty = value.ty();
        let operand = self.values.operand(&value);
        Ok(match op {
            VerilogOpUnary::Not if ty == BIT => Value::closed(format!("!{operand}"), BIT),
            VerilogOpUnary::Not => Value::closed(format!("~{operand}"), ty),
            VerilogOpUnary::Neg => Value::open(format!("-{operand}"), "-", ty),
            VerilogOpUnary::All => Value::closed(format!("(&{operand})"), BIT),
            VerilogOpUnary::Any => Value::closed(format!("(|{operand})"), BIT),
            VerilogOpUnary::Xor => Value::closed(format!("(^{operand})"), BIT),
        })
    }

    fn binary(&mut self, a: &Tree, op: &VerilogOp, b: &Tree, want: Option<Type>) -> Result<Value, EmitCause> {
        let context = want.filter(|_| !compares(op));
        let (left, right) = if self.takes_width(a) && !self.takes_width(b) {
            let right = self.value(b, context)?;
            (self.value(a, Some(right.ty()))?, right)
        } else {
            let left = self.value(a, context)?;
            let ty = left.ty();
            (left, self.value(b, Some(ty))?)
        };
        self.values.expect(&right, left.ty())?;
        let ty = if compares(op) { BIT } else { left.ty() };
        Ok(self.operator(&left, op, &right, ty))
    }

    /// Verilog computes a product at the width of its target, which must therefore be that of the full product; the
    /// operands must be nets, which are extended to that width by their own sign.
    fn product(&mut self, a: &Tree, b: &Tree, want: Option<Type>) -> Result<Value, EmitCause> {
        let (left, right) = (self.value(a, None)?, self.value(b, None)?);
        for operand in [&left, &right] {
            if matches!(operand, Value::Text { .. }) {
                return Err(self.values.needs_local(operand));
            }
        }
        let from = left.ty();
        self.values.expect(&right, from)?;
        let ty = Type {
            width: 2 * from.width,
            ..from
        };
        let value = self.operator(&left, &VerilogOp::Mul, &right, ty);
        if want == Some(ty) {
            Ok(value)
        } else {
            Err(self.values.needs_local(&value))
        }
    }

    fn shift(&mut self, a: &Tree, op: &VerilogOp, b: &Tree, want: Option<Type>) -> Result<Value, EmitCause> {
        let value = self.value(a, want)?;
        let ty = value.ty();
        if ty.signed || self.takes_width(a) {
            let found = "a shift of a signed value or of a literal".to_owned();
            return Err(EmitCause::Unsupported {
                found,
                remedy: "slice a Local, or use a `Constant`",
            });
        }
        let amount = match self.constant_index(b) {
            Some(amount) => self.values.check_range(&value, amount, 1)?.to_string(),
            None => self.index(b)?.0,
        };
        let operand = self.values.operand(&value);
        let symbol = symbol(op);
        Ok(Value::open(format!("{operand} {symbol} {amount}"), symbol, ty))
    }

    fn operator(&mut self, left: &Value, op: &VerilogOp, right: &Value, ty: Type) -> Value {
        let symbol = symbol(op);
        let (left, right) = (self.values.link(left, symbol), self.values.link(right, symbol));
        Value::open(format!("{left} {symbol} {right}"), symbol, ty)
    }
}

fn compares(op: &VerilogOp) -> bool {
    use VerilogOp::{Eq, Ge, Gt, Le, Lt, Ne};
    matches!(op, Eq | Lt | Le | Ne | Ge | Gt)
}

fn symbol(op: &VerilogOp) -> &'static str {
    match op {
        VerilogOp::Add => "+",
        VerilogOp::Sub => "-",
        VerilogOp::Mul => "*",
        VerilogOp::LogicalAnd => "&&",
        VerilogOp::LogicalOr => "||",
        VerilogOp::BitXor => "^",
        VerilogOp::BitAnd => "&",
        VerilogOp::BitOr => "|",
        VerilogOp::Shl => "<<",
        VerilogOp::Shr => ">>",
        VerilogOp::Eq => "==",
        VerilogOp::Lt => "<",
        VerilogOp::Le => "<=",
        VerilogOp::Ne => "!=",
        VerilogOp::Ge => ">=",
        VerilogOp::Gt => ">",
    }
}

/// The literal `true` or `false`, which has one bit in RustHDL's tree; an integer literal has the width of a Rust
/// integer there, which is meaningless.
fn literal_bit(literal: &VerilogLiteral) -> Result<Value, EmitCause> {
    let (_, value) = literal_value(literal).ok_or(EmitCause::WidthUnknown("a literal"))?;
    let pattern = EmitCause::pattern(BIT, value)?;
    Ok(Value::Literal { pattern, ty: BIT })
}
