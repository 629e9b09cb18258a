//! Compares the small blocks that connect others with their models in lock step.

use crate::support;

use posicast_blocks::divider::DividerConfig;
use posicast_blocks::schedule::ScheduleConfig;
use posicast_blocks::sliding_mode::Settings;
use posicast_testbench::parts::{PartBlock, SmallPart};
use support::{caught, icarus_agrees, million_random_clocks};

fn bench(part: SmallPart) -> PartBlock {
    PartBlock::new(part, "alone")
}

fn schedule() -> PartBlock {
    bench(SmallPart::Schedule(ScheduleConfig::new(37).unwrap()))
}

fn time_base() -> PartBlock {
    bench(SmallPart::TimeBase(DividerConfig::new(17).unwrap()))
}

fn sample_select() -> PartBlock {
    bench(SmallPart::SampleSelect {
        word_bits: 32,
        channels: 3,
    })
}

fn setting_banks() -> PartBlock {
    let words = std::array::from_fn(|row| 0x1234_5678u32.rotate_left(row as u32));
    bench(SmallPart::SettingBanks(Settings(words)))
}

fn agrees(block: &PartBlock) {
    million_random_clocks(block, 1, 20);
    icarus_agrees(block);
}

#[test]
fn lockstep_schedule_a_million_random_clocks() {
    agrees(&schedule());
}

#[test]
fn lockstep_divider_share_a_million_random_clocks() {
    for channels in [1, 2, 8] {
        agrees(&bench(SmallPart::DividerShare(channels)));
    }
}

#[test]
fn lockstep_group_a_million_random_clocks() {
    agrees(&bench(SmallPart::Group(2)));
    agrees(&bench(SmallPart::Group(4)));
}

#[test]
fn lockstep_time_base_a_million_random_clocks() {
    agrees(&time_base());
}

#[test]
fn lockstep_sample_select_a_million_random_clocks() {
    agrees(&sample_select());
}

#[test]
fn lockstep_setting_banks_a_million_random_clocks() {
    agrees(&setting_banks());
}

#[test]
fn lockstep_catches_a_break_in_each() {
    caught(&schedule(), "if (tick) begin", "if (tick & !waits) begin", 100_000);
    let share = bench(SmallPart::DividerShare(2));
    caught(
        &share,
        "steps_q_next = steps_of_1;",
        "steps_q_next = steps_of_0;",
        100_000,
    );
    let group = bench(SmallPart::Group(2));
    caught(&group, "& !can_start_1)", "& !can_start_0)", 100_000);
    caught(&setting_banks(), "read_row = setting_row;", "read_row = row;", 100_000);
    caught(&setting_banks(), "& !busy", "", 100_000);
}
