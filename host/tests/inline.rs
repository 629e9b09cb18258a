//! An inline shaper of a machine file at the other end: its state, the request for no shaping and its tables, on the model with a
//! controller at its pins.

use std::time::Duration;

use crate::faults::Line;
use crate::stage::Constants;
use posicast_blocks::component::Component;
use posicast_blocks::linked_stage::address_limit;
use posicast_closed_loop::inline_bench::InlineBench;
use posicast_closed_loop::linked_bench::{LinkedBench, Registered};
use posicast_host::{HostError, HostedInline, Link, LinkOptions, Shake, TraceRequest};
use posicast_machine::hardware::Hardware;
use posicast_machine::machine_file::{self, Machine};
use posicast_machine::plan::design_machine;
use posicast_taps::{Tap, TapTable};

const OPTIONS: LinkOptions = LinkOptions {
    timeout: Duration::from_millis(20),
    attempts: 2,
};

fn machine() -> Machine {
    let text = include_str!("../../examples/inline.toml");
    machine_file::parse("inline.toml", &format!("{text}[link]\nbaud = 3_000_000\n")).unwrap()
}

fn component(machine: &Machine) -> Component {
    let design = design_machine(machine).unwrap();
    let hardware = Hardware::of(machine, &design).unwrap();
    hardware.inline().unwrap().unwrap().component.clone().unwrap()
}

fn open<'m>(machine: &'m Machine, component: &'m Component) -> HostedInline<'m, LinkedBench<InlineBench>> {
    let mut bench = InlineBench::new(component, 1).unwrap();
    // The axes settle.
    bench.clocks(3_000_000).unwrap();
    let line = LinkedBench::new(bench, &machine.link.unwrap(), &machine.clock, address_limit(component));
    HostedInline::open(Link::new(line, OPTIONS), machine, component).unwrap()
}

#[test]
fn the_state_has_the_counts_of_every_axis() {
    let machine = machine();
    let component = component(&machine);
    let mut line = open(&machine, &component).into_link().into_line();
    line.bench.steps("x", 300).unwrap();
    line.bench.steps("z", -40).unwrap();
    line.bench.clocks(500_000).unwrap();
    let mut host = HostedInline::open(Link::new(line, OPTIONS), &machine, &component).unwrap();
    let moves = host.status().unwrap();
    assert!(
        moves.run && !moves.settled && !moves.bypassed && !moves.fault,
        "{moves:?}"
    );
    let x = &moves.axes[0];
    assert!(
        x.follows && !x.settled && x.causes.is_empty() && x.table_bank == 0,
        "{x:?}"
    );
    // The shaped steps are behind the command.
    assert!(x.input_steps > x.given_steps && x.given_steps > 0, "{x:?}");
    let mut line = host.into_link().into_line();
    line.bench.clocks(4_000_000).unwrap();
    let mut host = HostedInline::open(Link::new(line, OPTIONS), &machine, &component).unwrap();
    let rests = host.status().unwrap();
    assert!(rests.settled, "{rests:?}");
    let counts: Vec<_> = rests
        .axes
        .iter()
        .map(|axis| (axis.input_steps, axis.given_steps, axis.owed_steps))
        .collect();
    assert_eq!(counts, [(300, 300, 0), (0, 0, 0), (-40, -40, 0)]);
}

#[test]
fn the_shaping_ends_on_request_and_begins_again_unless_the_pin_holds_it() {
    let machine = machine();
    let component = component(&machine);
    let mut host = open(&machine, &component);
    host.bypass(true).unwrap();
    let status = host.status().unwrap();
    assert!(status.bypassed && status.bypass_requested);
    host.bypass(false).unwrap();
    assert!(!host.status().unwrap().bypassed);

    let mut line = host.into_link().into_line();
    line.bench.set("bypass", 1).unwrap();
    line.bench.clocks(20_000).unwrap();
    let mut host = HostedInline::open(Link::new(line, OPTIONS), &machine, &component).unwrap();
    let refused = host.bypass(false).unwrap_err();
    assert!(
        matches!(refused, HostError::Bypass { wanted: "begin", .. }),
        "{refused}"
    );
    assert!(refused.to_string().contains("set the pin `bypass` low"), "{refused}");
}

/// The example with a trace memory on axis x.
fn traced() -> Machine {
    let text = include_str!("../../examples/inline.toml");
    let (first, rest) = text.split_once("[[axis]]").unwrap();
    let (x, others) = rest.split_once("[[axis]]").unwrap();
    let text = format!("{first}[[axis]]{x}[axis.trace]\nsamples = 1024\n[[axis]]{others}[link]\nbaud = 3_000_000\n");
    machine_file::parse("inline.toml", &text).unwrap()
}

#[test]
fn a_trace_shows_the_position_before_and_after_the_shaper_tick_by_tick() {
    let machine = traced();
    let component = component(&machine);
    let mut line = open(&machine, &component).into_link().into_line();
    line.bench.steps("x", 40).unwrap();
    let mut host = HostedInline::open(Link::new(line, OPTIONS), &machine, &component).unwrap();
    let request = TraceRequest {
        axis: 0,
        signals: ["input_position", "output_position"].map(str::to_owned).to_vec(),
        every_ticks: 1,
        shake: None,
    };
    let trace = host.trace(&request).unwrap();
    assert_eq!((trace.rows(), trace.signals[0].unit.as_str()), (512, "steps"));
    let rows: Vec<[f64; 2]> = trace.values().map(|row| [row[0], row[1]]).collect();
    let last = rows[511];
    assert_eq!(last, [40.0, 40.0]);
    let table = &design_machine(&machine).unwrap().axes[0].table;
    // The output is the input through the taps, from the row on that knows all of its past.
    let longest = table.longest_delay_samples() as usize;
    let one = f64::from(1_u32 << table.coefficient_fraction());
    for at in longest + 1..rows.len() {
        let delayed = |tap: &Tap| f64::from(tap.coefficient) / one * rows[at - tap.delay_samples as usize][0];
        let expected: f64 = table.taps().iter().map(delayed).sum();
        let off = (rows[at][1] - expected).abs();
        assert!(off <= 2.0 / 256.0, "row {at}: {:?} instead of {expected}", rows[at]);
    }
    assert!(rows.iter().any(|[input, output]| input != output));

    let shaken = TraceRequest {
        shake: Some(Shake {
            amplitude_counts: 3.0,
            bit_ticks: 10,
        }),
        ..request
    };
    let refused = host.trace(&shaken).unwrap_err();
    assert!(refused.to_string().contains("no test signal"), "{refused}");
}

#[test]
fn an_axis_that_moves_does_not_lose_its_shaping() {
    let machine = machine();
    let component = component(&machine);
    let mut line = open(&machine, &component).into_link().into_line();
    line.bench.steps("y", 100_000).unwrap();
    line.bench.clocks(100_000).unwrap();
    let mut host = HostedInline::open(Link::new(line, OPTIONS), &machine, &component).unwrap();
    let refused = host.bypass(true).unwrap_err();
    assert!(refused.to_string().contains("let the controller stand"), "{refused}");
    let status = host.status().unwrap();
    assert!(
        !status.bypassed && status.bypass_requested && !status.fault,
        "{status:?}"
    );
}

#[test]
fn a_table_is_loaded_read_back_and_used_and_loses_no_step() {
    let machine = machine();
    let component = component(&machine);
    let mut host = open(&machine, &component);
    let of_machine = host.read_table(0, 0).unwrap();
    let sum: i32 = of_machine.iter().map(|tap| tap.coefficient).sum();
    assert_eq!(sum, 1 << 16, "{of_machine:?}");
    assert!(host.read_table(0, 2).unwrap().is_empty());

    let tap = |delay_samples, coefficient| Tap {
        delay_samples,
        coefficient,
    };
    let half = TapTable::new(16, vec![tap(0, 1 << 15), tap(60, 1 << 15)]).unwrap();
    assert_eq!(host.load_table(0, &half).unwrap(), 1);
    assert_eq!(host.read_table(0, 1).unwrap(), half.taps());
    let mut line = host.into_link().into_line();
    line.bench.steps("x", 500).unwrap();
    line.bench.clocks(400_000).unwrap();
    let mut host = HostedInline::open(Link::new(line, OPTIONS), &machine, &component).unwrap();
    // In motion, too.
    assert_eq!(host.load_table(0, &TapTable::bypass(16).unwrap()).unwrap(), 2);
    let mut line = host.into_link().into_line();
    line.bench.clocks(4_000_000).unwrap();
    let mut host = HostedInline::open(Link::new(line, OPTIONS), &machine, &component).unwrap();
    let status = host.status().unwrap();
    assert!(status.settled && !status.fault, "{status:?}");
    assert_eq!((status.axes[0].input_steps, status.axes[0].given_steps), (500, 500));
    assert_eq!(status.axes[0].table_bank, 2);
    let refused = host
        .load_table(0, &TapTable::bypass(14).unwrap())
        .unwrap_err()
        .to_string();
    assert!(refused.contains("`coefficient_fraction = 16`"), "{refused}");
}

#[test]
fn another_inline_shaper_and_a_stage_are_refused() {
    let machine = machine();
    let component = component(&machine);
    let constants = Constants::of(&component);
    let opened = |place: usize, word: u32| {
        let mut words = constants.clone();
        words[place] = word;
        let line = Line::new(Constants(words), 1024, 0);
        HostedInline::open(Link::new(line, OPTIONS), &machine, &component).map(drop)
    };
    assert!(opened(0, constants[0]).is_ok());
    let crc = machine.link.unwrap().machine_crc;
    for (place, word, expected) in [
        (
            0,
            u32::from_le_bytes(*b"STGE"),
            "word 0 reads 0x45475453, but an inline shaper has 0x4e4c4e49 (INLN)".to_owned(),
        ),
        (1, 0x2_0000, "the hardware has version 2.0 of the registers".to_owned()),
        (
            2,
            2,
            "AXES of the hardware is 2, but the machine file gives 3".to_owned(),
        ),
        (4, 0xabcd, format!("checksum 0000abcd, and this one has {crc:08x}")),
    ] {
        let refused = opened(place, word).unwrap_err().to_string();
        assert!(refused.contains(&expected), "{refused}");
    }
}
