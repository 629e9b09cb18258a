# Replaces Quartus: runs a .qsf or an .sdc file and checks its calls.
#
#   tclsh project.tcl 13.0|25.1 FILE PORT=Input|Output ...
#
# The ports are those of the top level. The lists of names contain what the version knows. Prints a record per line, and exits
# with 1 on a finding: an unknown command, option, assignment or port, or a pin that is used twice.

set findings 0
proc finding {text} {
    incr ::findings
    puts "finding $text"
}

set globals {
    DEVICE FAMILY PROJECT_OUTPUT_DIRECTORY QIP_FILE RESERVE_ALL_UNUSED_PINS_WEAK_PULLUP SDC_FILE STRATIX_DEVICE_IO_STANDARD
    TOP_LEVEL_ENTITY VERILOG_FILE VERILOG_INPUT_VERSION
}
set quartus [lindex $argv 0]
if {$quartus eq "13.0"} { lappend globals USE_TIMEQUEST_TIMING_ANALYZER }
foreach pair [lrange $argv 2 end] { lassign [split $pair =] name direction; set ports($name) $direction }

# Parses the options of a command; 1 marks an option with a value. Returns a dictionary, with other words under {}.
proc options {command words known} {
    set found [dict create {} {}]
    while {$words ne {}} {
        set words [lassign $words word]
        if {![regexp {^-[a-z_]+$} $word]} { dict lappend found {} $word; continue }
        if {![dict exists $known $word]} { finding "$command: option $word is not known"; continue }
        set value 1
        if {[dict get $known $word]} { set words [lassign $words value] }
        dict set found $word $value
    }
    return $found
}
proc port {name} { if {![info exists ::ports($name)]} { finding "there is no port $name" } }

# ---- .qsf ----

proc set_global_assignment {args} {
    set found [options set_global_assignment $args {-name 1}]
    set name [dict get $found -name]
    if {$name ni $::globals} { finding "global assignment $name is not known to $::quartus" }
    puts "global $name [lindex [dict get $found {}] 0]"
}
proc set_location_assignment {args} {
    set found [options set_location_assignment $args {-to 1}]
    set pin [dict get $found {}]
    set name [dict get $found -to]
    port $name
    if {![regexp {^PIN_[A-Z]{1,2}[0-9]{1,2}$} $pin]} { finding "$pin is no pin" }
    if {[info exists ::taken($pin)]} { finding "$pin is taken twice" }
    set ::taken($pin) $name
    puts "pin $name $pin"
}
proc set_instance_assignment {args} {
    set found [options set_instance_assignment $args {-name 1 -to 1}]
    port [dict get $found -to]
    if {[dict get $found -name] ni {IO_STANDARD WEAK_PULL_UP_RESISTOR}} { finding "assignment [dict get $found -name]" }
    puts "assignment [dict get $found -to] [dict get $found -name] [lindex [dict get $found {}] 0]"
}

# ---- .sdc ----

proc get_ports {names} {
    foreach name $names { if {$name ne "altera_reserved_tck"} { port $name } }
    return $names
}
proc get_registers {patterns} { return $patterns }
proc create_clock {args} {
    set found [options create_clock $args {-name 1 -period 1}]
    set ::clocks([dict get $found -name]) 1
    puts "clock [dict get $found -name] [dict get $found -period]"
}
proc set_clock_groups {args} {
    for {set i 0} {$i < [llength $args]} {incr i} {
        if {[lindex $args $i] eq "-group"} {
            incr i
            foreach clock [lindex $args $i] { if {![info exists ::clocks($clock)]} { finding "there is no clock $clock" } }
        } elseif {[lindex $args $i] ne "-asynchronous"} { finding "set_clock_groups [lindex $args $i]" }
    }
}
proc derive_clock_uncertainty {} { if {$::quartus eq "13.0"} { finding "no clock uncertainty of a Cyclone II" } }
proc delay {command direction arguments} {
    set found [options $command $arguments {-clock 1 -min 0 -max 0}]
    if {![info exists ::clocks([dict get $found -clock])]} { finding "$command: no clock [dict get $found -clock]" }
    lassign [dict get $found {}] value names
    if {![string is double -strict $value]} { finding "$command: a delay of $value" }
    foreach name $names {
        if {$::ports($name) ne $direction} { finding "$command on $name, which is $::ports($name)" }
        puts "delay $name [expr {[dict exists $found -min] ? "min" : "max"}]"
    }
}
proc set_input_delay {args} { delay set_input_delay Input $args }
proc set_output_delay {args} { delay set_output_delay Output $args }
proc set_false_path {args} {
    set found [options set_false_path $args {-from 1 -to 1}]
    if {[dict get $found {}] ne {} || ![dict exists $found -from] || ![dict exists $found -to]} { finding "false path $args" }
    foreach name [dict get $found -from] { puts "false_path $name [dict get $found -to]" }
}

if {[catch { source [lindex $argv 1] } error]} { finding "script: $error" }
exit [expr {$findings > 0}]
