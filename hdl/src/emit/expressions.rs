//! Expressions: RustHDL's untyped tree to Verilog text whose width and sign are those of the Rust types.
//!
//! Every value carries its [`Type`]. Operands of an operator have equal types, as in Rust, so no operand is ever extended by
//! its context and no carry survives that Rust drops. A change of width is written out, and only of a net, a part of a net or
//! a constant; of a larger expression it needs a Local (kernel rule 3).
//!
//! Two constructs of the tree do not say their width: a literal and `signed_bit_cast`. They take it from the other operand
//! or the target; where there is none, they are refused.

use super::collect::literal_value;
use super::error::Cause;
use super::ir::{Expression, Reads};
use super::paths::{self, Loops};
use super::scope::{NetId, Role, Scope};
use super::types::{BIT, Type, mask};
use rust_hdl_core::ast::{VerilogExpression as Tree, VerilogLiteral, VerilogOp, VerilogOpUnary};

/// A typed value, not yet text: parts of nets stay parts of nets, so that slices of slices need no temporary.
#[derive(Debug, Clone)]
enum Value {
    /// Bits `low ..` of a net, seen as `ty`.
    Part {
        net: NetId,
        low: u32,
        ty: Type,
    },
    Literal {
        pattern: u64,
        ty: Type,
    },
    /// Text that needs parentheses as an operand unless `closed`.
    Text {
        text: String,
        ty: Type,
        closed: bool,
    },
}

impl Value {
    fn ty(&self) -> Type {
        match self {
            Self::Part { ty, .. } | Self::Literal { ty, .. } | Self::Text { ty, .. } => *ty,
        }
    }
}

/// Writes `tree` as an expression of type `ty`.
pub(super) fn expression(tree: &Tree, ty: Type, scope: &Scope, loops: &Loops) -> Result<Expression, Cause> {
    let mut writer = Writer {
        scope,
        loops,
        reads: Reads::new(),
    };
    let value = writer.value(tree, Some(ty))?;
    writer.expect(&value, ty)?;
    Ok(writer.finish(value))
}

/// Writes `tree`, whose type nothing else determines, and tells its type.
pub(super) fn free_expression(tree: &Tree, scope: &Scope, loops: &Loops) -> Result<(Expression, Type), Cause> {
    let mut writer = Writer {
        scope,
        loops,
        reads: Reads::new(),
    };
    let value = writer.value(tree, None)?;
    let ty = value.ty();
    Ok((writer.finish(value), ty))
}

struct Writer<'a> {
    scope: &'a Scope,
    loops: &'a Loops,
    reads: Reads,
}

impl Writer<'_> {
    fn finish(mut self, value: Value) -> Expression {
        let plain = match &value {
            Value::Part { net, low: 0, ty } if self.scope.net(*net).ty == *ty => Some(*net),
            _ => None,
        };
        let text = self.text(&value);
        Expression {
            text,
            reads: self.reads,
            plain,
        }
    }

    fn value(&mut self, tree: &Tree, want: Option<Type>) -> Result<Value, Cause> {
        if let Some(value) = self.number(tree) {
            let ty = want.ok_or(Cause::WidthUnknown("a literal"))?;
            return Ok(Value::Literal {
                pattern: ty.pattern(value)?,
                ty,
            });
        }
        match tree {
            Tree::Paren(inner) => self.value(inner, want),
            Tree::Signal(name) => self.signal(name),
            Tree::Literal(literal) => literal_bit(literal),
            Tree::Cast(inner, bits) => self.cast(inner, *bits),
            Tree::Signed(inner) => self.signed(inner, want),
            Tree::Unsigned(inner) => self.unsigned(inner, want),
            Tree::Unary(op, inner) => self.unary(op, inner, want),
            Tree::Binary(a, VerilogOp::Shl, b) => self.shift(a, "<<", b, want),
            Tree::Binary(a, VerilogOp::Shr, b) => self.shift(a, ">>", b, want),
            Tree::Binary(a, VerilogOp::Mul, b) => self.product(a, b, want),
            Tree::Binary(a, op, b) => self.binary(a, op, b, want),
            Tree::Index(inner, index) => self.bit(inner, index),
            Tree::Slice(inner, width, offset) => self.slice(inner, *width, offset),
            Tree::IndexReplace(inner, index, bit) => self.replace_bit(inner, index, bit),
        }
    }

    // Leaves of the tree.

    fn signal(&mut self, name: &str) -> Result<Value, Cause> {
        let raw = paths::resolve(name, self.loops)?;
        let id = self
            .scope
            .find(&raw)
            .ok_or_else(|| Cause::UnknownSignal(name.to_owned()))?;
        let net = self.scope.net(id);
        match net.role {
            Role::Next | Role::PinIn | Role::RegisterClock | Role::RegisterReset => {
                Err(Cause::ReadsSubmoduleInput(net.raw.replace('$', ".")))
            }
            _ => Ok(Value::Part {
                net: id,
                low: 0,
                ty: net.ty,
            }),
        }
    }

    /// The value of arithmetic on integer literals and loop variables, whose width the surroundings decide.
    fn number(&self, tree: &Tree) -> Option<i128> {
        self.integer(tree, &|_| None)
    }

    /// The value of an index made of literals, loop variables and unsigned constants.
    fn constant_index(&self, tree: &Tree) -> Option<i128> {
        self.integer(tree, &|name| {
            let net = self
                .scope
                .net(self.scope.find(&paths::resolve(name, self.loops).ok()?)?);
            match net.role {
                Role::Constant(pattern) if !net.ty.signed => Some(pattern.into()),
                _ => None,
            }
        })
    }

    fn integer(&self, tree: &Tree, constant: &dyn Fn(&str) -> Option<i128>) -> Option<i128> {
        match tree {
            Tree::Paren(inner) => self.integer(inner, constant),
            Tree::Literal(literal) => literal_value(literal)
                .filter(|(width, _)| *width != 1)
                .map(|(_, value)| value),
            Tree::Signal(name) => paths::loop_value(name, self.loops).or_else(|| constant(name)),
            Tree::Unary(VerilogOpUnary::Neg, inner) => self.integer(inner, constant)?.checked_neg(),
            Tree::Binary(a, op, b) => {
                let (a, b) = (self.integer(a, constant)?, self.integer(b, constant)?);
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

    /// Literals, and operators on nothing but literals, are as wide as their surroundings say; so is `signed_bit_cast`.
    fn takes_width(&self, tree: &Tree) -> bool {
        match tree {
            _ if self.number(tree).is_some() => true,
            Tree::Signed(_) => true,
            Tree::Paren(inner) | Tree::Unary(VerilogOpUnary::Not | VerilogOpUnary::Neg, inner) => {
                self.takes_width(inner)
            }
            Tree::Binary(a, op, b) => {
                !compares(op)
                    && !matches!(op, VerilogOp::Shl | VerilogOp::Shr | VerilogOp::Mul)
                    && self.takes_width(a)
                    && self.takes_width(b)
            }
            _ => false,
        }
    }

    // Changes of width and sign.

    /// `bit_cast::<M, N>(x)` and `bits::<M>(5)`.
    fn cast(&mut self, inner: &Tree, bits: usize) -> Result<Value, Cause> {
        let width = u32::try_from(bits)
            .ok()
            .filter(|width| (1..=64).contains(width))
            .ok_or(Cause::Width(bits))?;
        let ty = Type::bits(width);
        if self.takes_width(inner) {
            return self.value(inner, Some(ty));
        }
        let value = self.value(inner, None)?;
        if value.ty().signed {
            return Err(self.mismatch(&value, Type::bits(value.ty().width)));
        }
        self.resize(value, ty)
    }

    /// `signed_cast(bits)`, same width; or `signed_bit_cast::<M, N>(signed)`, whose M the tree does not tell.
    fn signed(&mut self, inner: &Tree, want: Option<Type>) -> Result<Value, Cause> {
        let value = self.value(inner, None)?;
        let from = value.ty();
        if !from.signed {
            return Ok(self.reinterpret(value, Type { signed: true, ..from }));
        }
        let width = want.ok_or(Cause::WidthUnknown("`signed_bit_cast`"))?.width;
        self.resize(value, Type { width, signed: true })
    }

    fn unsigned(&mut self, inner: &Tree, want: Option<Type>) -> Result<Value, Cause> {
        let value = self.value(inner, want.map(|ty| Type { signed: true, ..ty }))?;
        let ty = Type::bits(value.ty().width);
        Ok(self.reinterpret(value, ty))
    }

    /// The same bits under the other sign.
    fn reinterpret(&mut self, value: Value, ty: Type) -> Value {
        match value {
            Value::Part { net, low, .. } => Value::Part { net, low, ty },
            Value::Literal { pattern, .. } => Value::Literal { pattern, ty },
            Value::Text { text, .. } => {
                let function = if ty.signed { "$signed" } else { "$unsigned" };
                Value::Text {
                    text: format!("{function}({text})"),
                    ty,
                    closed: true,
                }
            }
        }
    }

    /// Truncates, or extends by the sign of the value's type.
    fn resize(&mut self, value: Value, ty: Type) -> Result<Value, Cause> {
        let from = value.ty();
        if ty.width == from.width {
            return Ok(value);
        }
        if ty.width < from.width {
            return self.part(value, 0, ty);
        }
        let extra = ty.width - from.width;
        if let Some((pattern, _)) = self.constant(&value) {
            let negative = from.signed && pattern >> (from.width - 1) & 1 == 1;
            let extension = if negative { mask(from.width, extra) } else { 0 };
            return Ok(Value::Literal {
                pattern: pattern | extension,
                ty,
            });
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
        Ok(Value::Text { text, ty, closed: true })
    }

    /// Bits `low ..` of `value` as `ty`.
    fn part(&mut self, value: Value, low: u32, ty: Type) -> Result<Value, Cause> {
        if let Some((pattern, _)) = self.constant(&value) {
            return Ok(Value::Literal {
                pattern: pattern >> low & ty.mask(),
                ty,
            });
        }
        match value {
            Value::Part { net, low: base, .. } => Ok(Value::Part {
                net,
                low: base + low,
                ty,
            }),
            _ => Err(self.needs_local(&value)),
        }
    }

    // Bits and slices.

    fn bit(&mut self, inner: &Tree, index: &Tree) -> Result<Value, Cause> {
        let value = self.value(inner, None)?;
        if let Some(index) = self.constant_index(index) {
            return self.slice_at(value, index, 1, false);
        }
        let (index, index_ty) = self.index(index)?;
        let width = value.ty().width;
        if 1u64.checked_shl(index_ty.width) != Some(width.into()) {
            return Err(Cause::IndexRange {
                index_bits: index_ty.width,
                width,
            });
        }
        match value {
            Value::Part { net, low: 0, .. } if self.is_vector(net, width) => {
                let name = self.select(net, 0, width);
                Ok(Value::Text {
                    text: format!("{name}[{index}]"),
                    ty: BIT,
                    closed: true,
                })
            }
            _ => Err(self.needs_local(&value)),
        }
    }

    /// May a signal select a bit of it? Verilog-2001 selects from nets only, not from constants.
    fn is_vector(&self, id: NetId, width: u32) -> bool {
        let net = self.scope.net(id);
        net.ty.width == width && !matches!(net.role, Role::Constant(_))
    }

    fn slice(&mut self, inner: &Tree, width: usize, offset: &Tree) -> Result<Value, Cause> {
        let value = self.value(inner, None)?;
        let Some(low) = self.constant_index(offset) else {
            self.index(offset)?;
            let found = "a slice at an offset that is a signal".to_owned();
            return Err(Cause::Unsupported {
                found,
                remedy: "shift by the signal into a Local, then slice that at 0",
            });
        };
        let signed = value.ty().signed;
        self.slice_at(value, low, width, signed)
    }

    fn slice_at(&mut self, value: Value, low: i128, width: usize, signed: bool) -> Result<Value, Cause> {
        let low = self.check_range(&value, low, width)?;
        self.part(
            value,
            low,
            Type {
                width: width as u32,
                signed,
            },
        )
    }

    fn check_range(&mut self, value: &Value, low: i128, width: usize) -> Result<u32, Cause> {
        let available = value.ty().width;
        let high = low.saturating_add(width as i128) - 1;
        if low < 0 || width == 0 || high >= i128::from(available) {
            return Err(Cause::OutOfRange {
                found: self.text(value),
                low,
                high,
                width: available,
            });
        }
        Ok(low as u32)
    }

    fn replace_bit(&mut self, inner: &Tree, index: &Tree, bit: &Tree) -> Result<Value, Cause> {
        let value = self.value(inner, None)?;
        let (ty, bit) = (value.ty(), self.value(bit, Some(BIT))?);
        self.expect(&bit, BIT)?;
        let Some(index) = self.constant_index(index) else {
            self.index(index)?;
            let found = "`replace_bit` at an index that is a signal".to_owned();
            return Err(Cause::Unsupported {
                found,
                remedy: "compare with each index in a loop",
            });
        };
        let low = self.check_range(&value, index, 1)?;
        let mut pieces = Vec::new();
        if low + 1 < ty.width {
            pieces.push(self.part(value.clone(), low + 1, Type::bits(ty.width - low - 1))?);
        }
        pieces.push(bit);
        if low > 0 {
            pieces.push(self.part(value, 0, Type::bits(low))?);
        }
        let pieces: Vec<_> = pieces.iter().map(|piece| self.text(piece)).collect();
        let whole = Value::Text {
            text: format!("{{{}}}", pieces.join(", ")),
            ty: Type::bits(ty.width),
            closed: true,
        };
        Ok(if ty.signed { self.reinterpret(whole, ty) } else { whole })
    }

    // Operators.

    fn unary(&mut self, op: &VerilogOpUnary, inner: &Tree, want: Option<Type>) -> Result<Value, Cause> {
        let keeps_type = matches!(op, VerilogOpUnary::Not | VerilogOpUnary::Neg);
        let value = self.value(inner, want.filter(|_| keeps_type))?;
        let ty = value.ty();
        let operand = self.operand(&value);
        Ok(match op {
            VerilogOpUnary::Not if ty == BIT => Value::Text {
                text: format!("!{operand}"),
                ty,
                closed: true,
            },
            VerilogOpUnary::Not => Value::Text {
                text: format!("~{operand}"),
                ty,
                closed: true,
            },
            VerilogOpUnary::Neg => Value::Text {
                text: format!("-{operand}"),
                ty,
                closed: false,
            },
            VerilogOpUnary::All => Value::Text {
                text: format!("(&{operand})"),
                ty: BIT,
                closed: true,
            },
            VerilogOpUnary::Any => Value::Text {
                text: format!("(|{operand})"),
                ty: BIT,
                closed: true,
            },
            VerilogOpUnary::Xor => Value::Text {
                text: format!("(^{operand})"),
                ty: BIT,
                closed: true,
            },
        })
    }

    fn binary(&mut self, a: &Tree, op: &VerilogOp, b: &Tree, want: Option<Type>) -> Result<Value, Cause> {
        let symbol = match op {
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
        };
        let context = want.filter(|_| !compares(op));
        let (left, right) = if self.takes_width(a) && !self.takes_width(b) {
            let right = self.value(b, context)?;
            (self.value(a, Some(right.ty()))?, right)
        } else {
            let left = self.value(a, context)?;
            let ty = left.ty();
            (left, self.value(b, Some(ty))?)
        };
        self.expect(&right, left.ty())?;
        let ty = if compares(op) { BIT } else { left.ty() };
        let text = format!("{} {symbol} {}", self.operand(&left), self.operand(&right));
        Ok(Value::Text {
            text,
            ty,
            closed: false,
        })
    }

    /// Verilog computes a product at the width of its target, which must therefore be the full product, and its operands
    /// must be nets, which the target's width extends by their own sign.
    fn product(&mut self, a: &Tree, b: &Tree, want: Option<Type>) -> Result<Value, Cause> {
        let (left, right) = (self.value(a, None)?, self.value(b, None)?);
        for operand in [&left, &right] {
            if matches!(operand, Value::Text { .. }) {
                return Err(self.needs_local(operand));
            }
        }
        self.expect(&right, left.ty())?;
        let ty = Type {
            width: 2 * left.ty().width,
            signed: left.ty().signed,
        };
        let text = format!("{} * {}", self.operand(&left), self.operand(&right));
        let value = Value::Text {
            text,
            ty,
            closed: false,
        };
        if want == Some(ty) {
            Ok(value)
        } else {
            Err(self.needs_local(&value))
        }
    }

    fn shift(&mut self, a: &Tree, symbol: &str, b: &Tree, want: Option<Type>) -> Result<Value, Cause> {
        let value = self.value(a, want)?;
        let ty = value.ty();
        if ty.signed || self.takes_width(a) {
            let found = "a shift of a signed value or of a literal".to_owned();
            return Err(Cause::Unsupported {
                found,
                remedy: "slice a Local, or use a `Constant`",
            });
        }
        let amount = match self.constant_index(b) {
            Some(amount) if (0..i128::from(ty.width)).contains(&amount) => amount.to_string(),
            Some(amount) => {
                let found = self.text(&value);
                return Err(Cause::OutOfRange {
                    found,
                    low: amount,
                    high: amount,
                    width: ty.width,
                });
            }
            None => self.index(b)?.0,
        };
        let text = format!("{} {symbol} {amount}", self.operand(&value));
        Ok(Value::Text {
            text,
            ty,
            closed: false,
        })
    }

    /// A signal as index or shift amount, as an operand.
    fn index(&mut self, tree: &Tree) -> Result<(String, Type), Cause> {
        let value = self.value(tree, None)?;
        if value.ty().signed {
            return Err(self.mismatch(&value, Type::bits(value.ty().width)));
        }
        Ok((self.operand(&value), value.ty()))
    }

    // Text.

    /// The pattern of a literal or of (a part of) a constant.
    fn constant(&self, value: &Value) -> Option<(u64, Type)> {
        match value {
            Value::Literal { pattern, ty } => Some((*pattern, *ty)),
            Value::Part { net, low, ty } => match self.scope.net(*net).role {
                Role::Constant(pattern) => Some((pattern >> low & ty.mask(), *ty)),
                _ => None,
            },
            Value::Text { .. } => None,
        }
    }

    /// Text of `value`; its bits count as read.
    fn text(&mut self, value: &Value) -> String {
        match value {
            Value::Text { text, .. } => text.clone(),
            Value::Literal { pattern, ty } => ty.literal(*pattern),
            Value::Part { net: id, low, ty } => {
                let net = self.scope.net(*id);
                if let (Role::Constant(pattern), true) = (net.role, *ty != net.ty) {
                    return ty.literal(pattern >> low & ty.mask());
                }
                let bits = self.select(*id, *low, ty.width);
                match (ty.signed, ty.width == net.ty.width && net.ty.signed) {
                    (true, false) => format!("$signed({bits})"),
                    (false, true) => format!("$unsigned({bits})"),
                    _ => bits,
                }
            }
        }
    }

    /// A net, or bits of it, without regard to sign; they count as read.
    fn select(&mut self, id: NetId, low: u32, width: u32) -> String {
        self.reads.push((id, mask(low, width)));
        let net = self.scope.net(id);
        match width {
            _ if width == net.ty.width => net.name.clone(),
            1 => format!("{}[{low}]", net.name),
            _ => format!("{}[{}:{low}]", net.name, low + width - 1),
        }
    }

    /// Text of `value`, in parentheses where an operator beside it could take it apart.
    fn operand(&mut self, value: &Value) -> String {
        let text = self.text(value);
        match value {
            Value::Text { closed: false, .. } => format!("({text})"),
            Value::Literal { .. } if text.starts_with('-') => format!("({text})"),
            _ => text,
        }
    }

    fn expect(&mut self, value: &Value, expected: Type) -> Result<(), Cause> {
        if value.ty() == expected {
            Ok(())
        } else {
            Err(self.mismatch(value, expected))
        }
    }

    fn mismatch(&mut self, value: &Value, expected: Type) -> Cause {
        Cause::TypeMismatch {
            found: self.text(value),
            found_type: value.ty(),
            expected,
        }
    }

    fn needs_local(&mut self, value: &Value) -> Cause {
        Cause::NeedsLocal(self.text(value))
    }
}

fn compares(op: &VerilogOp) -> bool {
    matches!(
        op,
        VerilogOp::Eq | VerilogOp::Lt | VerilogOp::Le | VerilogOp::Ne | VerilogOp::Ge | VerilogOp::Gt
    )
}

/// `true` or `false`: RustHDL gives them one bit, and integers the width of some Rust integer, which means nothing.
fn literal_bit(literal: &VerilogLiteral) -> Result<Value, Cause> {
    let (_, value) = literal_value(literal).ok_or(Cause::WidthUnknown("a literal"))?;
    Ok(Value::Literal {
        pattern: BIT.pattern(value)?,
        ty: BIT,
    })
}
