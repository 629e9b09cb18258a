//! The stage of a machine file: that its parts fit together.

use posicast_model::control;
use posicast_model::design::design_machine;
use posicast_model::rtl::component::Component;
use posicast_model::spec;

#[test]
fn unit_the_example_makes_a_stage() {
    let machine = spec::parse("xy-stage.toml", include_str!("../../examples/xy-stage.toml")).unwrap();
    let design = design_machine(&machine).unwrap();
    let stage = control::stage(&machine, &design).unwrap().unwrap();
    let component = Component::stage(&stage.config).unwrap();
    assert_eq!(component.map().words(), 3 * 256);
    let pins = component.composition().ports().iter();
    let pins: Vec<&str> = pins.map(|port| port.name.as_str()).collect();
    for pin in ["avs_address", "irq", "emergency_stop_n", "x_a", "y_b_low"] {
        assert!(pins.contains(&pin), "{pins:?}");
    }
    let timing = stage.config.timing();
    assert!(timing.duty_clocks() < 1000, "{timing}");
}
