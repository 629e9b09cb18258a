//! Register banks and components: their Verilog against their bit-exact models, every output in every clock; and what
//! their registers promise a host.
#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests, which clippy.toml exempts only inside of #[test]

mod bank;
mod classic;
mod components;
mod everything;
mod pins;
mod support;
mod traffic;
