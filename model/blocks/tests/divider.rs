//! The divider clock by clock, compared with one call per division.

use posicast_blocks::divider::{DIVISION_CLOCKS, Divider, DividerConfig, Inputs};
use proptest::prelude::*;

proptest! {
    #[test]
    fn prop_divisions_and_clocks_agree(
        tick_clocks in 1u64..1 << 17,
        divisions in proptest::collection::vec((any::<i32>(), any::<u32>(), 0u32..24, 0u32..9), 1..60),
    ) {
        let config = DividerConfig::new(tick_clocks).unwrap();
        let mut divider = Divider::new(&config);
        for (steps, elapsed, shorter, pause) in divisions {
            let (steps, elapsed) = (steps >> shorter, (elapsed & 0xff_ffff) >> shorter);
            divider.step(&Inputs { start: true, steps, elapsed, ..Inputs::default() });
            for _ in 1..DIVISION_CLOCKS {
                prop_assert!(!divider.step(&Inputs::default()).done);
            }
            let shown = divider.outputs();
            prop_assert!(shown.done && !shown.busy && !shown.overrun);
            prop_assert_eq!((shown.quotient, shown.saturated), config.divide(steps, elapsed));
            (0..pause).for_each(|_| { divider.step(&Inputs::default()); });
        }
    }
}
