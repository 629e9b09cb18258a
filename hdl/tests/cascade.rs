//! The cascade in RustHDL's simulator compared with its model, and its Verilog as text.

use crate::random;

use posicast_blocks::cascade::{
    Cascade, CascadeConfig, Inputs, Outputs, RING_ADDRESS_BITS, STAGE_INDEX_BITS, pass_clocks, ports,
};
use posicast_hdl::cascade::{emit, simulate};
use random::Random;

/// Returns every size of ring and index, for narrow and wide words; the delays include the shortest and the longest
/// that the ring allows.
fn sizes() -> impl Iterator<Item = CascadeConfig> {
    let size = |word, ring: u32, index: u32| {
        let delays = (0..1 << index).map(|stage| if stage == 1 { (1 << ring) - 2 } else { 1 + stage });
        CascadeConfig::new(word, delays.collect()).unwrap()
    };
    [8, 17, 32].into_iter().flat_map(move |word| {
        RING_ADDRESS_BITS.flat_map(move |ring| STAGE_INDEX_BITS.map(move |index| size(word, ring, index)))
    })
}

/// Plays random inputs and compares every output in every clock. Most strobes follow after exactly one pass, the others
/// after a random time of up to two passes.
fn lockstep(config: &CascadeConfig, seed: u64, clocks: u32) {
    let mut model = Cascade::new(config, seed);
    let mut rusthdl = simulate(config).unwrap();
    assert_eq!(rusthdl.ports(), ports(config.word_bits() as usize));
    let mut random = Random(seed);
    let mut until_strobe = 0;
    let pass = u64::from(pass_clocks(config.stages()));
    for clock in 0..clocks {
        let strobe = until_strobe == 0;
        until_strobe = match (strobe, random.below(4)) {
            (false, _) => until_strobe - 1,
            (true, 0) => random.below(2 * pass),
            (true, _) => pass - 1,
        };
        let inputs = Inputs {
            rst: random.once_in(1000),
            strobe,
            start: random.once_in(200),
            x: match random.below(3) {
                0 => config.word_max(),
                1 => config.word_min(),
                _ => random.word() as i64,
            },
            clear_flags: random.once_in(20),
        };
        let mut shown = [0; 4];
        rusthdl
            .step(&inputs.to_raw(config.word_bits() as usize), &mut shown)
            .unwrap();
        let actual = Outputs::from_raw(&shown, config.word_bits() as usize);
        assert_eq!(actual, model.step(&inputs), "clock {clock}, {inputs:?}, {config:?}");
    }
}

#[test]
fn lockstep_every_size_that_is_listed() {
    for (seed, config) in sizes().enumerate() {
        lockstep(&config, seed as u64, 250);
    }
}

#[test]
fn every_size_has_the_ports_of_its_model() {
    for config in sizes() {
        let modules = emit(&config, "stage_x").unwrap();
        let top = modules.last().unwrap();
        assert_eq!(top.name, "stage_x_cascade");
        assert_eq!(top.ports, ports(config.word_bits() as usize));
        assert!(
            top.clocked
                && modules
                    .iter()
                    .all(|module| module.name.starts_with("stage_x_") || module.name.starts_with("posicast_"))
        );
    }
}

#[test]
fn the_delays_stand_in_the_rom() {
    let modules = emit(&CascadeConfig::new(32, vec![5, 33]).unwrap(), "").unwrap();
    let rom = modules.iter().find(|module| module.name == "stage_delays").unwrap();
    assert!(rom.text.contains("words[1] = 6'h21; // 33 samples"), "{}", rom.text);
}
