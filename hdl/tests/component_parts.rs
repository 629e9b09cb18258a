//! The small blocks of components in RustHDL's simulator compared with their models, and compositions that are
//! refused.

use crate::random;

use posicast_blocks::composition::{Composition, Part};
use posicast_blocks::divider::DividerConfig;
use posicast_blocks::divider_share::DividerShare;
use posicast_blocks::group::Group;
use posicast_blocks::sample_select::SampleSelect;
use posicast_blocks::schedule::{Schedule, ScheduleConfig};
use posicast_blocks::setting_banks::SettingBanks;
use posicast_blocks::sliding_mode::Settings;
use posicast_blocks::time_base::TimeBase;
use posicast_blocks::{ClockedBlock, Direction};
use posicast_hdl::emit::{EmitCause, Header, connect};
use posicast_hdl::{divider, divider_share, group, sample_select, schedule, setting_banks, time_base};
use random::Random;

/// Compares all outputs in every clock, with the same random inputs and an occasional reset.
fn lockstep(model: &mut dyn ClockedBlock, rusthdl: &mut dyn ClockedBlock, clocks: u32) {
    let widths = |direction| -> Vec<u32> {
        let ports = model.ports().iter().filter(|port| port.direction == direction);
        ports.map(|port| port.width).collect()
    };
    let (inputs, outputs) = (widths(Direction::Input), widths(Direction::Output).len());
    let mut random = Random(7);
    let (mut expected, mut actual) = (vec![0; outputs], vec![0; outputs]);
    for clock in 0..clocks {
        let mut row: Vec<u64> = inputs
            .iter()
            .map(|width| random.word() & (u64::MAX >> (64 - width)))
            .collect();
        row[0] = random.once_in(500).into();
        model.step(&row, &mut expected).unwrap();
        rusthdl.step(&row, &mut actual).unwrap();
        assert_eq!(actual, expected, "clock {clock}, {row:?}");
    }
}

#[test]
fn lockstep_time_base() {
    for tick_clocks in [1, 2, 97] {
        let config = DividerConfig::new(tick_clocks).unwrap();
        let mut rusthdl = time_base::simulate(&config).unwrap();
        lockstep(&mut TimeBase::new(&config), rusthdl.as_mut(), 3000);
    }
}

#[test]
fn lockstep_sample_select() {
    for (word_bits, channels) in [(16, 1), (24, 2), (26, 3), (32, 3), (32, 5)] {
        let mut rusthdl = sample_select::simulate(word_bits, channels).unwrap();
        lockstep(&mut SampleSelect::new(word_bits, channels), rusthdl.as_mut(), 1000);
    }
}

#[test]
fn lockstep_setting_banks() {
    let mut settings = Settings::default();
    settings.set_limit(12345);
    let mut rusthdl = setting_banks::simulate(&settings).unwrap();
    lockstep(&mut SettingBanks::new(&settings), rusthdl.as_mut(), 10_000);
}

#[test]
fn lockstep_schedule() {
    for clocks in [2, 3, 60] {
        let config = ScheduleConfig::new(clocks).unwrap();
        let mut rusthdl = schedule::simulate(&config).unwrap();
        lockstep(&mut Schedule::new(&config), rusthdl.as_mut(), 3000);
    }
}

#[test]
fn lockstep_divider_share() {
    for channels in [1, 2, 4, 8] {
        let mut rusthdl = divider_share::simulate(channels).unwrap();
        lockstep(&mut DividerShare::new(channels), rusthdl.as_mut(), 3000);
    }
}

#[test]
fn lockstep_group() {
    for axes in 1..=4 {
        let mut rusthdl = group::simulate(axes).unwrap();
        lockstep(&mut Group::new(axes), rusthdl.as_mut(), 3000);
    }
}

#[test]
fn a_module_that_is_not_the_part_is_refused() {
    let config = DividerConfig::new(5000).unwrap();
    let part = Part::new("divider", &posicast_blocks::divider::ports());
    let inputs = ["rst", "start", "steps", "elapsed", "clear_flags"];
    let composition = Composition::new(vec![part], &inputs, &["quotient"]).unwrap();
    let top = |name: &str, modules: &[&posicast_hdl::emit::Module]| {
        let composed = connect(name, &Header::default(), &composition, modules);
        composed.map_err(|error| *error.cause)
    };
    let divider = divider::emit(&config, "a").unwrap();
    let other = time_base::emit(&config, "a").unwrap();
    assert!(top("whole", &[&divider[0]]).is_ok());
    assert_eq!(
        top("whole", &[&other[0]]),
        Err(EmitCause::PartPorts("divider".to_owned()))
    );
    assert_eq!(top("whole", &[]), Err(EmitCause::PartPorts("divider".to_owned())));
    assert!(matches!(
        top("steps", &[&divider[0]]),
        Err(EmitCause::NameCollision { .. })
    ));
    assert!(matches!(top("module", &[&divider[0]]), Err(EmitCause::ReservedWord(_))));
}
