//! The proof of the position capture, with its memory: the properties read each of its words.

use std::fmt::Write as _;

use posicast_blocks::capture::{AXES, ENTRIES, ports};
use posicast_hdl::capture::emit;

use crate::Error;
use crate::formal::{INDUCTION, Task};

/// Line of the property file in whose place the words are.
const PLACE: &str = "    `WORDS\n";

pub(super) fn all() -> Result<Vec<Task>, Error> {
    let mut peeks = String::new();
    let mut memory = Vec::new();
    for place in (0..ENTRIES).rev() {
        let _ = writeln!(
            peeks,
            "    (* peek = \"u_memory.u_marks.words[{place}]\" *) input wire [32:0] mark_{place},"
        );
        memory.push(format!("mark_{place}"));
        for axis in (0..AXES).rev() {
            let _ = writeln!(
                peeks,
                "    (* peek = \"u_memory.u_positions_{axis}.words[{place}]\" *) input wire [31:0] position_{axis}_{place},"
            );
            memory.push(format!("position_{axis}_{place}"));
        }
    }
    let (upper, lower) = memory.split_at(memory.len() / 2);
    let macros = [("UPPER_WORDS", upper), ("LOWER_WORDS", lower)]
        .map(|(name, words)| (name, format!("{{{}}}", words.join(", "))));
    let text = include_str!("capture.sv").replace(PLACE, &peeks);
    let task = Task::new("capture", "16 entries", INDUCTION, (emit("")?, ports()));
    Ok(vec![Task {
        keeps_memories: true,
        ..task.properties(&macros, &text)
    }])
}
