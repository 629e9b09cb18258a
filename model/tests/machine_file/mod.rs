//! The machine file as its users meet it.

mod blocks;
mod error_table;
mod errors;
mod files;
mod hints;
mod joint_kinds;
mod limits;
mod mechanics;
mod modes;
mod prop;
mod report;
mod rules;
mod schema;
mod units;
mod values;
