//! Register banks and components: their Verilog compared with their bit-exact models, every output in every clock;
//! and what their registers guarantee to a host.

mod bank;
mod classic;
mod components;
mod everything;
mod pins;
mod support;
mod traffic;
