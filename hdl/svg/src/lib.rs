//! Nothing. `rust-hdl-core` 0.46 depends on `svg` 0.10 and uses no item of it; a future Rust rejects the code of that version, and warns in
//! every build.
