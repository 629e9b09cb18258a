//! Tests of the emitter: the errors of RustHDL's own generator, and the emitter's own rules.
//!
//! | file | what it shows |
//! |---|---|
//! | `kernels` | every pitfall as a kernel: equal in RustHDL, Icarus, Verilator and after Yosys, or refused |
//! | `refused` | the refusals: block, signal, remedy |
//! | `modules` | names, files, sharing, headers, composition |
//! | `shaper` | the shaper's Verilog against its model |
//! | `sizes` | kernels at sizes that are not compiled |

#[macro_use]
mod support;

mod kernels;
mod modules;
mod refused;
mod shaper;
mod sizes;
mod tools;
