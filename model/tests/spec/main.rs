//! The machine file as its users meet it.

mod blocks;
mod errors;
mod files;
mod not_built;
mod prop;
mod report;
mod rules;
mod values;
