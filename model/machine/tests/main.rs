//! The tests of `posicast-machine` in one program, because linking takes most of the time of a small test program.
#![cfg(test)]

mod contour;
mod control;
mod convolution;
mod corners;
mod discrete_reaching;
mod drive_train;
mod family;
mod gcode;
mod golden_joint;
mod golden_kinds;
mod golden_shapers;
mod golden_xy_stage;
mod hardware;
mod machine_file;
mod matching;
mod optimal;
mod plant_in_loop;
mod prop_joint;
mod prop_shapers;
mod rate_tables;
mod segments;
mod shaper_handover;
mod sliding_mode;
mod smooth;
mod stage;
mod steps;
mod stiction;
mod supervision;
mod support;
