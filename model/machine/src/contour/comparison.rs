//! Compares shapers on a contour: each kind, with the axes' own delays and with equal ones, on machines whose modes
//! differ from the file.

use super::ContourError;
use super::corners::CornerRules;
use super::follow::{FollowedContour, Followers, drive};
use super::stroke::Stroke;
use crate::compare::with_kind;
use crate::machine_file::{Machine, StageSection};
use crate::plan::design_machine;
use posicast_shaper::design::kind::ShaperKind;

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
    /// The followed contour at each of [`FREQUENCY_FACTORS`]; the error is the reason why the axes have no such tables.
    pub followed: Result<[FollowedContour; 5], String>,
}

impl ContourRow {
    /// The followed contour of the machine whose modes are as in the file.
    pub fn nominal(&self) -> Option<&FollowedContour> {
        self.followed.as_ref().ok().map(|followed| &followed[NOMINAL])
    }
}

/// Compares the machine's own shapers with other kinds on a path, whose strokes are taken as they are needed.
/// `progress` gets the number of samples that are done.
///
/// # Errors
/// Those of the strokes, and [`ContourError`] where the machine cannot follow the contour at all.
pub fn compare(
    machine: &Machine,
    strokes: &mut dyn Iterator<Item = Result<Stroke, ContourError>>,
    rules: &CornerRules,
    progress: &mut dyn FnMut(u64),
) -> Result<Vec<ContourRow>, ContourError> {
    let own: Vec<String> = machine
        .axes
        .iter()
        .take(2)
        .map(|axis| axis.shaped().kind_name())
        .collect();
    let own_kind = match own.as_slice() {
        [x, y] if x != y => own.join(", "),
        [x, ..] => x.clone(),
        [] => String::new(),
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
    let mut followers = Vec::new();
    for (kind, machine, in_file) in std::iter::once(of_file).chain(others) {
        for matched in [false, true] {
            let machine = with_delays(&machine, in_file, matched);
            let design = design_machine(&machine).map_err(|reason| reason.to_string());
            if let Ok(design) = &design {
                followers.push(Followers::new(&machine, design, &FREQUENCY_FACTORS)?);
            }
            rows.push((kind.clone(), in_file, matched, design.map(|_| ())));
        }
    }
    drive(machine, strokes, rules, &mut followers, progress)?;
    let mut followers = followers.into_iter();
    let rows = rows.into_iter().map(|(kind, in_file, matched, design)| ContourRow {
        kind,
        in_file,
        matched,
        followed: design.and_then(|()| {
            let followed = followers.next().map(Followers::followed);
            followed.ok_or_else(|| "it was not simulated".to_owned())
        }),
    });
    Ok(rows.collect())
}

/// The machine with equal delays of its axes, or with each axis's own.
fn with_delays(machine: &Machine, in_file: bool, matched: bool) -> Machine {
    // Other kinds cannot be designed as one.
    let equal = StageSection {
        arrive_together: in_file && machine.stage.is_some_and(|stage| stage.arrive_together),
        ..machine.stage.unwrap_or_default()
    };
    Machine {
        stage: matched.then_some(equal),
        ..machine.clone()
    }
}
