//! What a system needs to find the driver: `_sw.tcl` and macros for the HAL, the overlay of a device tree.

use super::{File, StageDriver, file};
use posicast_model::rtl::registers::RegisterMap;

/// Name in device trees, before the version of the register map: as the component for Platform Designer has it.
const COMPATIBLE: &str = "posicast,stage";

/// Version of the register map, as Platform Designer compares that of a driver with that of its hardware: `1.0`.
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

pub(super) fn files(driver: &StageDriver<'_>) -> Vec<File> {
    let top = driver.top;
    vec![
        file(&format!("{top}_sw.tcl"), sw_tcl(driver)),
        file(&format!("HAL/inc/{top}.h"), hal_header(top)),
        file(&format!("linux/{}.dtso", driver.machine), overlay(driver)),
    ]
}

/// What `nios2-bsp` and `niosv-bsp` read.
fn sw_tcl(driver: &StageDriver<'_>) -> String {
    let (top, machine, version) = (driver.top, driver.machine, version(driver.map));
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

add_sw_property c_source src/posicast_driver.c
add_sw_property c_source src/posicast_segments.c
add_sw_property c_source src/posicast_tables.c
add_sw_property c_source src/posicast_wait.c
add_sw_property c_source src/posicast_plan.c
add_sw_property c_source src/machine_{machine}.c
add_sw_property c_source HAL/src/posicast_stage_hal.c
add_sw_property include_source inc/posicast_io.h
add_sw_property include_source inc/posicast_result.h
add_sw_property include_source inc/posicast_stage_regs.h
add_sw_property include_source inc/posicast_segments.h
add_sw_property include_source inc/posicast_plan.h
add_sw_property include_source inc/posicast_machine.h
add_sw_property include_source inc/posicast_driver.h
add_sw_property include_source inc/machine_{machine}.h
add_sw_property include_source src/posicast_wait.h
add_sw_property include_source HAL/inc/posicast_stage_hal.h
add_sw_property include_source HAL/inc/{top}.h
add_sw_property include_directory inc
add_sw_property include_directory HAL/inc
add_sw_property alt_cppflags_addition \"-DPOSICAST_HAL\"
add_sw_property supported_bsp_type HAL
add_sw_property supported_bsp_type UCOSII
"
    )
}

/// What `alt_sys_init.c` includes, under the name of the class.
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

/// For a stage behind the lightweight bridge of a Cyclone V: another place is another `reg`.
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
