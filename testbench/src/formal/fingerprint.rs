//! A number for all on which the result of a proof depends.

use sha2::{Digest, Sha256};

use super::task::Task;
use super::tool::{ASSERTS, COVERS, input_files};

impl Task {
    /// SHA-256, in 32 hexadecimal digits, of everything that decides the result of this task: Verilog, properties, scripts, engine,
    /// and the program that runs the engines. Comments are not in it, nor are the versions of Yosys and ABC.
    pub fn fingerprint(&self) -> String {
        let mut hash = Sha256::new();
        let mut add = |text: &str| {
            // The length is hashed too, so that texts cannot run into each other.
            hash.update((text.len() as u64).to_le_bytes());
            hash.update(text);
        };
        for (name, text) in input_files(self, &[ASSERTS, COVERS]) {
            add(&name);
            add(&without_comments(&text));
        }
        add(&format!("{:?}", self.engine));
        // The part before its tests.
        let runner = include_str!("tool.rs").split("#[cfg(test)]").next();
        let is_code = |line: &&str| !line.trim_start().starts_with("//");
        add(&runner
            .unwrap_or_default()
            .split_inclusive('\n')
            .filter(is_code)
            .collect::<String>());
        let digits = hash.finalize();
        digits.iter().take(16).map(|byte| format!("{byte:02x}")).collect()
    }
}

/// Verilog without comments to the end of a line, and without lines that have nothing else. A line with a string is kept whole.
fn without_comments(verilog: &str) -> String {
    let code = verilog.lines().map(|line| match line.split_once("//") {
        Some((code, _)) if !code.contains('"') => code.trim_end(),
        _ => line.trim_end(),
    });
    code.filter(|code| !code.is_empty())
        .flat_map(|code| [code, "\n"])
        .collect()
}
