//! Makes a kernel of any size from the same kernel built at a few sizes.
//!
//! A size is a const generic of a kernel, so each compiled size is a Rust type of its own. The samples are nodes of
//! one kernel, built for one configuration at different sizes. Their differences are resolved here, once, so that the
//! following passes see a node like any other:
//!
//! - A width is a constant plus the sum of some of the sizes: `W + 18`, `A + T`. All samples must agree on the form.
//!   One sample more than the form needs detects widths of any other form, which are refused.
//! - A value of a constant, or the reset value of a register, comes from the configuration and is the same in all
//!   samples, except that narrow samples have only its low bits. It is cut to the wanted width; the bits above must be
//!   copies of one bit. A constant may also be a number with the form of a width.
//! - Everything else must be equal: names, kinds, signs, statements, the text of leaves.
//!
//! The samples must distinguish the sums: no two subsets of the sizes may change by the same sum between samples.

use super::collect::{Kind, Node};
use super::error::{EmitCause, EmitError};
use super::leaf::{self, RegisterTag};
use super::types::{Type, mask};
use rust_hdl_core::ast::{VerilogBlockOrConditional, VerilogExpression as Tree, VerilogStatement as Statement};
use rust_hdl_core::prelude::Verilog;

/// Makes the kernel at the sizes `wanted`. Each sample has its sizes, in the order of `wanted`, and its node.
pub(super) fn resolve(samples: Vec<(Vec<u32>, Node)>, wanted: &[u32]) -> Result<Node, EmitError> {
    let (samples, mut nodes): (Vec<_>, Vec<_>) = samples.into_iter().unzip();
    if nodes.is_empty() || samples.iter().any(|sizes: &Vec<u32>| sizes.len() != wanted.len()) {
        let path = nodes.first().map(|node: &Node| node.path.clone()).unwrap_or_default();
        let cause = EmitCause::SizesDiffer("number of sizes".to_owned());
        return Err(EmitError::new(&path, "", cause));
    }
    let first = nodes.remove(0);
    Sizes { samples, wanted }.node(first, &nodes.iter().collect::<Vec<_>>())
}

struct Sizes<'a> {
    samples: Vec<Vec<u32>>,
    wanted: &'a [u32],
}

impl Sizes<'_> {
    /// Resolves `node` at the wanted sizes; `others` are the corresponding nodes of the other samples.
    fn node(&self, mut node: Node, others: &[&Node]) -> Result<Node, EmitError> {
        let at = |signal: &str| {
            let (path, signal) = (node.path.clone(), signal.replace('$', "."));
            move |cause| EmitError::new(&path, &signal, cause)
        };
        let alike = |same: bool, what: &str| {
            if same {
                Ok(())
            } else {
                Err(EmitCause::SizesDiffer(what.to_owned()))
            }
        };
        let all = |same: &dyn Fn(&Node) -> bool| others.iter().all(|other| same(other));
        alike(all(&|other| other.raw == node.raw), "name of a block").map_err(at(""))?;
        alike(
            all(&|other| other.signals.len() == node.signals.len()),
            "list of signals",
        )
        .map_err(at(""))?;
        alike(
            all(&|other| other.children.len() == node.children.len()),
            "list of blocks",
        )
        .map_err(at(""))?;
        alike(
            all(&|other| other.connections == node.connections),
            "list of connections",
        )
        .map_err(at(""))?;
        alike(all(&|other| other.enums == node.enums), "list of enumerations").map_err(at(""))?;

        let reset = self.register(&node, others).map_err(at(""))?;
        for index in 0..node.signals.len() {
            let signal = &node.signals[index];
            let same: Vec<_> = others.iter().map(|other| &other.signals[index]).collect();
            let plain = |kind: Kind| {
                if let Kind::Constant(_) = kind {
                    Kind::Constant(0)
                } else {
                    kind
                }
            };
            let kept = same.iter().all(|other| {
                (&other.raw, plain(other.kind), other.ty.signed, other.is_clock)
                    == (&signal.raw, plain(signal.kind), signal.ty.signed, signal.is_clock)
            });
            alike(kept, "declaration of a signal").map_err(at(&signal.raw))?;
            let types: Vec<_> = [signal].into_iter().chain(same.iter().copied()).map(|s| s.ty).collect();
            let ty = self.ty(&types).map_err(at(&signal.raw))?;
            let patterns = [signal].into_iter().chain(same).filter_map(|s| match s.kind {
                Kind::Constant(pattern) => Some(pattern),
                _ => None,
            });
            let patterns: Vec<_> = patterns.collect();
            let kind = match signal.kind {
                Kind::Constant(_) => Kind::Constant(self.value(&patterns, &types, ty).map_err(at(&signal.raw))?),
                kind => kind,
            };
            (node.signals[index].ty, node.signals[index].kind) = (ty, kind);
        }
        node.code = match reset {
            Some((tag, ty)) => Verilog::Custom(leaf::register_text(tag, ty)),
            None => self.code(&node, others)?,
        };
        for (index, child) in std::mem::take(&mut node.children).into_iter().enumerate() {
            let others: Vec<_> = others.iter().map(|other| &other.children[index]).collect();
            node.children.push(self.node(child, &others)?);
        }
        Ok(node)
    }

    /// A register's tag and its type; `None` for any other block.
    fn register(&self, node: &Node, others: &[&Node]) -> Result<Option<(RegisterTag, Type)>, EmitCause> {
        let mut found = (Vec::new(), Vec::new());
        let mut is_kept = false;
        for sample in [node].iter().chain(others) {
            let Some(tag) = leaf::register(sample)? else {
                return Ok(None);
            };
            is_kept = tag.is_kept;
            found.0.push(tag.initial);
            found
                .1
                .extend(sample.ports().find(|port| port.raw == "q").map(|port| port.ty));
        }
        let ty = self.ty(&found.1)?;
        let initial = self.value(&found.0, &found.1, ty)?;
        Ok(Some((RegisterTag { initial, is_kept }, ty)))
    }

    fn code(&self, node: &Node, others: &[&Node]) -> Result<Verilog, EmitError> {
        let error = |signal: &str, cause| EmitError::new(&node.path, &signal.replace('$', "."), cause);
        let mut blocks = Vec::new();
        for sample in [node].iter().chain(others) {
            match (&sample.code, &node.code) {
                (Verilog::Combinatorial(block), Verilog::Combinatorial(_)) => blocks.push(block.clone()),
                (Verilog::Custom(text), Verilog::Custom(first)) if text == first => {}
                _ => return Err(error("", EmitCause::SizesDiffer("text of a leaf".to_owned()))),
            }
        }
        let Some(mut kernel) = blocks.first().cloned() else {
            return Ok(node.code.clone());
        };
        let mut numbers = Vec::new();
        let mut shapes = Vec::new();
        for block in &mut blocks {
            let mut of_block = Vec::new();
            each_number(block, "", &mut |_, number| of_block.push(std::mem::take(number)));
            numbers.push(of_block);
            // The numbers have been removed, so equal trees have the same text.
            shapes.push(format!("{block:?}"));
        }
        if shapes.iter().any(|shape| *shape != shapes[0]) {
            return Err(error("", EmitCause::SizesDiffer("kernel".to_owned())));
        }
        let (mut next, mut wrong) = (0, None);
        each_number(&mut kernel, "", &mut |signal, number| {
            let found: Vec<_> = numbers.iter().map(|of_block| of_block[next] as i128).collect();
            next += 1;
            match self.number(&found).map(usize::try_from) {
                Ok(Ok(resolved)) => *number = resolved,
                Ok(Err(_)) => wrong = wrong.take().or(Some(error(signal, EmitCause::Width(0)))),
                Err(cause) => wrong = wrong.take().or(Some(error(signal, cause))),
            }
        });
        wrong.map_or(Ok(Verilog::Combinatorial(kernel)), Err)
    }

    fn ty(&self, found: &[Type]) -> Result<Type, EmitCause> {
        let widths: Vec<_> = found.iter().map(|ty| i128::from(ty.width)).collect();
        let width = self.number(&widths)?;
        let in_range = u32::try_from(width).ok().filter(|width| (1..=64).contains(width));
        Ok(Type {
            width: in_range.ok_or(EmitCause::Width(width.try_into().unwrap_or(0)))?,
            signed: found[0].signed,
        })
    }

    /// Returns the number at the wanted sizes, a constant plus the sum of some of the sizes; `found` has the numbers of
    /// the samples.
    fn number(&self, found: &[i128]) -> Result<i128, EmitCause> {
        let sum = |set: u32, sizes: &[u32]| -> i128 {
            let members = sizes.iter().enumerate().filter(|(index, _)| set >> index & 1 == 1);
            members.map(|(_, size)| i128::from(*size)).sum()
        };
        let mut fits = (0..1u32 << self.wanted.len()).filter_map(|set| {
            let mut rest = found
                .iter()
                .zip(&self.samples)
                .map(|(number, sizes)| number - sum(set, sizes));
            let constant = rest.next()?;
            rest.all(|other| other == constant)
                .then(|| constant + sum(set, self.wanted))
        });
        match (fits.next(), fits.next()) {
            (Some(number), None) => Ok(number),
            _ => Err(EmitCause::SizeNumber(list(found))),
        }
    }

    /// Returns the pattern of a constant or reset value in the type `wanted`; `found` has the patterns of the samples.
    fn value(&self, found: &[u64], types: &[Type], wanted: Type) -> Result<u64, EmitCause> {
        let all = || found.iter().zip(types);
        let widest = all().max_by_key(|(_, ty)| ty.width);
        let (&pattern, &ty) = widest.ok_or_else(|| EmitCause::SizeValue(String::new()))?;
        if !all().all(|(narrow, ty)| *narrow == pattern & ty.mask()) {
            let numbers: Vec<_> = found.iter().map(|pattern| i128::from(*pattern)).collect();
            let number = self
                .number(&numbers)
                .map_err(|_| EmitCause::SizeValue(list(&numbers)))?;
            return EmitCause::pattern(wanted, number);
        }
        if wanted.width > ty.width {
            return Err(EmitCause::SizeValue(format!("{pattern}, of {} bits", ty.width)));
        }
        // The bits that are cut off must be copies of one bit; for a signed value, of its sign.
        let from = if wanted.signed { wanted.width - 1 } else { wanted.width };
        let rest = mask(from, ty.width - from);
        match pattern & rest {
            cut if cut == 0 || cut == rest => Ok(pattern & wanted.mask()),
            _ => Err(EmitCause::Literal {
                value: pattern.into(),
                place: wanted,
            }),
        }
    }
}

fn list(numbers: &[i128]) -> String {
    numbers.iter().map(i128::to_string).collect::<Vec<_>>().join(", ")
}

/// Calls `visit` for every number of `block` that can depend on a size, with the signal that is assigned there.
fn each_number(block: &mut [Statement], signal: &str, visit: &mut dyn FnMut(&str, &mut usize)) {
    for statement in block {
        match statement {
            Statement::Assignment(target, value) => {
                let name = if let Tree::Signal(name) = &target {
                    name.clone()
                } else {
                    String::new()
                };
                let name = name.strip_suffix("$next").unwrap_or(&name);
                in_expression(target, name, visit);
                in_expression(value, name, visit);
            }
            Statement::SliceAssignment {
                base,
                width,
                offset,
                replacement,
            } => {
                visit(signal, width);
                for tree in [base, offset, replacement] {
                    in_expression(tree, signal, visit);
                }
            }
            Statement::If(conditional) => {
                in_expression(&mut conditional.test, signal, visit);
                each_number(&mut conditional.then, signal, visit);
                match &mut conditional.otherwise {
                    VerilogBlockOrConditional::Block(block) => each_number(block, signal, visit),
                    VerilogBlockOrConditional::Conditional(inner) => {
                        each_number(std::slice::from_mut(&mut **inner), signal, visit);
                    }
                    VerilogBlockOrConditional::None => {}
                }
            }
            Statement::Match(cases) => {
                in_expression(&mut cases.test, signal, visit);
                cases
                    .cases
                    .iter_mut()
                    .for_each(|case| each_number(&mut case.block, signal, visit));
            }
            Statement::Loop(turns) => each_number(&mut turns.block, signal, visit),
            Statement::Macro(block) => each_number(block, signal, visit),
            Statement::Comment(_) | Statement::Link(_) => {}
        }
    }
}

fn in_expression(tree: &mut Tree, signal: &str, visit: &mut dyn FnMut(&str, &mut usize)) {
    match tree {
        Tree::Signal(_) | Tree::Literal(_) => {}
        Tree::Cast(inner, width) => {
            visit(signal, width);
            in_expression(inner, signal, visit);
        }
        Tree::Signed(inner) | Tree::Unsigned(inner) | Tree::Paren(inner) | Tree::Unary(_, inner) => {
            in_expression(inner, signal, visit);
        }
        Tree::Binary(a, _, b) | Tree::Index(a, b) => {
            in_expression(a, signal, visit);
            in_expression(b, signal, visit);
        }
        Tree::Slice(inner, width, offset) => {
            visit(signal, width);
            in_expression(inner, signal, visit);
            in_expression(offset, signal, visit);
        }
        Tree::IndexReplace(inner, index, bit) => {
            in_expression(inner, signal, visit);
            in_expression(index, signal, visit);
            in_expression(bit, signal, visit);
        }
    }
}
