//! The shaper's Verilog as text: its names, ports and table. Its function is tested in lockstep.

use posicast_blocks::shaper::{RING_ADDRESS_BITS, ShaperConfig, TAP_INDEX_BITS, ports};
use posicast_hdl::shaper::emit;
use posicast_taps::{Tap, TapTable};

#[allow(clippy::unwrap_used, reason = "a helper that fails fails its test")]
fn config(word_bits: u32, ring: u32, index: u32) -> ShaperConfig {
    let taps = [(0, 65537), (7, -1)].map(|(delay_samples, coefficient)| Tap {
        delay_samples,
        coefficient,
    });
    ShaperConfig::new(word_bits, TapTable::new(16, taps.to_vec()).unwrap())
        .and_then(|config| config.with_room_for((1 << ring) - 2, 1 << index))
        .unwrap()
}

#[test]
fn every_size_has_the_ports_of_its_model() {
    for word_bits in [8, 16, 24, 32] {
        for ring in RING_ADDRESS_BITS {
            for index in TAP_INDEX_BITS {
                let config = config(word_bits, ring, index);
                let modules = emit(&config, "stage_x").unwrap();
                let top = modules.last().unwrap();
                assert_eq!(top.name, "stage_x_shaper");
                assert_eq!(top.ports, ports(&config));
                assert!(top.clocked);
                assert!(modules[..modules.len() - 1].iter().all(|module| {
                    let has_table = ["machine_taps", "tap_banks"].iter().any(|table| module.is(table));
                    module
                        .name
                        .starts_with(if has_table { "stage_x_" } else { "posicast_" })
                }));
            }
        }
    }
}

#[test]
fn the_machines_table_stands_in_the_rom() {
    let modules = emit(&config(32, 6, 6), "").unwrap();
    let rom = modules.iter().find(|module| module.name == "machine_taps").unwrap();
    assert!(
        rom.text
            .contains("words[0] = 24'h010001; // 1.000015 = 65537 / 2^16 after 0 samples"),
        "{}",
        rom.text
    );
    assert!(
        rom.text
            .contains("words[1] = 24'h1fffff; // -0.000015 = -1 / 2^16 after 7 samples"),
        "{}",
        rom.text
    );
}

#[test]
fn the_same_each_time() {
    let config = config(24, 10, 8);
    assert_eq!(emit(&config, "a"), emit(&config, "a"));
}

#[test]
fn a_prefix_that_is_no_name_is_refused() {
    for prefix in ["Stage", "1st", "a b", "a__b$"] {
        assert!(emit(&config(16, 6, 6), prefix).is_err(), "{prefix}");
    }
}
