//! Compares shapers on a contour: each kind, with the axes' own delays and with equal ones, on machines whose modes
//! differ from the file.

use super::ContourError;
use super::follow::{FollowedContour, follow};
use super::plan::Contour;
use crate::compare::with_kind;
use crate::design::design_machine;
use crate::design::kind::ShaperKind;
use crate::machine_file::{AxisSection, Machine, StageSection};
use crate::plant::axis::ErrorFigures;

/// Frequencies of the machine's modes, as multiples of those that the shapers are designed for.
pub const FREQUENCY_FACTORS: [f64; 5] = [0.8, 0.9, 1.0, 1.1, 1.2];
/// Index of the factor 1.
const NOMINAL: usize = 2;
/// Kinds that are compared with the machine's own.
const KINDS: [ShaperKind; 4] = [ShaperKind::None, ShaperKind::Zv, ShaperKind::Zvd, ShaperKind::Ei];

/// A shaper on a contour.
#[derive(Debug, Clone, PartialEq)]
pub struct ContourRow {
    /// Kind of the shaper on all axes; for the machine's own, the kinds of the axes, joined by a comma where they
    /// differ.
    pub kind: String,
    /// Whether the row is the shaper of the machine file.
    pub in_file: bool,
    /// Whether the axes have equal delays.
    pub matched: bool,
    /// Distance from the path at each of [`FREQUENCY_FACTORS`]; the error says why the axes have no such tables.
    pub errors: Result<[ErrorFigures; 5], String>,
    /// The followed contour of the machine whose modes are as in the file.
    pub nominal: Option<FollowedContour>,
}

/// Compares the machine's own shapers with other kinds.
///
/// # Errors
/// [`ContourError`] where the machine cannot follow the contour at all.
pub fn compare(machine: &Machine, contour: &Contour) -> Result<Vec<ContourRow>, ContourError> {
    let own: Vec<String> = machine.axes.iter().take(2).map(AxisSection::kind_name).collect();
    let own_kind = if own.iter().all(|kind| *kind == own[0]) {
        own[0].clone()
    } else {
        own.join(", ")
    };
    let of_file = (own_kind.clone(), machine.clone(), true);
    let others = KINDS.into_iter().filter(|kind| kind.name() != own_kind).map(|kind| {
        let axes = machine.axes.iter().map(|axis| with_kind(axis, kind));
        let other = Machine {
            axes: axes.collect(),
            ..machine.clone()
        };
        (kind.name().to_owned(), other, false)
    });
    let mut rows = Vec::new();
    for (kind, machine, in_file) in std::iter::once(of_file).chain(others) {
        for matched in [false, true] {
            rows.push(row(&machine, contour, kind.clone(), in_file, matched)?);
        }
    }
    Ok(rows)
}

fn row(
    machine: &Machine,
    contour: &Contour,
    kind: String,
    in_file: bool,
    matched: bool,
) -> Result<ContourRow, ContourError> {
    // Other kinds cannot be designed as one.
    let equal = StageSection {
        arrive_together: in_file && machine.stage.is_some_and(|stage| stage.arrive_together),
        ..machine.stage.unwrap_or_default()
    };
    let machine = Machine {
        stage: matched.then_some(equal),
        ..machine.clone()
    };
    let (errors, nominal) = match design_machine(&machine) {
        Err(reason) => (Err(reason.to_string()), None),
        Ok(design) => {
            let follow = |factor: &f64| follow(&machine, &design, contour, *factor);
            let followed: Vec<FollowedContour> = FREQUENCY_FACTORS.iter().map(follow).collect::<Result<_, _>>()?;
            let errors = std::array::from_fn(|factor| followed[factor].error);
            (Ok(errors), followed.into_iter().nth(NOMINAL))
        }
    };
    Ok(ContourRow {
        kind,
        in_file,
        matched,
        errors,
        nominal,
    })
}
