//! Look-up tables of a Gowin device: what drives their inputs, and on which of them they depend.

use super::routing::{GowinOutput, GowinRouting, GowinSource};
use crate::BitstreamError;

/// The inputs of a look-up table.
const TABLE_INPUTS: [char; 4] = ['A', 'B', 'C', 'D'];
/// What drives the inputs of a table.
pub(super) fn table_inputs(
    routing: &GowinRouting<'_>,
    of: GowinOutput,
    table: u8,
) -> Result<[GowinSource; 4], BitstreamError> {
    let mut inputs = [GowinSource::Nothing; 4];
    for (input, letter) in inputs.iter_mut().zip(TABLE_INPUTS) {
        *input = routing.source(of.row, of.column, &format!("{letter}{table}"))?;
    }
    Ok(inputs)
}

/// The inputs of a table on which it depends, given those that are constant; the others are low. A wire without a switch leads anywhere.
pub(super) fn relevant(values: u16, inputs: [GowinSource; 4]) -> [GowinSource; 4] {
    let mut found = inputs;
    for (index, input) in found.iter_mut().enumerate() {
        let is_constant = matches!(inputs[index], GowinSource::Constant(_));
        let differs = |entry: &u16| values >> entry & 1 != values >> (entry ^ 1 << index) & 1;
        if !is_constant && !entries(inputs).any(|entry| differs(&entry)) {
            *input = GowinSource::Constant(false);
        }
    }
    found
}

/// The level of a table whose inputs leave it constant.
pub(super) fn constant_function(values: u16, inputs: [GowinSource; 4]) -> Option<bool> {
    let mut levels = entries(inputs).map(|entry| values >> entry & 1 == 1);
    let first = levels.next()?;
    levels.all(|level| level == first).then_some(first)
}

/// The entries of a table that its constant inputs can select.
fn entries(inputs: [GowinSource; 4]) -> impl Iterator<Item = u16> {
    (0..16u16).filter(move |entry| {
        let fits = |(index, input): (usize, &GowinSource)| match input {
            GowinSource::Constant(level) => (entry >> index & 1 == 1) == *level,
            _ => true,
        };
        inputs.iter().enumerate().all(fits)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gowin::routing::GowinPort;

    #[test]
    fn inputs_that_cannot_matter_are_left_out() {
        let output = |table| {
            let port = GowinPort::Table(table);
            GowinSource::Output(GowinOutput {
                row: 1,
                column: 2,
                port,
            })
        };
        let high = GowinSource::Constant(true);
        let low = GowinSource::Constant(false);
        // A and B, whatever C and D are.
        let and = 0x8888;
        let inputs = [output(0), output(1), output(2), GowinSource::Nothing];
        assert_eq!(relevant(and, inputs), [output(0), output(1), low, low]);
        // C chooses A or B; it is high.
        let choice = 0xCACA;
        let inputs = [output(0), output(1), high, low];
        assert_eq!(relevant(choice, inputs), [low, output(1), high, low]);
        // The head of a carry chain: its function is low, whatever its open inputs are.
        let inputs = [output(0), GowinSource::Nothing, high, GowinSource::Nothing];
        assert_eq!(constant_function(0x000F, inputs), Some(false));
        assert_eq!(constant_function(0x609A, inputs), None);
    }
}
