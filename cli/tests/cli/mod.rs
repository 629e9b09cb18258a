//! The command line from outside: exit status, standard output, standard error, files.

pub(crate) mod followed;
#[cfg(unix)]
mod no_answer;
mod sopc;
mod stage;
pub(crate) mod support;
mod verdict;
mod verify;

mod bad_input;
mod bitstream;
mod block_kit;
mod buses;
mod campaign;
mod cascade;
mod command;
mod completions;
mod contour;
mod design;
mod diff;
mod doctor;
mod error_table;
mod examples;
mod folder;
#[cfg(unix)]
mod full_disk;
mod fuzz;
mod hal;
mod hardware;
#[cfg(unix)]
mod host;
mod host_udp;
mod identify;
mod identify_logs;
mod inline;
mod kit;
#[cfg(unix)]
mod missing_tools;
mod moves;
mod new;
mod optimal;
mod outputs;
mod pages;
mod replay;
mod report;
mod schema;
mod served;
#[cfg(target_os = "linux")]
mod signals;
mod tutorial;
