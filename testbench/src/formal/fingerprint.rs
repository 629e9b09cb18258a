//! A number for all on which the result of a proof depends.

use sha2::{Digest, Sha256};

use super::task::Task;
use super::tool::{ASSERTS, COVERS, input_files};

impl Task {
    /// SHA-256, in 32 hexadecimal digits, of everything that decides the result of this task: Verilog, properties, scripts, engine,
    /// and the program that runs the engines. Only the versions of Yosys and ABC are not in it.
    pub fn fingerprint(&self) -> String {
        let mut hash = Sha256::new();
        let mut add = |text: &str| {
            // The length is hashed too, so that texts cannot run into each other.
            hash.update((text.len() as u64).to_le_bytes());
            hash.update(text);
        };
        for (name, text) in input_files(self, &[ASSERTS, COVERS]) {
            add(&name);
            add(&text);
        }
        add(&format!("{:?}", self.engine));
        add(include_str!("tool.rs"));
        let digits = hash.finalize();
        digits.iter().take(16).map(|byte| format!("{byte:02x}")).collect()
    }
}
