//! Compares the Verilog of register banks and components with their bit-exact models, every output in every clock, and
//! checks what their registers guarantee to a host.

mod bank;
mod classic;
mod components;
mod everything;
mod pins;
mod support;
mod traffic;
