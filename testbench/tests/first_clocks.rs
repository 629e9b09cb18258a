//! The pins of a stage in the first clocks: off at power-up without a reset, during a reset, and after it until a host switches on.

use posicast_blocks::Direction;
use posicast_blocks::stage::{Follower, StageConfig};
use posicast_hdl::emit::Module;
use posicast_testbench::blocks::{Block, Sources, library_sizes};
use posicast_testbench::crosssim::without_initial_values;
use posicast_testbench::lockstep::Device;
use posicast_testbench::stage::StageBlock;

/// Clocks before the reset, in it, and after it.
const CLOCKS: [u64; 3] = [200, 3, 400];
/// Pins that switch something on, after the axis's name.
const SWITCHES: [&str; 6] = ["a_high", "a_low", "b_high", "b_low", "drive_enable", "brake_release"];

/// The outputs that must be off, each with its level when it is: the pins that switch something on, the lines of the steps, and the
/// interrupt.
fn switches(config: &StageConfig) -> Vec<(String, u64)> {
    let mut found = vec![("irq".to_owned(), 0)];
    for axis in &config.axes {
        let named = |pin: &str| format!("{}_{pin}", axis.name);
        found.extend(SWITCHES.iter().map(|pin| (named(pin), 0)));
        if let Follower::Steps(steps) = &axis.follower {
            let low = steps.lines_active_low();
            let [a, b] = steps.mode().line_names();
            found.extend([(named(a), low.a.into()), (named(b), low.b.into())]);
        }
    }
    found
}

/// Returns the first clock in which a pin is not off, and the pin, from power-up on in a simulator with `x`. The lines change at random,
/// and the host does not write.
fn first_on(block: &StageBlock, switches: &[(String, u64)], modules: &[Module]) -> Option<(u64, String)> {
    let mut device = Sources::of_modules(modules).unwrap().icarus(block).unwrap();
    let model = block.model(0);
    let ports = |direction| model.ports().iter().filter(move |port| port.direction == direction);
    let (mut inputs, outputs) = (
        vec![0; ports(Direction::Input).count()],
        ports(Direction::Output).count(),
    );
    let (mut shown, mut unknown) = (vec![0; outputs], vec![0; outputs]);
    let pins: Vec<usize> = ports(Direction::Input)
        .enumerate()
        .filter(|(_, port)| port.name != "rst" && !port.name.starts_with("avs_"))
        .map(|(at, _)| at)
        .collect();
    let watched: Vec<(usize, &(String, u64))> = ports(Direction::Output)
        .enumerate()
        .filter_map(|(at, port)| Some((at, switches.iter().find(|(name, _)| *name == port.name)?)))
        .collect();
    let mut random = 0x9e37_79b9_7f4a_7c15_u64;
    for clock in 0..CLOCKS.iter().sum() {
        for pin in &pins {
            random = random
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            // A line changes once in some clocks.
            if random >> 60 == 0 {
                inputs[*pin] ^= 1;
            }
        }
        inputs[0] = (CLOCKS[0]..CLOCKS[0] + CLOCKS[1]).contains(&clock).into();
        Device::step(&mut device, &inputs, &mut shown, &mut unknown).unwrap();
        let mut watched = watched.iter();
        let on = watched.find(|(at, (_, off))| shown[*at] != *off || unknown[*at] != 0);
        if let Some((_, (pin, _))) = on {
            return Some((clock, pin.clone()));
        }
    }
    None
}

#[test]
fn every_pin_is_off_from_power_up_on() {
    // Four pins of the bridge, drive and brake of two axes; drive, brake and two lines of three axes with steps; as the first.
    let sizes = library_sizes().unwrap();
    let counts = [13, 13, 13];
    assert_eq!(sizes.stages.len(), counts.len());
    for (config, count) in sizes.stages.iter().zip(counts) {
        let block = StageBlock::new(config, "stage").unwrap();
        let modules = block.modules().unwrap();
        let outputs: Vec<String> = block.model(0).ports().iter().map(|port| port.name.clone()).collect();
        let mut switches = switches(config);
        switches.retain(|(name, _)| outputs.contains(name));
        assert_eq!(switches.len(), count, "{switches:?}");
        assert_eq!(first_on(&block, &switches, &modules), None);
        // Without the values at power-up, the pins are unknown until the reset.
        let unset: Vec<Module> = modules.iter().map(without_initial_values).collect();
        assert_eq!(first_on(&block, &switches, &unset).map(|(clock, _)| clock), Some(0));
    }
}
