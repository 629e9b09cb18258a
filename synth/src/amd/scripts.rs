//! Scripts and constraints for Vivado.

use std::fmt::Write;

use super::{LIBRARY, VENDOR, VERSION};
use crate::bus_top::BusTop;

fn head(about: &str) -> String {
    format!(
        "# {about}\n# Written by posicast {}; never run in Vivado.\n",
        env!("CARGO_PKG_VERSION")
    )
}

/// The exceptions of a core, which Vivado scopes to its instances.
pub(super) fn constraints(core: &BusTop<'_>) -> String {
    let mut text = head(&format!("Timing exceptions of {}", core.top));
    let has = |end: &str| core.sources.iter().any(|source| source.ends_with(end));
    if has("_synchroniser.v") {
        text.push_str(
            "\n# Lines change at any time: the first flip-flop of a synchroniser may be late\n\
             set_false_path -to [get_pins -hierarchical -filter {NAME =~ *synchroniser_first_reg*/D}]\n\
             set_property ASYNC_REG TRUE [get_cells -hierarchical -filter {NAME =~ *synchroniser_first_reg* || NAME =~ \
             *synchroniser_second_reg*}]\n",
        );
    }
    if has("_pin_register.v") {
        text.push_str("set_false_path -to [get_pins -hierarchical -filter {NAME =~ *pin_register_q_reg*/D}]\n");
    }
    if has("_fault_latch.v") {
        text.push_str(
            "\n# A fault sets its latch without a clock\n\
             set_false_path -to [get_pins -hierarchical -filter {NAME =~ *armed_reg*/CLR || NAME =~ *armed_reg*/PRE}]\n",
        );
    }
    text
}

/// The script that packages all cores by Vivado's packager.
pub(super) fn package(machine: &str, cores: &[BusTop<'_>]) -> String {
    let mut text = head(&format!(
        "Packages the cores of {machine} anew: vivado -mode batch -source amd/package_ip.tcl"
    ));
    text.push_str("set here [file dirname [file normalize [info script]]]\n");
    for core in cores {
        let top = core.top;
        let _ = write!(
            text,
            "\ncreate_project -in_memory -part xc7z020clg400-1\nset core [file join $here {top}]\n"
        );
        for source in &core.sources {
            let _ = writeln!(text, "add_files [file join $here .. {source}]");
        }
        let _ = write!(
            text,
            "add_files -fileset constrs_1 [file join $core {top}.xdc]
set_property top {top} [current_fileset]
ipx::package_project -root_dir $core -vendor {VENDOR} -library {LIBRARY} -taxonomy /Motion_Control -force
set_property name {top} [ipx::current_core]
set_property version {VERSION} [ipx::current_core]
ipx::associate_bus_interfaces -busif s_axi -clock clk [ipx::current_core]
ipx::check_integrity [ipx::current_core]
ipx::save_core [ipx::current_core]
close_project
"
        );
    }
    text
}

/// What both block designs do with the core: its cell, its clock, and its pins to the outside.
fn with_core(core: &BusTop<'_>, master: &str) -> String {
    let top = core.top;
    format!(
        "
create_bd_cell -type ip -vlnv {VENDOR}:{LIBRARY}:{top}:{VERSION} core
apply_bd_automation -rule xilinx.com:bd_rule:axi4 -config {{Clk_master Auto Clk_slave Auto Clk_xbar Auto Master \"{master}\" \
         Slave /core/s_axi ddr_seg Auto intc_ip \"New AXI Interconnect\" master_apm 0}} [get_bd_intf_pins core/s_axi]
# The rule connects resets that are active low; this one is active high.
set reset [lindex [get_bd_cells -filter {{VLNV =~ xilinx.com:ip:proc_sys_reset:*}}] 0]
foreach net [get_bd_nets -of_objects [get_bd_pins core/rst]] {{
    disconnect_bd_net $net [get_bd_pins core/rst]
}}
connect_bd_net [get_bd_pins $reset/peripheral_reset] [get_bd_pins core/rst]
"
    )
}

fn end(core: &BusTop<'_>) -> String {
    let of_bus = |name: &str| name.starts_with("s_axi_") || ["rst", "irq"].contains(&name);
    let mut text =
        "\n# Its pins become pins of the design: place them, and mind what a gate driver does until then\n".to_owned();
    for port in core.ports.iter().filter(|port| !of_bus(&port.name)) {
        let _ = writeln!(
            text,
            "make_bd_pins_external -name {0} [get_bd_pins core/{0}]",
            port.name
        );
    }
    text.push_str(
        "\nassign_bd_address
validate_bd_design
save_bd_design
make_wrapper -files [get_files machine.bd] -top
",
    );
    text
}

fn begin(machine: &str, about: &str, name: &str, part: &str) -> String {
    head(&format!("{about}: vivado -mode batch -source amd/{name}.tcl"))
        + &format!(
            "# Another device: add -tclargs PART
set here [file dirname [file normalize [info script]]]
set part [expr {{$argc > 0 ? [lindex $argv 0] : \"{part}\"}}]
create_project {machine}_{name} [file join $here {name}] -part $part
set_property ip_repo_paths $here [current_project]
update_ip_catalog
create_bd_design machine
"
        )
}

/// A block design with the processor of a Zynq-7000.
pub(super) fn zynq7(machine: &str, clock_hz: f64, core: &BusTop<'_>) -> String {
    let mut text = begin(
        machine,
        &format!("A Zynq-7000 with {}", core.top),
        "zynq7",
        "xc7z020clg400-1",
    );
    let _ = write!(
        text,
        "
create_bd_cell -type ip -vlnv xilinx.com:ip:processing_system7 processor
apply_bd_automation -rule xilinx.com:bd_rule:processing_system7 -config {{make_external \"FIXED_IO, DDR\"}} [get_bd_cells processor]
# The clock is that of the machine file
set_property -dict [list CONFIG.PCW_FPGA0_PERIPHERAL_FREQMHZ {} CONFIG.PCW_USE_M_AXI_GP0 1 CONFIG.PCW_USE_FABRIC_INTERRUPT 1 \
         CONFIG.PCW_IRQ_F2P_INTR 1] [get_bd_cells processor]
",
        clock_hz / 1e6
    );
    text += &with_core(core, "/processor/M_AXI_GP0");
    if core.has_interrupt() {
        text.push_str("connect_bd_net [get_bd_pins core/irq] [get_bd_pins processor/IRQ_F2P]\n");
    }
    text + &end(core)
}

/// A block design with a MicroBlaze, for devices without a processor.
pub(super) fn microblaze(machine: &str, clock_hz: f64, core: &BusTop<'_>) -> String {
    let mut text = begin(
        machine,
        &format!("A MicroBlaze with {}", core.top),
        "microblaze",
        "xc7a35tcpg236-1",
    );
    let interrupt = if core.has_interrupt() { "1" } else { "0" };
    let _ = write!(
        text,
        "
# The clock is that of the machine file
create_bd_port -dir I -type clk -freq_hz {clock_hz} clk
create_bd_port -dir I -type rst reset
set_property CONFIG.POLARITY ACTIVE_HIGH [get_bd_ports reset]
create_bd_cell -type ip -vlnv xilinx.com:ip:microblaze processor
apply_bd_automation -rule xilinx.com:bd_rule:microblaze -config {{axi_intc {interrupt} axi_periph Enabled cache None clk \"/clk\" \
         debug_module \"Debug Only\" local_mem 32KB}} [get_bd_cells processor]
connect_bd_net [get_bd_ports reset] [get_bd_pins [lindex [get_bd_cells -filter {{VLNV =~ xilinx.com:ip:proc_sys_reset:*}}] 0]/ext_reset_in]
"
    );
    text += &with_core(core, "/processor (Periph)");
    if core.has_interrupt() {
        text.push_str(
            "connect_bd_net [get_bd_pins core/irq] [get_bd_pins [lindex [get_bd_cells -filter {VLNV =~ xilinx.com:ip:xlconcat:*}] 0]/In0]\n",
        );
    }
    text + &end(core)
}
