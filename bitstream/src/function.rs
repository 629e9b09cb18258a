//! Compares look-up tables as functions of what drives their inputs.

/// Whether two tables of at most four inputs are the same function of what drives their inputs, whatever the order of the inputs.
///
/// `level` gives the level of a driver that is constant. Bit `i` of a table is its value for inputs whose levels are the bits of `i`.
pub(crate) fn is_same<D: Copy + PartialEq>(
    level: impl Fn(D) -> Option<bool>,
    (inputs, table): (&[D], u16),
    (other_inputs, other_table): (&[D], u16),
) -> bool {
    let mut drivers: Vec<D> = Vec::new();
    for driver in inputs.iter().chain(other_inputs) {
        if level(*driver).is_none() && !drivers.contains(driver) {
            drivers.push(*driver);
        }
    }
    let value = |levels: usize, inputs: &[D], table: u16| {
        let of = |driver: &D| match level(*driver) {
            Some(level) => level,
            None => {
                let index = drivers.iter().position(|other| other == driver);
                index.is_some_and(|index| levels >> index & 1 == 1)
            }
        };
        let index = inputs
            .iter()
            .rev()
            .fold(0usize, |index, input| index << 1 | usize::from(of(input)));
        table >> index & 1
    };
    (0..1usize << drivers.len()).all(|levels| value(levels, inputs, table) == value(levels, other_inputs, other_table))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn same(ours: (&[char], u16), theirs: (&[char], u16)) -> bool {
        let level = |driver| match driver {
            '0' => Some(false),
            '1' => Some(true),
            _ => None,
        };
        is_same(level, ours, theirs)
    }

    #[test]
    fn order_constants_and_inputs_that_do_not_matter_make_no_difference() {
        // a and not b.
        assert!(same((&['a', 'b'], 0b0010), (&['b', 'a'], 0b0100)));
        assert!(!same((&['a', 'b'], 0b0010), (&['b', 'a'], 0b0010)));
        assert!(same((&['a', '1'], 0b1000), (&['a'], 0b10)));
        assert!(!same((&['a', '0'], 0b1000), (&['a'], 0b10)));
        assert!(same((&['a', 'b'], 0b1010), (&['a', 'c'], 0b1010)));
        assert!(same((&['a', 'a'], 0b1000), (&['a'], 0b10)));
    }
}
