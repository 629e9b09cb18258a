//! An arm whose mode depends on its position, in the closed loop; it gives the figures of `docs/moving-modes.md`.

use posicast_closed_loop::stage_run::{Moved, Shaping, StageRun};
use posicast_machine::machine_file::Machine;
use posicast_machine::motion::AxisMove;
use posicast_machine::plan::{TableFamily, design_machine};

use crate::support::{machine, stage};

const ARM: &str = include_str!("../../examples/telescope-arm.toml");
/// In m.
const DISTANCE: f64 = 0.3;

fn run(machine: &Machine) -> StageRun<'_> {
    let of = AxisMove {
        distance: DISTANCE,
        ..AxisMove::of_axis(&machine.axes[0], &machine.fixed_point)
    };
    StageRun::with_moves(machine, &stage(machine).config, 1, &[of]).unwrap()
}

fn ringing_um(moved: &Moved) -> f64 {
    assert_eq!(moved.trouble, None);
    1e6 * moved.axes[0].residual.peak
}

/// With handovers during the move, the load rings within the design's bound of the handovers; with only the ROM's
/// table it rings as with a frequency that is wrong by a quarter.
#[test]
fn long_lockstep_tables_are_handed_over_while_the_mode_moves() {
    let machine = machine(ARM);
    let family: TableFamily = design_machine(&machine).unwrap().families.remove(0);
    let own = run(&machine);
    let shaped = own.moved(Shaping::Shaped, 1.0).unwrap();
    let expected = &own.expected(Shaping::Shaped, 1.0).unwrap()[0];
    let one_table = own.clone().with_one_table().moved(Shaping::Shaped, 1.0).unwrap();
    let unshaped = own.moved(Shaping::Unshaped, 1.0).unwrap();
    let figures = [&shaped, &one_table, &unshaped].map(ringing_um);
    println!(
        "{figures:?} um, {} hand-overs, at most {}",
        shaped.handovers,
        1e6 * expected.handover
    );
    let last = family.choose(0, DISTANCE) as u64;
    assert_eq!(
        (shaped.handovers, one_table.handovers, unshaped.handovers),
        (last, 0, 0)
    );
    let [handed_over, kept, bare] = figures;
    assert!(handed_over <= 1e6 * expected.ringing_allowed(), "{figures:?}");
    assert!(3.0 * handed_over < kept && kept < bare, "{figures:?}");
}
