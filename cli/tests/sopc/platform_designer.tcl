# Replaces Platform Designer: runs the script of a component or of a system and checks its calls.
#
#   tclsh platform_designer.tcl component FILE_hw.tcl
#   tclsh platform_designer.tcl system 13.0|25.1 SCRIPT.tcl FOLDER_OF_COMPONENTS
#
# A script runs in an interpreter with only the commands below. The lists of names contain what Quartus II 13.0 knows. They were
# made by hand from excerpts of its handbook and from public scripts for 13.0 and 13.1: any other name is a finding. Prints a
# record per line, and exits with 1 on a finding.

set findings 0
proc finding {text} {
    incr ::findings
    puts "finding $text"
}
proc one_of {what name allowed} {
    if {$name ni $allowed} { finding "$what $name is not known: $allowed" }
}

# ---- what 13.0 knows about components ----

set versions {10.0 10.1 11.0 11.1 12.0 12.1 13.0}
set module_properties {
    ANALYZE_HDL AUTHOR DATASHEET_URL DESCRIPTION DISPLAY_NAME EDITABLE ELABORATION_CALLBACK GROUP ICON_PATH
    INSTANTIATE_IN_SYSTEM_MODULE INTERNAL NAME OPAQUE_ADDRESS_MAP REPORT_TO_TALKBACK VALIDATION_CALLBACK VERSION
}
set parameter_types {BOOLEAN INTEGER LONG NATURAL POSITIVE STD_LOGIC STD_LOGIC_VECTOR STRING FLOAT}
set parameter_properties {
    AFFECTS_ELABORATION AFFECTS_GENERATION ALLOWED_RANGES DEFAULT_VALUE DERIVED DESCRIPTION DISPLAY_HINT DISPLAY_NAME ENABLED
    HDL_PARAMETER SYSTEM_INFO TYPE UNITS VISIBLE WIDTH
}
set file_types {DAT HEX MIF OTHER SDC SYSTEM_VERILOG TCL VERILOG VERILOG_INCLUDE VHDL}
set properties(clock) {clockRate ENABLED}
set properties(reset) {associatedClock synchronousEdges ENABLED}
set properties(interrupt) {associatedAddressablePoint associatedClock associatedReset ENABLED}
set properties(conduit) {associatedClock associatedReset ENABLED}
set properties(avalon) {
    addressAlignment addressUnits associatedClock associatedReset bitsPerSymbol burstOnBurstBoundariesOnly burstcountUnits
    ENABLED explicitAddressSpan holdTime isFlash isMemoryDevice isNonVolatileStorage linewrapBursts
    maximumPendingReadTransactions printableDevice readLatency readWaitStates readWaitTime setupTime timingUnits
    writeLatency writeWaitStates writeWaitTime
}
set roles(clock) {clk}
set roles(reset) {reset reset_n}
set roles(interrupt) {irq irq_n}
set roles(avalon) {
    address begintransfer burstcount byteenable chipselect debugaccess lock read readdata readdatavalid waitrequest write
    writedata
}

# ---- the commands of a component ----

proc package_of_component {command args} {
    if {$command ne "require"} { return [finding "package $command"] }
    lassign $args exact name version
    if {$exact ne "-exact" || $name ne "qsys"} { finding "package require $args: want -exact qsys VERSION" }
    one_of "qsys version" $version $::versions
}
proc set_module_property {name value} {
    one_of "module property" $name $::module_properties
    set ::module($name) $value
}
proc set_module_assignment {name value} {
    if {![regexp {^embeddedsw\.(CMacro\.[A-Z][A-Z0-9_]*|dts\.(vendor|name|group|compatible))$} $name]} {
        finding "assignment $name"
    }
    if {[info exists ::assignment($name)]} { finding "assignment $name twice" }
    set ::assignment($name) $value
}
proc add_parameter {name type {value {}} {description {}}} {
    one_of "type of parameter $name" $type $::parameter_types
    if {[info exists ::parameter($name)]} { finding "parameter $name twice" }
    if {$type in {INTEGER LONG} && ![string is wideinteger -strict $value]} { finding "parameter $name is $value" }
    if {$type eq "INTEGER" && abs($value) > 0x7fffffff} { finding "parameter $name is too large" }
    set ::parameter($name) $value
}
proc set_parameter_property {name property value} {
    if {![info exists ::parameter($name)]} { return [finding "property of unknown parameter $name"] }
    one_of "property of parameter $name" $property $::parameter_properties
    set ::parameter_property($name,$property) $value
}
proc add_fileset {name kind {callback {}} {display {}}} {
    one_of "file set" $kind {QUARTUS_SYNTH SIM_VERILOG SIM_VHDL EXAMPLE_DESIGN}
    if {[info exists ::fileset($name)]} { finding "file set $name twice" }
    set ::fileset($name) $kind
    set ::current_fileset $name
    puts "fileset $kind"
}
proc set_fileset_property {name property value} {
    if {![info exists ::fileset($name)]} { return [finding "property of unknown file set $name"] }
    one_of "file set property" $property {TOP_LEVEL ENABLE_RELATIVE_INCLUDE_PATHS}
    if {$property eq "TOP_LEVEL"} { puts "top $::fileset($name) $value" }
}
proc add_fileset_file {name type how path args} {
    one_of "file type" $type $::file_types
    one_of "source of a file" $how {PATH TEXT}
    if {$args ne {}} { finding "attribute $args of $name came after 13.0" }
    if {![info exists ::current_fileset]} { return [finding "file $name in no file set"] }
    if {![file isfile [file join $::folder $path]]} { finding "file $path does not exist" }
    puts "file $::fileset($::current_fileset) $path"
}
proc add_interface {name kind direction} {
    one_of "kind of interface $name" $kind {avalon clock conduit interrupt reset}
    one_of "direction of interface $name" $direction {end start sink source slave master sender receiver}
    if {[info exists ::interface($name)]} { return [finding "interface $name twice"] }
    set ::interface($name) $kind
    if {$direction eq "start"} { set ::host($name) 1 }
    lappend ::order $name
    puts "interface $name $kind"
}
proc set_interface_property {name property value} {
    if {![info exists ::interface($name)]} { return [finding "property of unknown interface $name"] }
    one_of "property of $::interface($name) interface $name" $property $::properties($::interface($name))
    set ::interface_property($name,$property) $value
}
proc set_interface_assignment {name key value} {
    if {![info exists ::interface($name)]} { finding "assignment to unknown interface $name" }
}
proc set_port_property {port property value} {
    if {![info exists ::bound($port)]} { return [finding "property of unknown port $port"] }
    one_of "property of port $port" $property {TERMINATION TERMINATION_VALUE}
    if {$property eq "TERMINATION_VALUE" && (![string is wideinteger -strict $value] || $value >= 1 << $::width($port))} {
        finding "port $port is terminated with $value"
    }
    set ::port_property($port,$property) $value
}
proc add_interface_port {name port role direction width} {
    if {![info exists ::interface($name)]} { return [finding "port $port of unknown interface $name"] }
    set kind $::interface($name)
    if {$kind ne "conduit"} { one_of "role of port $port" $role $::roles($kind) }
    one_of "direction of port $port" $direction {Input Output Bidir}
    if {![string is integer -strict $width] || $width < 1} { finding "width of port $port is $width" }
    if {[info exists ::bound($port)]} { finding "port $port twice" }
    if {[info exists ::signal($name,$role)]} { finding "role $role of interface $name twice" }
    set ::bound($port) $name
    set ::width($port) $width
    set ::signal($name,$role) [list $direction $width]
    puts "port $name $port $role $direction $width"
}

# Checks a component as a whole.
proc check_component {} {
    foreach name {NAME VERSION} {
        if {![info exists ::module($name)]} { finding "module property $name is missing" }
    }
    foreach name [array names ::parameter] {
        set value $::parameter($name)
        if {![info exists ::parameter_property($name,ALLOWED_RANGES)]
            || $::parameter_property($name,ALLOWED_RANGES) ne "$value:$value"
            || $::parameter_property($name,ENABLED) ne "false"} {
            finding "parameter $name can be changed"
        }
    }
    foreach name $::order { check_interface $name $::interface($name) }
    foreach {name value} [array get ::assignment] { puts "assignment $name $value" }
    foreach port [lsort [array names ::bound]] {
        if {![info exists ::port_property($port,TERMINATION)]} { continue }
        if {$::port_property($port,TERMINATION) ne "true"} { finding "TERMINATION of port $port" }
        puts "terminated $port $::port_property($port,TERMINATION_VALUE)"
    }
}
proc check_interface {name kind} {
    if {[array names ::signal $name,*] eq {}} { finding "interface $name has no port" }
    set wanted {avalon {Clock Reset} conduit {Clock Reset} interrupt {Clock Reset} reset {Clock} clock {}}
    foreach other [dict get $wanted $kind] {
        if {![info exists ::interface_property($name,associated$other)]} {
            finding "interface $name has no associated$other"
            continue
        }
        set target $::interface_property($name,associated$other)
        if {![info exists ::interface($target)] || $::interface($target) ne [string tolower $other]} {
            finding "associated$other of $name is $target, which is none"
        }
    }
    if {$kind eq "avalon"} { [expr {[info exists ::host($name)] ? "check_host" : "check_agent"}] $name }
    if {$kind eq "interrupt"} {
        set agent $::interface_property($name,associatedAddressablePoint)
        if {![info exists ::interface($agent)] || $::interface($agent) ne "avalon"} { finding "interrupt $name is of $agent" }
    }
}
proc check_host {name} {
    foreach {role direction width} {
        address Output 16 read Output 1 write Output 1 writedata Output 32 readdata Input 32 waitrequest Input 1
    } {
        if {![info exists ::signal($name,$role)]} { return [finding "host $name has no $role"] }
        if {$::signal($name,$role) ne [list $direction $width]} { finding "$role of host $name is $::signal($name,$role)" }
    }
    foreach {property value} {addressUnits WORDS maximumPendingReadTransactions 0} {
        if {$::interface_property($name,$property) ne $value} { finding "$property of host $name is not $value" }
    }
}
proc check_agent {name} {
    foreach {role direction} {address Input read Input write Input byteenable Input writedata Input readdata Output} {
        if {![info exists ::signal($name,$role)]} { return [finding "agent $name has no $role"] }
        if {[lindex $::signal($name,$role) 0] ne $direction} { finding "$role of agent $name is no $direction" }
    }
    set width [lindex $::signal($name,writedata) 1]
    if {$width != 32 || [lindex $::signal($name,readdata) 1] != 32} { finding "data of agent $name are not 32 bits wide" }
    if {[lindex $::signal($name,byteenable) 1] * 8 != $width} { finding "byte enables of agent $name do not fit its data" }
    foreach {property value} {readLatency 1 readWaitTime 0 writeWaitTime 0 addressUnits WORDS maximumPendingReadTransactions 0} {
        if {$::interface_property($name,$property) ne $value} { finding "$property of agent $name is not $value" }
    }
}

# Runs a script with these commands, each given as NAME or {NAME PROCEDURE}.
proc run {file commands} {
    set child [interp create -safe]
    $child hide package
    foreach command $commands {
        lassign $command name procedure
        $child alias $name [expr {$procedure eq {} ? $name : $procedure}]
    }
    set channel [open $file]
    set text [read $channel]
    close $channel
    if {[catch { $child eval $text } error]} { finding "script: $error" }
    interp delete $child
}
proc run_component {file} {
    set ::folder [file dirname [file normalize $file]]
    run $file {
        {package package_of_component} set_module_property set_module_assignment add_parameter set_parameter_property
        add_fileset set_fileset_property add_fileset_file add_interface set_interface_property set_interface_assignment
        add_interface_port set_port_property
    }
    check_component
}

set order {}
switch [lindex $argv 0] {
    component { run_component [lindex $argv 1] }
    system {
        source [file join [file dirname [file normalize [info script]]] system.tcl]
        run_system [lindex $argv 1] [lindex $argv 2] [lindex $argv 3]
    }
    default { error "component or system" }
}
exit [expr {$findings > 0}]
