# Commands of a system script, and the vendor's components that our systems use; part of platform_designer.tcl.
#
# A component is {parameters} {interface kind end|start span-in-bytes ...}. Names, kinds and spans are checked: what is
# connected to what, at which address, and what leaves the system.

set memory {memorySize dataWidth initMemContent blockType}
set common [dict create \
    altera_avalon_onchip_memory2 [list $memory {clk1 clock end 0 reset1 reset end 0 s1 avalon end memory}] \
    altera_avalon_timer {
        {period periodUnits counterSize fixedPeriod alwaysRun}
        {clk clock end 0 reset reset end 0 s1 avalon end 32 irq interrupt end 0}
    } altera_avalon_uart {
        {baud fixedBaud dataBits parity stopBits}
        {clk clock end 0 reset reset end 0 s1 avalon end 32 irq interrupt end 0 external_connection conduit end 0}
    } altera_avalon_jtag_uart {
        {readBufferDepth writeBufferDepth}
        {clk clock end 0 reset reset end 0 avalon_jtag_slave avalon end 8 irq interrupt end 0}
    } altera_avalon_sysid_qsys {{id} {clk clock end 0 reset reset end 0 control_slave avalon end 8}}]
set library(13.0) [dict merge $common {
    clock_source {
        {clockFrequency clockFrequencyKnown resetSynchronousEdges}
        {clk_in clock end 0 clk_in_reset reset end 0 clk clock start 0 clk_reset reset start 0}
    }
    altera_nios2_qsys {
        {impl debug_level resetSlave resetOffset exceptionSlave exceptionOffset icache_size}
        {
            clk clock end 0 reset_n reset end 0 data_master avalon start 0 instruction_master avalon start 0
            jtag_debug_module avalon end 2048 jtag_debug_module_reset reset start 0 d_irq interrupt start 0
        }
    }
}]
set library(25.1) [dict merge $common {
    altera_clock_bridge {{EXPLICIT_CLOCK_RATE NUM_CLOCK_OUTPUTS} {in_clk clock end 0 out_clk clock start 0}}
    altera_reset_bridge {
        {ACTIVE_LOW_RESET NUM_RESET_OUTPUTS SYNCHRONOUS_EDGES}
        {clk clock end 0 in_reset reset end 0 out_reset reset start 0}
    }
    intel_niosv_m {
        {enableAvalonInterface resetSlave resetOffset}
        {
            clk clock end 0 reset reset end 0 data_manager avalon start 0 instruction_manager avalon start 0
            timer_sw_agent avalon end 64 dm_agent avalon end 65536 platform_irq_rx interrupt start 0
        }
    }
}]
# Versions that a system may name as its own.
set script_versions(13.0) $versions
set script_versions(25.1) [concat $versions {13.1 14.0 15.0 16.0 16.1 17.0 18.0}]
# Roles of the interfaces that can leave a system, with direction and width, as Platform Designer names the ports.
set uart_signals {rxd Input 1 txd Output 1}

proc package_of_system {command exact name version} {
    if {"$command $exact $name" ne "require -exact qsys"} { finding "package $command $exact $name" }
    one_of "qsys version" $version $::script_versions($::quartus)
}
proc create_system {name} { set ::system $name }
proc save_system {file} { if {$file ne "$::system.qsys"} { finding "system $::system is saved as $file" } }
proc set_project_property {name value} {
    one_of "project property" $name {DEVICE DEVICE_FAMILY}
    puts "project $name $value"
}
proc add_instance {name type {version {}}} {
    if {[info exists ::instance($name)]} { return [finding "instance $name twice"] }
    set ::instance($name) $type
    if {[dict exists $::library($::quartus) $type]} {
        foreach {interface kind end span} [lindex [dict get $::library($::quartus) $type] 1] {
            set ::end($name.$interface) [list $kind $end $span]
        }
    } elseif {[file isfile [file join $::components ${type}_hw.tcl]]} {
        add_own $name $type
    } else {
        finding "component $type is not known to $::quartus"
    }
}
# Creates an instance of a component of the package, described by the records of its file.
proc add_own {name type} {
    set records [exec [info nameofexecutable] $::argv0 component [file join $::components ${type}_hw.tcl]]
    foreach record [split $records \n] {
        lassign $record what a b c d e
        if {$what eq "interface"} { set ::end($name.$a) [list $b end 0] }
        if {$what eq "port" && $c eq "address"} { lset ::end($name.$a) 2 [expr {4 << $e}] }
        if {$what eq "port"} { lappend ::signals($name.$a) $c $d $e }
    }
}
proc set_instance_parameter_value {name parameter value} {
    if {![info exists ::instance($name)]} { return [finding "parameter of unknown instance $name"] }
    set type $::instance($name)
    if {![dict exists $::library($::quartus) $type]} { return [finding "parameters of $type cannot be set"] }
    one_of "parameter of $type" $parameter [lindex [dict get $::library($::quartus) $type] 0]
    set ::value($name,$parameter) $value
}
proc add_connection {start end {kind {}}} {
    foreach {name side} [list $start start $end end] {
        if {![info exists ::end($name)]} { return [finding "connection of unknown $name"] }
        if {[lindex $::end($name) 1] ne $side} { finding "$name is no $side of a connection" }
    }
    if {[lindex $::end($start) 0] ne [lindex $::end($end) 0]} { finding "$start and $end are of two kinds" }
    if {[info exists ::connection($start/$end)]} { finding "connection $start/$end twice" }
    set ::connection($start/$end) {}
}
proc set_connection_parameter_value {name parameter value} {
    if {![info exists ::connection($name)]} { return [finding "parameter of unknown connection $name"] }
    one_of "parameter of connection $name" $parameter {baseAddress irqNumber}
    set ::connection($name) $value
}
proc add_export {name kind end} {
    if {[info exists ::export($name)]} { finding "interface $name twice" }
    set ::export($name) [list $kind $end]
}
proc set_export {name property of} {
    one_of "property of exported interface $name" $property {EXPORT_OF}
    if {![info exists ::export($name)] || ![info exists ::end($of)]} { return [finding "export of $of as $name"] }
    if {[lindex $::end($of) 0] ne [lindex $::export($name) 0]} { finding "$of leaves as [lindex $::export($name) 0]" }
    if {[info exists ::exported($of)]} { finding "$of leaves twice" }
    set ::exported($of) $name
    set instance [lindex [split $of .] 0]
    if {$::instance($instance) eq "altera_avalon_uart"} { set ::signals($of) $::uart_signals }
    if {[lindex $::end($of) 0] eq "clock"} { set ::signals($of) {clk Input 1} }
    if {[lindex $::end($of) 0] eq "reset"} {
        set low [expr {$::instance($instance) eq "clock_source" || $::value($instance,ACTIVE_LOW_RESET)}]
        set ::signals($of) [list [expr {$low ? "reset_n" : "reset"}] Input 1]
    }
    foreach {role direction width} $::signals($of) { puts "export ${name}_$role $direction $width" }
}

# Returns the number of bytes that an agent occupies on the bus.
proc span {name} {
    set span [lindex $::end($name) 2]
    if {$span eq "memory"} { return $::value([lindex [split $name .] 0],memorySize) }
    return $span
}
proc check_system {} {
    foreach name [array names ::end] {
        lassign $::end($name) kind end
        if {$end ne "end"} { continue }
        set connected [llength [array names ::connection */$name]]
        if {[info exists ::exported($name)]} { incr connected }
        if {$connected == 0} { finding "$name is connected to nothing" }
        if {$kind eq "clock" && $connected != 1} { finding "clock $name is connected $connected times" }
    }
    foreach start [array names ::end] {
        lassign $::end($start) kind end
        if {$end eq "start" && $kind eq "avalon"} { check_map $start }
        if {$end eq "start" && $kind eq "interrupt"} { check_interrupts $start }
    }
}
proc check_map {master} {
    set ranges {}
    foreach name [array names ::connection $master/*] {
        set agent [lindex [split $name /] 1]
        set base $::connection($name)
        if {![string is integer -strict $base]} { finding "$agent has no address"; continue }
        if {$base % [span $agent]} { finding "$agent at $base is not aligned to its [span $agent] bytes" }
        lappend ranges [list [expr {$base + 0}] [expr {$base + [span $agent]}] $agent]
        puts "agent $agent [expr {$base + 0}] [span $agent]"
    }
    set before 0
    foreach range [lsort -integer -index 0 $ranges] {
        if {[lindex $range 0] < $before} { finding "[lindex $range 2] overlaps the agent before it" }
        set before [lindex $range 1]
    }
}
proc check_interrupts {receiver} {
    foreach name [array names ::connection $receiver/*] {
        set number $::connection($name)
        if {![string is integer -strict $number] || [info exists taken($number)]} { finding "interrupt number of $name" }
        set taken($number) 1
    }
}
proc run_system {quartus file components} {
    set ::quartus $quartus
    set ::components $components
    run $file {
        {package package_of_system} create_system save_system set_project_property add_instance
        set_instance_parameter_value add_connection set_connection_parameter_value {add_interface add_export}
        {set_interface_property set_export}
    }
    check_system
}
