//! The stage of a machine file: its parts fit together.

use posicast_blocks::component::Component;
use posicast_blocks::stage::StageConfig;
use posicast_machine::hardware;
use posicast_machine::machine_file;
use posicast_machine::plan::design_machine;

/// Returns the example's stage, with these tables on its X axis.
fn stage(tables: &str) -> (StageConfig, Component) {
    let text = include_str!("../../../examples/xy-stage.toml");
    let text = text.replacen("[axis.pwm]", &format!("{tables}\n[axis.pwm]"), 1);
    let machine = machine_file::parse("xy-stage.toml", &text).unwrap();
    let design = design_machine(&machine).unwrap();
    let config = hardware::stage(&machine, &design).unwrap().unwrap().config;
    let component = Component::stage(&config).unwrap();
    (config, component)
}

#[test]
fn scale_and_trace_are_on_the_axis_that_has_them() {
    let scale = |usage| format!("[axis.scale]\ncounts_per_unit = 4_000_000\nuse = \"{usage}\"");
    let trace = "[axis.trace]\nsamples = 256\n".to_owned();
    for tables in [
        scale("monitor"),
        scale("position"),
        trace.clone(),
        trace + &scale("position"),
    ] {
        let (_, component) = stage(&tables);
        let register = |name: &str| component.map().register(name).is_some();
        assert_eq!(register("x_deviation"), tables.contains("scale"));
        assert_eq!(register("x_trace_data"), tables.contains("trace"));
        assert!(!register("y_deviation") && !register("y_trace_data"));
        let pins = component.composition().ports();
        assert_eq!(pins.iter().any(|pin| pin.name == "x_scale_a"), tables.contains("scale"));
    }
}

#[test]
fn the_example_makes_a_stage() {
    let (config, component) = stage("");
    assert_eq!(component.map().words(), 3 * 256);
    let pins = component.composition().ports().iter();
    let pins: Vec<&str> = pins.map(|port| port.name.as_str()).collect();
    for pin in ["avs_address", "irq", "emergency_stop_n", "x_a", "y_b_low"] {
        assert!(pins.contains(&pin), "{pins:?}");
    }
    let timing = config.timing();
    assert!(timing.duty_clocks() < 1000, "{timing}");
}
