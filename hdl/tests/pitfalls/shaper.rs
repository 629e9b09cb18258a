//! The shaper's Verilog passes lint and Yosys, and gives the outputs of its model for random stimuli in Icarus,
//! Verilator and after Yosys.

use crate::pitfalls::support::Row;
use crate::pitfalls::tools;
use crate::stimulus::{Anything, Random, table};
use posicast_blocks::ClockedBlock;
use posicast_blocks::shaper::{Inputs, Shaper, ShaperConfig, ShaperMotion};

fn config(word_bits: u32, taps: usize, longest: u32) -> ShaperConfig {
    ShaperConfig::new(word_bits, table(&mut Random(5), 16, taps, longest, 2)).unwrap()
}

/// Returns a configuration with sizes that no machine file leads to.
fn of_sizes(word_bits: u32, ring: u32, index: u32) -> ShaperConfig {
    ShaperConfig::of_sizes(word_bits, ring, index, table(&mut Random(5), 9, 3, 9, 2)).unwrap()
}

fn for_motion(config: ShaperConfig, channels: u32, modulo: bool) -> ShaperConfig {
    config.for_motion(ShaperMotion { channels, modulo }).unwrap()
}

#[test]
fn long_crosssim_shaper_equals_its_model() {
    equals_its_model(&["between", "motion"]);
}

#[test]
fn long_crosssim_shaper_of_every_size_equals_its_model() {
    equals_its_model(&[]);
}

/// Compares the shapers with these names with their models; all shapers if there are no names.
fn equals_its_model(names: &[&str]) {
    let rows = [
        ("narrow", config(8, 3, 20)),
        ("small", config(17, 3, 20)),
        ("middle", config(24, 40, 200)),
        ("large", config(32, 77, 900)),
        ("between", of_sizes(20, 5, 3)),
        ("tiny", of_sizes(6, 4, 2)),
        ("motion", for_motion(config(32, 5, 11), 3, false)),
        ("narrow_motion", for_motion(config(18, 70, 5000), 1, false)),
        ("rotary", for_motion(config(24, 3, 9), 1, true)),
        ("odd_rotary", for_motion(config(21, 3, 9), 2, true)),
    ];
    let wanted = rows
        .into_iter()
        .filter(|(name, _)| names.is_empty() || names.contains(name));
    let rows = wanted.map(|(name, config)| {
        let mut model = Shaper::new(&config, 7);
        let modules = posicast_hdl::shaper::emit(&config, name);
        assert_eq!(modules.as_ref().unwrap().last().unwrap().ports, model.ports());
        let step = |inputs: Inputs| {
            let raw = inputs.to_raw(&config);
            let mut shown = vec![0; model.ports().len() - raw.len()];
            ClockedBlock::step(&mut model, &raw, &mut shown).unwrap();
            [&raw[..], &shown[..]].concat()
        };
        Row {
            name: name.to_owned(),
            modules,
            vectors: Anything::new(&config, 11).take(2000).map(step).collect(),
        }
    });
    assert_eq!(tools::replay(&rows.collect::<Vec<_>>()), Vec::<String>::new());
}

#[test]
fn shaper_comes_out_the_same_twice() {
    let config = config(32, 9, 62);
    let emitted = || posicast_hdl::shaper::emit(&config, "xy_stage_x").unwrap();
    assert_eq!(emitted(), emitted());
    assert!(emitted().iter().all(|module| !module.text.contains("__")));
}
