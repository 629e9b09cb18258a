//! Files by which a system finds the driver: `_sw.tcl` and macros for the HAL, and the overlay of a device tree.

use super::{DriverFile, FOLDER, StageDriver, bare_metal, file};
use posicast_blocks::registers::RegisterMap;

/// Name in device trees without the version of the register map, as in the component for Platform Designer.
const COMPATIBLE: &str = "posicast,stage";

/// Version of the register map, for example `1.0`, as Platform Designer compares it between driver and hardware.
fn version(map: &RegisterMap) -> String {
    let part = |name: &str| {
        let fields = map.register("version").map_or(&[][..], |register| &register.fields);
        fields
            .iter()
            .find(|field| field.name == name)
            .map_or(0, |field| field.reset)
    };
    format!("{}.{}", part("major"), part("minor"))
}

/// Writes the files. `others` is the rest of the driver, which a system compiles.
pub(super) fn files(driver: &StageDriver<'_>, others: &[DriverFile]) -> Vec<DriverFile> {
    let top = driver.top;
    let hal = file(&format!("HAL/inc/{top}.h"), hal_header(top));
    let compiled = others.iter().chain([&hal]);
    let script = sw_tcl(driver, compiled.map(|file| file.path.as_str()));
    let overlay = file(&format!("linux/{}.dtso", driver.machine), overlay(driver));
    vec![file(&format!("{top}_sw.tcl"), script), hal, overlay]
}

/// The script that `nios2-bsp` and `niosv-bsp` read.
fn sw_tcl<'a>(driver: &StageDriver<'_>, paths: impl Iterator<Item = &'a str>) -> String {
    let (top, version) = (driver.top, version(driver.map));
    let inside = paths.filter_map(|path| path.strip_prefix(FOLDER)?.strip_prefix('/'));
    let mut lines: Vec<String> = inside
        .filter(|path| !path.starts_with("linux/") && !path.starts_with(bare_metal::FOLDER))
        .map(|path| {
            if path.ends_with(".c") {
                format!("add_sw_property c_source {path}")
            } else {
                format!("add_sw_property include_source {path}")
            }
        })
        .collect();
    lines.sort();
    let files = lines.join("\n");
    format!(
        "# Driver of {top} for the HAL of Nios II and Nios V. Written by posicast.
create_driver {top}_driver

set_sw_property hw_class_name {top}
set_sw_property version {version}
set_sw_property min_compatible_hw_version {version}
set_sw_property bsp_subdirectory drivers
set_sw_property auto_initialize true
set_sw_property isr_preemption_supported true
set_sw_property supported_interrupt_apis \"enhanced_interrupt_api\"

{files}
add_sw_property include_directory inc
add_sw_property include_directory HAL/inc
add_sw_property alt_cppflags_addition \"-DPOSICAST_HAL\"
add_sw_property supported_bsp_type HAL
add_sw_property supported_bsp_type UCOSII
"
    )
}

/// The header that `alt_sys_init.c` includes, named after the class.
fn hal_header(top: &str) -> String {
    let upper = top.to_uppercase();
    format!(
        "/* Of alt_sys_init.c: an instance of {top} is a posicast_stage_hal under the instance's name. Written by posicast. */
#ifndef {upper}_H
#define {upper}_H

#include \"posicast_stage_hal.h\"

#define {upper}_INSTANCE(name, device) posicast_stage_hal device
#define {upper}_INIT(name, device) \\
    posicast_stage_hal_init(&device, name##_BASE, name##_IRQ_INTERRUPT_CONTROLLER_ID, name##_IRQ)

#endif
"
    )
}

/// Writes the overlay for a stage behind the lightweight bridge of a Cyclone V; another address needs another `reg`.
fn overlay(driver: &StageDriver<'_>) -> String {
    let bytes = (4 * driver.map.words()).next_power_of_two().max(4096);
    format!(
        "/*
 * {top} in a device tree, for uio_pdrv_genirq. Written by posicast.
 * The address is offset 0 behind the lightweight bridge of a Cyclone V, the interrupt the first from the FPGA.
 */
/dts-v1/;
/plugin/;

/ {{
    fragment@0 {{
        target-path = \"/soc\";
        __overlay__ {{
            #address-cells = <1>;
            #size-cells = <1>;

            {top}: stage@ff200000 {{
                compatible = \"{COMPATIBLE}-{version}\";
                reg = <0xff200000 {bytes:#x}>;
                interrupt-parent = <&intc>;
                interrupts = <0 40 4>;
            }};
        }};
    }};
}};
",
        top = driver.top,
        version = version(driver.map),
    )
}
