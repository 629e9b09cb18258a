//! Tests of the machine file from its users' point of view.

mod blocks;
mod errors;
mod files;
mod hints;
mod limits;
mod mechanics;
mod modes;
mod not_built;
mod prop;
mod report;
mod rules;
mod schema;
mod units;
mod values;
