//! The proofs of the supervisor of an axis, with one property file per subject.

use posicast_blocks::axis::{
    self as model, ALWAYS_OFF, CAUSE_BITS, Cause, Condition, HARMLESS, KICK, SupervisorState, TRANSITIONS, Transition,
};
use posicast_blocks::segments;
use posicast_hdl::axis;

use crate::Error;
use crate::formal::{Engine, INDUCTION, Task};

/// Returns all of these proofs.
pub(crate) fn tasks() -> Result<Vec<Task>, Error> {
    let block = (axis::emit("")?, model::ports());
    let macros = macros();
    let task = |name, engine, text| {
        Task::new(name, "all inputs", engine, block.clone())
            .macros(&macros)
            .properties(&[], text)
    };
    Ok(vec![
        task("axis", Engine::Pdr, include_str!("axis.sv")),
        task("axis_table", INDUCTION, include_str!("axis_table.sv")),
        task("axis_causes", INDUCTION, include_str!("axis_causes.sv")),
        task("axis_brake", INDUCTION, include_str!("axis_brake.sv")),
        task("axis_monitors", INDUCTION, include_str!("axis_monitors.sv")),
        task("axis_lines", INDUCTION, include_str!("axis_lines.sv")),
    ])
}

/// Macros for states, causes and the transition table, all from the model.
pub(crate) fn macros() -> Vec<(String, String)> {
    let mut macros: Vec<(String, String)> = SupervisorState::ALL
        .map(|state| (state.name().to_owned(), format!("3'd{}", state as u8)))
        .into();
    macros.extend(Cause::ALL.map(|cause| {
        (
            cause.name().replace('-', "_").to_uppercase(),
            format!("{CAUSE_BITS}'d{}", cause.bit()),
        )
    }));
    let counts = |counts: i32| format!("32'sd{counts}");
    let segments = |state: segments::SegmentsState| format!("2'd{}", state as u8);
    let others = [
        ("ALWAYS_OFF", format!("{CAUSE_BITS}'d{ALWAYS_OFF}")),
        ("HARMLESS", format!("{CAUSE_BITS}'d{HARMLESS}")),
        ("KICK", format!("32'd{KICK}")),
        ("STAND_COUNTS", counts(segments::STAND_COUNTS)),
        ("SEGMENTS_HOLD", segments(segments::SegmentsState::Hold)),
        ("SEGMENTS_STOPPED", segments(segments::SegmentsState::Stopped)),
        ("ALLOWED(from, to)", allowed()),
        ("NEXT(from)", next()),
    ];
    macros.extend(others.map(|(name, value)| (name.to_owned(), value)));
    macros
}

/// Returns an expression for whether one state may follow another.
fn allowed() -> String {
    let row = |row: &Transition| format!("((from) == 3'd{} & (to) == 3'd{})", row.from as u8, row.to as u8);
    let rows: Vec<String> = TRANSITIONS.iter().map(row).collect();
    format!("({})", rows.join(" | "))
}

/// Returns an expression for the next state: that of the first row whose conditions hold. Conditions are wires, such as
/// `if_tick` for `Tick`.
fn next() -> String {
    let rows = TRANSITIONS.iter().map(|row| {
        let named = |condition: Condition| format!("if_{}", condition.name());
        let needed = Condition::ALL
            .into_iter()
            .filter(|condition| row.needs(*condition))
            .map(named);
        let forbidden = Condition::ALL
            .into_iter()
            .filter(|condition| row.forbids(*condition))
            .map(|condition| format!("!{}", named(condition)));
        let from = format!("(from) == 3'd{}", row.from as u8);
        let all: Vec<String> = std::iter::once(from).chain(needed).chain(forbidden).collect();
        format!("({}) ? 3'd{} : ", all.join(" & "), row.to as u8)
    });
    format!("({}(from))", rows.collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_in_the_order_of_the_table() {
        let text = next();
        assert!(
            text.starts_with("(((from) == 3'd0 & if_drive_ready & !if_cause & !if_enable) ? 3'd1 : "),
            "{text}"
        );
        assert_eq!(text.matches('?').count(), TRANSITIONS.len());
        assert!(
            text.ends_with("((from) == 3'd5 & if_cleared) ? 3'd0 : (from))"),
            "{text}"
        );
    }
}
