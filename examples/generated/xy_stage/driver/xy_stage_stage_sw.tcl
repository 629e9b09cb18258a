# Driver of xy_stage_stage for the HAL of Nios II and Nios V. Written by posicast.
create_driver xy_stage_stage_driver

set_sw_property hw_class_name xy_stage_stage
set_sw_property version 2.2
set_sw_property min_compatible_hw_version 2.2
set_sw_property bsp_subdirectory drivers
set_sw_property auto_initialize true
set_sw_property isr_preemption_supported true
set_sw_property supported_interrupt_apis "enhanced_interrupt_api"

add_sw_property c_source HAL/src/posicast_stage_hal.c
add_sw_property c_source src/machine_xy_stage.c
add_sw_property c_source src/posicast_driver.c
add_sw_property c_source src/posicast_homing.c
add_sw_property c_source src/posicast_plan.c
add_sw_property c_source src/posicast_segments.c
add_sw_property c_source src/posicast_settings.c
add_sw_property c_source src/posicast_stream.c
add_sw_property c_source src/posicast_tables.c
add_sw_property c_source src/posicast_wait.c
add_sw_property include_source HAL/inc/posicast_stage_hal.h
add_sw_property include_source HAL/inc/xy_stage_stage.h
add_sw_property include_source inc/machine_xy_stage.h
add_sw_property include_source inc/posicast_driver.h
add_sw_property include_source inc/posicast_homing.h
add_sw_property include_source inc/posicast_io.h
add_sw_property include_source inc/posicast_machine.h
add_sw_property include_source inc/posicast_plan.h
add_sw_property include_source inc/posicast_result.h
add_sw_property include_source inc/posicast_segments.h
add_sw_property include_source inc/posicast_settings.h
add_sw_property include_source inc/posicast_stage_regs.h
add_sw_property include_source inc/posicast_stream.h
add_sw_property include_source src/posicast_wait.h
add_sw_property include_directory inc
add_sw_property include_directory HAL/inc
add_sw_property alt_cppflags_addition "-DPOSICAST_HAL"
add_sw_property supported_bsp_type HAL
add_sw_property supported_bsp_type UCOSII
