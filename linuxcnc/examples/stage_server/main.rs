//! A simulated stage for LinuxCNC: the bit-exact model with the machine at its pins, behind a Unix socket.
//!
//! ```text
//! stage_server MACHINE FOLDER [--verilator]
//!   FOLDER/stage      registers: loadrt posicast stage=unix:FOLDER/stage
//!   FOLDER/control    commands, a line each, with one line of JSON in return
//! ```
//!
//! Time passes only while LinuxCNC asks for it, a servo period at a time; so both are in step, however long either takes. If LinuxCNC is
//! silent for a second, the machine runs on by itself: that is what a stopped servo thread looks like to it.
//!
//! | command | what it does |
//! |---|---|
//! | `set LINE LEVEL` | drives an input, such as `emergency_stop_n` |
//! | `stick AXIS`, `mend AXIS` | line A of an encoder stays where it is; follows the axis again |
//! | `jam AXIS`, `free AXIS` | the motor of an axis stands, whatever it is commanded; moves again |
//! | `drift PPM` | the stage's clock is faster by so much |
//! | `record`, `path NAME PROGRAM` | records; compares the load with the program's path and keeps the error for the picture |
//! | `picture FILE` | draws the errors |
//! | `drop` | closes the link, and lets the machine run for half a second |
//! | `state` | states, causes, outputs and positions of the axes |

mod link;
mod path;
mod server;

use posicast_machine::hardware;
use posicast_machine::machine_file;
use posicast_machine::plan::design_machine;
use server::Server;
use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (file, folder, with_rtl) = match arguments.as_slice() {
        [file, folder] => (file, folder, false),
        [file, folder, option] if option == "--verilator" => (file, folder, true),
        _ => return Err("usage: stage_server MACHINE FOLDER [--verilator]".into()),
    };
    let machine = machine_file::parse(file, &std::fs::read_to_string(file)?)?;
    let stage = hardware::stage(&machine, &design_machine(&machine)?)?.ok_or("the machine has no stage")?;
    Server::new(&machine, &stage, with_rtl)?.serve(Path::new(folder))
}
