//! The checks of a bitstream in words: what each compared, and what none of them covers.

use super::bare::BareReport;
use super::document::{CheckDocument, LockStepDocument};
use posicast_bitstream::behaviour::{BehaviourReport, PinDifference};
use posicast_bitstream::boards::FpgaFamily;
use posicast_bitstream::flips::FlipReport;
use posicast_bitstream::report::{CellsReport, FlipKind, TilesReport};
use posicast_bitstream::top::stage::POWER_ON_CLOCKS;
use posicast_testbench::lockstep::report::{LockstepReport, LockstepVerdict};
use posicast_testbench::wording::counted;

/// Whether the clock is reached.
pub(super) fn clock_check(highest_mhz: f64, needed_mhz: f64) -> CheckDocument {
    CheckDocument {
        name: "clock",
        ok: highest_mhz >= needed_mhz,
        what: format!("{highest_mhz:.1} MHz reached by nextpnr's timing model, {needed_mhz} MHz needed"),
    }
}

/// Whether the bits are the router's.
pub(super) fn tiles_check(tiles: &TilesReport, family: FpgaFamily) -> CheckDocument {
    let compared = match family {
        FpgaFamily::Ice40 => format!(
            "{} with {} set bits, read back from the packed file, equal to what nextpnr wrote",
            counted(tiles.tiles, "tile"),
            tiles.set
        ),
        FpgaFamily::Ecp5 => format!(
            "{} with {} switches and settings, read back from the packed file and packed again: the same file; {} without a name, in pads \
             and the clock's spines",
            counted(tiles.tiles, "tile"),
            tiles.set,
            counted(tiles.unnamed, "bit")
        ),
        FpgaFamily::Gowin => format!(
            "{} with {} switches and settings, read back from the packed file, equal to what gowin_pack made of nextpnr's result; {} of the \
             configuration of device and banks not decoded",
            counted(tiles.tiles, "tile"),
            tiles.set,
            counted(tiles.unnamed, "bit")
        ),
    };
    let differences = tiles.differences.len() as u64;
    let what = match differences {
        0 => compared,
        _ => format!(
            "{} from what nextpnr wrote, first {}",
            counted(differences, "difference"),
            tiles.differences[0]
        ),
    };
    CheckDocument {
        name: "structure, tiles",
        ok: differences == 0 && tiles.set > 0,
        what,
    }
}

/// Whether the netlist of the bits is the router's.
pub(super) fn cells_check(cells: &CellsReport) -> CheckDocument {
    let compared = format!(
        "{} look-up tables, {} flip-flops, {} carries, {}{}{} with contents, {} connections",
        cells.tables,
        cells.flip_flops,
        cells.carries,
        match cells.multiplexers {
            0 => String::new(),
            some => format!("{some} multiplexers, "),
        },
        match cells.distributed_rams {
            0 => String::new(),
            some => format!("{}, ", counted(some, "distributed RAM")),
        },
        counted(cells.memories, "block RAM"),
        cells.connections
    );
    let what = match cells.first.first() {
        None => format!("{compared}: the netlist of the bits is nextpnr's"),
        Some(first) => format!(
            "{} of {compared}; first: {first}",
            counted(cells.differences, "difference")
        ),
    };
    CheckDocument {
        name: "structure, cells",
        ok: cells.differences == 0 && cells.tables > 0,
        what,
    }
}

/// Whether the netlist of the bits does what the model does.
pub(super) fn lock_step_check(lock_step: &LockStepDocument) -> CheckDocument {
    match lock_step {
        LockStepDocument::Shapers(report) => shapers_check(report),
        LockStepDocument::Bare(report) => bare_check(report),
        LockStepDocument::Stage { power_on_clocks, rows } => stage_check(*power_on_clocks, rows),
    }
}

fn bare_check(report: &BareReport) -> CheckDocument {
    let moved = report.moves.iter().map(|one| {
        format!(
            "{} moved by {} counts, its encoder by {}",
            one.axis, one.command_counts, one.encoder_counts
        )
    });
    let moved: Vec<String> = moved.collect();
    let what = match (&report.first, &report.host_error) {
        (Some(first), _) => difference(first),
        (None, Some(error)) => format!("{} clocks equal, then the host stopped: {error}", report.clocks),
        (None, None) => format!(
            "{} clocks from power-up, {} requests of the host: both output pins in every clock equal to the model's; {}",
            report.clocks,
            report.requests,
            moved.join("; ")
        ),
    };
    CheckDocument {
        name: "behaviour",
        ok: report.holds(),
        what,
    }
}

fn difference(first: &PinDifference) -> String {
    format!(
        "clock {}, {}: {} in the bits, {} in the model",
        first.clock,
        first.port,
        u8::from(first.actual),
        u8::from(first.expected)
    )
}

fn stage_check(power_on_clocks: u64, rows: &LockstepReport) -> CheckDocument {
    let reached = rows.blocks.iter().flat_map(|row| &row.reached);
    let reached: String = reached.map(|one| format!(", {} {}", one.count, one.what)).collect();
    let covered = format!("{} clocks{reached}", rows.cycles);
    let missing = rows.not_exercised_names();
    let first = rows.blocks.iter().filter_map(|row| row.first.as_ref()).next();
    let holds = power_on_clocks == POWER_ON_CLOCKS && rows.result == LockstepVerdict::Match;
    let what = match (first, holds) {
        (_, true) => {
            format!(
                "{covered}: every pin in every clock equal to the model's; a reset of {power_on_clocks} clocks at power-up"
            )
        }
        (Some(first), _) => {
            let [expected, actual] = first.shown();
            format!(
                "clock {}, {}: {actual} in the bits, {expected} in the model",
                first.time, first.signal
            )
        }
        (None, _) if power_on_clocks != POWER_ON_CLOCKS => {
            format!("a reset of {power_on_clocks} clocks at power-up, {POWER_ON_CLOCKS} expected")
        }
        (None, _) => format!(
            "{covered}: equal, but too little was exercised; compare more with --clocks{}",
            missing.iter().map(|what| format!("; {what}")).collect::<String>()
        ),
    };
    CheckDocument {
        name: "behaviour",
        ok: holds,
        what,
    }
}

fn shapers_check(lock_step: &BehaviourReport) -> CheckDocument {
    let BehaviourReport {
        clocks,
        samples,
        frames,
        taps_exercised,
        taps,
        ..
    } = lock_step;
    let covered = format!("{clocks} clocks, {frames} commands, {samples} samples, {taps_exercised} of {taps} taps");
    let what = match &lock_step.first {
        None if lock_step.holds() => format!("{covered}: every pin in every clock equal to the model's"),
        None => format!("{covered}: equal, but too little was exercised; compare more with --clocks"),
        Some(first) => difference(first),
    };
    CheckDocument {
        name: "behaviour",
        ok: lock_step.holds(),
        what,
    }
}

/// Whether the checks find single faults.
pub(super) fn flips_check(flips: &[FlipReport]) -> CheckDocument {
    let count = |holds: &dyn Fn(&FlipReport) -> bool| flips.iter().filter(|flip| holds(flip)).count();
    let missed = count(&FlipReport::is_missed);
    let kinds = FlipKind::ALL
        .map(|kind| format!("{} {}", count(&|flip| flip.kind == kind), kind.word()))
        .join(", ");
    CheckDocument {
        name: "it can fail",
        ok: missed == 0 && !flips.is_empty(),
        what: format!(
            "{} flips in the packed file ({kinds}): {} found in the tiles; {} change the netlist, of them {} found in the cells, {} in lock \
             step{}",
            flips.len(),
            count(&|flip| flip.tiles > 0),
            count(&|flip| flip.changes_netlist),
            count(&|flip| flip.cells > 0),
            count(&|flip| flip.lock_step_clock.is_some()),
            if missed > 0 {
                format!("; {missed} missed")
            } else {
                String::new()
            }
        ),
    }
}

/// What none of the checks covers.
pub(super) fn not_covered(lock_step: &LockStepDocument, flips: &[FlipReport], family: FpgaFamily) -> Vec<String> {
    let shared = match family {
        FpgaFamily::Ice40 => {
            "an error that the databases of nextpnr and IceStorm share: nextpnr's was made from IceStorm's"
        }
        FpgaFamily::Ecp5 => "an error in Project Trellis' database: nextpnr, ecppack and the reading back use the same",
        FpgaFamily::Gowin => {
            "an error in apycula's chip database: nextpnr, gowin_pack and the reading back use the same"
        }
    };
    let mut list = vec![
        "hardware: nobody has run it yet; voltages, the oscillator and the wiring of the board are not simulated"
            .to_owned(),
        shared.to_owned(),
    ];
    match lock_step {
        LockStepDocument::Shapers(report) => {
            list.push("the tap tables that a design of your own can load: the top does not connect their ports".to_owned());
            if report.led_changes == 0 {
                list.push(
                    "the LED's flags: no shaper clamped an output or lost a sample, so lock step never lit it".to_owned(),
                );
            }
        }
        LockStepDocument::Bare(_) => list.push(
            "your machine: its stand-in has no modes, no friction, no limits and no index, and all other inputs are tied inside".to_owned(),
        ),
        LockStepDocument::Stage { .. } => list.push(
            "in lock step, what the line is too slow to reach: the cells were compared, but most of the arithmetic works on small numbers"
                .to_owned(),
        ),
    }
    if flips.iter().all(|flip| flip.kind != FlipKind::Memory) {
        list.push("flips in a memory: the bitstream has none".to_owned());
    }
    list
}
