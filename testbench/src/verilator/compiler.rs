//! The C++ compiler that Verilator's makefile calls.

use std::path::Path;

use posicast_system::tool;

use super::VERILATOR;
use crate::error::MissingTool;

/// The compiler if the makefile names none: that of Debian's Verilator.
const USUAL: &str = "g++";
/// Verilator's makefile, below its root.
const MAKEFILE: &str = "include/verilated.mk";

/// A C++ compiler.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Compiler(String);

/// Returns the compiler that built the installed Verilator.
pub(super) fn of_verilator() -> Compiler {
    let makefile = || {
        VERILATOR.missing().is_none().then_some(())?;
        let asked = VERILATOR.answer(
            VERILATOR.command().args(["--getenv", "VERILATOR_ROOT"]),
            "telling its root",
        );
        let root = String::from_utf8(asked.ok()?.stdout).ok()?;
        std::fs::read_to_string(Path::new(root.trim()).join(MAKEFILE)).ok()
    };
    Compiler(in_makefile(&makefile().unwrap_or_default()).unwrap_or(USUAL).to_owned())
}

/// Returns the value of `CXX` in a makefile.
fn in_makefile(text: &str) -> Option<&str> {
    let value = text.lines().find_map(|line| {
        let (name, value) = line.split_once('=')?;
        (name.trim_end_matches([':', '?', ' ']).trim() == "CXX").then(|| value.trim())
    })?;
    value.split_whitespace().next()
}

impl Compiler {
    /// This compiler, if it is not installed.
    pub(super) fn missing(&self) -> Option<MissingTool> {
        tool::located(Path::new(&self.0)).is_none().then(|| MissingTool {
            tool: self.0.clone(),
            purpose: "it compiles Verilator's output",
            remedy: "Install a C++ compiler (Debian: apt-get install g++)",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_compiler_is_the_one_that_the_makefile_names() {
        let makefile = "AR = ar\nCXX = clang++ -stdlib=libc++\nLINK = g++\nCXXFLAGS += -O\n";
        assert_eq!(in_makefile(makefile), Some("clang++"));
        assert_eq!(in_makefile("CXX ?= c++\n"), Some("c++"));
        assert_eq!(in_makefile("LINK = g++\n"), None);
        let absent = Compiler("posicast-no-such-compiler".to_owned());
        assert!(
            absent
                .missing()
                .unwrap()
                .to_string()
                .starts_with("posicast-no-such-compiler: not found")
        );
        assert_eq!(Compiler("sh".to_owned()).missing(), None);
    }
}
