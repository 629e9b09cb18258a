//! The arithmetic of the component beside the clocked model of the hardware. `scripts/linuxcnc` runs the component in LinuxCNC.

#[path = "../src/axis.rs"]
mod axis;
mod clocked;
mod shaper;

#[global_allocator]
static ALLOCATOR: assert_no_alloc::AllocDisabler = assert_no_alloc::AllocDisabler;
