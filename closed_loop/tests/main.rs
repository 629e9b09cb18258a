//! The tests of `posicast-closed-loop` in one program, because linking takes most of the time of a small test program.
#![cfg(test)]

mod absolute;
mod error_table_loop;
mod fault_campaign;
mod inline;
mod inline_run;
mod latency;
mod moving_modes;
mod stage;
mod stage_bring_up;
mod stage_guards;
mod stage_hold;
mod stage_range;
mod stage_run;
mod stage_steps;
mod support;
mod wrong_sign;
