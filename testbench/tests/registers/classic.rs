//! Runs the six classic register tests on bank and components, model and Verilog; each must detect a faulty bank.

use crate::registers::components::{pulse_counter, pwm, shaper, sliding_mode};
use crate::registers::everything::everything;
use crate::registers::support::Bench;
use posicast_blocks::ClockedBlock;
use posicast_blocks::component::Component;
use posicast_blocks::registers::{RegisterBank, RegisterMap};
use posicast_hdl::component::emit;
use posicast_testbench::register_tests::{Host, RegisterHardware, TESTS};

/// Returns the names of the tests that fail.
fn failing(map: &RegisterMap, block: &mut dyn ClockedBlock, hardware: RegisterHardware) -> Vec<String> {
    let mut failing = Vec::new();
    for (name, test) in TESTS {
        let mut host = Host::new(map, block, hardware).unwrap();
        if let Err(what) = test(&mut host) {
            failing.push(format!("{name}: {what}"));
        }
    }
    failing
}

fn bank(from: &str, to: &str) -> Vec<String> {
    let map = everything();
    let modules = vec![posicast_hdl::registers::emit(&map, "").unwrap()];
    let bench = Bench::new("registers", &modules, from, to);
    failing(&map, &mut bench.verilated(), RegisterHardware::Still)
}

fn component(component: &Component) {
    assert_eq!(
        failing(component.map(), &mut component.model(1), RegisterHardware::Running),
        [""; 0]
    );
    let bench = Bench::new(component.name(), &emit(component, "alone", "alone").unwrap(), "", "");
    assert_eq!(
        failing(component.map(), &mut bench.verilated(), RegisterHardware::Running),
        [""; 0]
    );
}

#[test]
fn the_model_of_a_bank_keeps_its_promises() {
    let map = everything();
    let mut model = RegisterBank::new(&map);
    assert_eq!(failing(&map, &mut model, RegisterHardware::Still), [""; 0]);
}

#[test]
fn lockstep_the_verilog_of_a_bank_keeps_its_promises() {
    assert_eq!(bank("", ""), [""; 0]);
}

#[test]
fn lockstep_the_pulse_counter_keeps_its_promises() {
    component(&pulse_counter());
}

#[test]
fn lockstep_the_sliding_mode_keeps_its_promises() {
    component(&sliding_mode());
}

#[test]
fn lockstep_the_pwm_keeps_its_promises() {
    component(&pwm());
}

#[test]
fn lockstep_the_shaper_keeps_its_promises() {
    component(&shaper(16, None));
}

fn finds(test: &str, from: &str, to: &str) {
    let found = bank(from, to);
    assert!(found.iter().any(|found| found.starts_with(test)), "{found:?}");
}

#[test]
fn lockstep_a_wrong_reset_value_is_found() {
    finds("reset values", "wide <= 13'd4660", "wide <= 13'd4661");
}

#[test]
fn lockstep_a_decode_that_ignores_a_bit_is_found() {
    finds(
        "aliasing",
        "avs_write && avs_address == MODE",
        "avs_write && avs_address[6:0] == MODE[6:0]",
    );
}

#[test]
fn lockstep_a_byte_that_goes_with_its_neighbour_is_found() {
    finds(
        "byte enables",
        "if (write_mode && avs_byteenable[1])",
        "if (write_mode && avs_byteenable[0])",
    );
}
