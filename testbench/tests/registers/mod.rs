//! Register banks and components: their Verilog against their bit-exact models, every output in every clock; and what
//! their registers promise a host.

mod bank;
mod classic;
mod components;
mod everything;
mod pins;
mod support;
mod traffic;
