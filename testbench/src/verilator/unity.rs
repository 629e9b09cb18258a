//! Verilator's C++ as one file instead of some twenty.
//!
//! Each file that Verilator writes includes the headers of its library, which takes the compiler longer than the rest of most
//! files. So all of them are included into the harness, and the headers are compiled beforehand ([`super::runtime`]): a stage of two
//! axes is compiled in a sixth of the time, and a small block in a third.

use std::fmt::Write as _;
use std::io;
use std::path::Path;

use super::harness::CLASS;

/// The C++ files that Verilator wrote, in the order of their names.
#[derive(Debug, Default, PartialEq, Eq)]
pub(super) struct Classes {
    /// Code that runs in every clock.
    fast: Vec<String>,
    /// Constructors, initial values, tables of names.
    slow: Vec<String>,
}

impl Classes {
    /// The files in a build folder.
    ///
    /// # Errors
    /// [`io::Error`] where the folder cannot be read.
    pub(super) fn of(folder: &Path) -> io::Result<Self> {
        let mut names = Vec::new();
        for entry in std::fs::read_dir(folder)? {
            names.extend(entry?.file_name().into_string());
        }
        names.sort();
        Ok(Self::sorted(names))
    }

    fn sorted(names: Vec<String>) -> Self {
        let is_class = |name: &String| name.starts_with(CLASS) && name.ends_with(".cpp");
        let is_slow = |name: &String| name.contains("Slow") || name.contains("__Syms") || name.contains("__ConstPool");
        let (slow, fast) = names.into_iter().filter(is_class).partition(is_slow);
        Self { fast, slow }
    }

    /// C++ that includes them. What runs once is not optimised, which would take longer than it wins.
    pub(super) fn includes(&self) -> String {
        let include = |text: &mut String, files: &[String]| {
            for file in files {
                // Writing to a `String` cannot fail.
                let _ = writeln!(text, "#include \"{file}\"");
            }
        };
        let mut text = String::new();
        include(&mut text, &self.fast);
        text += "#pragma GCC optimize(\"O0\")\n";
        include(&mut text, &self.slow);
        text
    }
}

/// Variables for Verilator's makefile: its own files are not compiled by themselves.
pub(super) const MAKE_VARIABLES: [&str; 5] = [
    "VM_CLASSES_FAST=",
    "VM_CLASSES_SLOW=",
    "VM_SUPPORT_FAST=",
    "VM_SUPPORT_SLOW=",
    "VM_PARALLEL_BUILDS=1",
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_class_is_included_once_and_what_runs_once_is_not_optimised() {
        let names = [
            "Vdevice.cpp",
            "Vdevice__Syms.cpp",
            "Vdevice___024root__DepSet_h12__0.cpp",
            "Vdevice___024root__DepSet_h12__0__Slow.cpp",
            "Vdevice.h",
            "harness.cpp",
        ];
        let included = Classes::sorted(names.map(str::to_owned).to_vec()).includes();
        let lines: Vec<_> = included.lines().collect();
        let include = |name: &str| format!("#include \"{name}\"");
        assert_eq!(
            lines,
            [
                &*include(names[0]),
                &*include(names[2]),
                "#pragma GCC optimize(\"O0\")",
                &*include(names[1]),
                &*include(names[3])
            ]
        );
    }
}
