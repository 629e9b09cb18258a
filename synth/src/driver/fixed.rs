//! The part of the driver that is the same for every machine: C sources in `c/`, copied as they are.

use super::{DriverFile, file};

/// Path below the driver's folder, and text.
type Fixed = (&'static str, &'static str);

/// Files for every stage.
const CORE: [Fixed; 23] = [
    ("inc/posicast_io.h", include_str!("c/inc/posicast_io.h")),
    ("inc/posicast_machine.h", include_str!("c/inc/posicast_machine.h")),
    ("inc/posicast_plan.h", include_str!("c/inc/posicast_plan.h")),
    ("inc/posicast_result.h", include_str!("c/inc/posicast_result.h")),
    ("inc/posicast_segments.h", include_str!("c/inc/posicast_segments.h")),
    ("inc/posicast_driver.h", include_str!("c/inc/posicast_driver.h")),
    ("inc/posicast_homing.h", include_str!("c/inc/posicast_homing.h")),
    ("inc/posicast_settings.h", include_str!("c/inc/posicast_settings.h")),
    ("inc/posicast_stream.h", include_str!("c/inc/posicast_stream.h")),
    ("src/posicast_plan.c", include_str!("c/src/posicast_plan.c")),
    ("src/posicast_segments.c", include_str!("c/src/posicast_segments.c")),
    ("src/posicast_driver.c", include_str!("c/src/posicast_driver.c")),
    ("src/posicast_homing.c", include_str!("c/src/posicast_homing.c")),
    ("src/posicast_settings.c", include_str!("c/src/posicast_settings.c")),
    ("src/posicast_stream.c", include_str!("c/src/posicast_stream.c")),
    ("src/posicast_tables.c", include_str!("c/src/posicast_tables.c")),
    ("src/posicast_wait.c", include_str!("c/src/posicast_wait.c")),
    ("src/posicast_wait.h", include_str!("c/src/posicast_wait.h")),
    (
        "HAL/inc/posicast_stage_hal.h",
        include_str!("c/HAL/inc/posicast_stage_hal.h"),
    ),
    (
        "HAL/src/posicast_stage_hal.c",
        include_str!("c/HAL/src/posicast_stage_hal.c"),
    ),
    ("linux/posicast_uio.h", include_str!("c/linux/posicast_uio.h")),
    ("linux/posicast_uio.c", include_str!("c/linux/posicast_uio.c")),
    ("linux/Makefile", include_str!("c/linux/Makefile")),
];

/// Files for stages whose axes have the bring-up registers.
const BRING_UP: [Fixed; 2] = [
    ("inc/posicast_bring_up.h", include_str!("c/inc/posicast_bring_up.h")),
    ("src/posicast_bring_up.c", include_str!("c/src/posicast_bring_up.c")),
];

/// Files for stages with an error table of an axis.
const ERROR_TABLE: [Fixed; 2] = [
    (
        "inc/posicast_error_table.h",
        include_str!("c/inc/posicast_error_table.h"),
    ),
    (
        "src/posicast_error_table.c",
        include_str!("c/src/posicast_error_table.c"),
    ),
];

/// Files for stages with an axis whose modes move.
const FAMILY: [Fixed; 2] = [
    ("inc/posicast_family.h", include_str!("c/inc/posicast_family.h")),
    ("src/posicast_family.c", include_str!("c/src/posicast_family.c")),
];

/// Files for stages with an axis whose missing steps are corrected.
const CORRECTION: [Fixed; 2] = [
    ("inc/posicast_correction.h", include_str!("c/inc/posicast_correction.h")),
    ("src/posicast_correction.c", include_str!("c/src/posicast_correction.c")),
];

/// Files for stages with an axis that has a position compare.
const COMPARE: [Fixed; 2] = [
    ("inc/posicast_compare.h", include_str!("c/inc/posicast_compare.h")),
    ("src/posicast_compare.c", include_str!("c/src/posicast_compare.c")),
];

/// Files for stages with a position capture.
const CAPTURE: [Fixed; 2] = [
    ("inc/posicast_capture.h", include_str!("c/inc/posicast_capture.h")),
    ("src/posicast_capture.c", include_str!("c/src/posicast_capture.c")),
];

/// Features of a stage that need additional files.
#[derive(Debug, Clone, Copy)]
pub(super) struct With {
    pub(super) bring_up: bool,
    pub(super) error_table: bool,
    pub(super) correction: bool,
    pub(super) family: bool,
    pub(super) compare: bool,
    pub(super) capture: bool,
}

pub(super) fn files(with: With) -> Vec<DriverFile> {
    let parts = [
        (&BRING_UP, with.bring_up),
        (&ERROR_TABLE, with.error_table),
        (&CORRECTION, with.correction),
        (&FAMILY, with.family),
        (&COMPARE, with.compare),
        (&CAPTURE, with.capture),
    ];
    let built = parts.into_iter().filter(|(_, is_built)| *is_built);
    CORE.iter()
        .chain(built.flat_map(|(files, _)| files))
        .map(|(path, text)| file(path, (*text).to_owned()))
        .collect()
}
