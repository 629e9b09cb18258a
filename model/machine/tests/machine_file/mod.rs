//! Tests of the machine file from its users' point of view.

mod absolute;
mod blocks;
mod capture;
mod compare;
mod error_table;
mod errors;
mod files;
mod hints;
mod joint_kinds;
mod key_tables;
mod limits;
mod link;
mod mechanics;
mod modes;
mod prop;
mod report;
mod rules;
mod schema;
mod steps;
mod units;
mod values;
