//! A program without an operating system, which makes the first moves of the machine, and its build files for a
//! RISC-V.

use super::{DriverFile, StageDriver, file};
use crate::sopc::STAGE_BASE;

/// Path below the driver's folder, and text into which the machine's data are inserted.
const FILES: [(&str, &str); 5] = [
    ("bare_metal/main.c", include_str!("c/bare_metal/main.c")),
    ("bare_metal/Makefile", include_str!("c/bare_metal/Makefile")),
    ("bare_metal/memory.c", include_str!("c/bare_metal/memory.c")),
    ("bare_metal/start.S", include_str!("c/bare_metal/start.S")),
    ("bare_metal/link.ld", include_str!("c/bare_metal/link.ld")),
];

/// Folder of the program, which the HAL does not compile.
pub(super) const FOLDER: &str = "bare_metal/";

pub(super) fn files(driver: &StageDriver<'_>) -> Vec<DriverFile> {
    let fill = |text: &str| {
        text.replace("@MACHINE@", driver.machine)
            .replace("@AXES@", &driver.config.axes.len().to_string())
            .replace("@STAGE_BASE@", &format!("0x{STAGE_BASE:08x}"))
    };
    FILES.iter().map(|(path, text)| file(path, fill(text))).collect()
}
