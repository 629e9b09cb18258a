//! Verilator's C++ as two files instead of some twenty.
//!
//! Each file that Verilator writes includes the headers of its library, which takes the compiler longer than the rest of most
//! files. So all that runs in every clock is included into the harness, and all that runs once into a second file: a stage of two
//! axes is compiled in a quarter of the time.

use std::fmt::Write as _;
use std::io;
use std::path::Path;

use super::harness::CLASS;

/// File that includes what runs once.
pub(super) const SLOW: &str = "run_once.cpp";

/// The C++ files that Verilator wrote, in the order of their names.
#[derive(Debug, Default, PartialEq, Eq)]
pub(super) struct Classes {
    /// What runs in every clock.
    pub(super) fast: Vec<String>,
    /// Constructors, initial values, tables of names.
    pub(super) slow: Vec<String>,
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
}

/// C++ that includes these files.
pub(super) fn includes(files: &[String]) -> String {
    files.iter().fold(String::new(), |mut text, file| {
        let _ = writeln!(text, "#include \"{file}\"");
        text
    })
}

/// Variables for Verilator's makefile: its own files are not compiled by themselves.
pub(super) const MAKE_VARIABLES: [&str; 5] = [
    "VM_CLASSES_FAST=",
    "VM_CLASSES_SLOW=run_once",
    "VM_SUPPORT_FAST=",
    "VM_SUPPORT_SLOW=",
    "VM_PARALLEL_BUILDS=1",
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_each_class_is_in_one_of_the_two_files() {
        let names = [
            "Vdevice.cpp",
            "Vdevice__Syms.cpp",
            "Vdevice___024root__DepSet_h12__0.cpp",
            "Vdevice___024root__DepSet_h12__0__Slow.cpp",
            "Vdevice.h",
            "harness.cpp",
        ];
        let classes = Classes::sorted(names.map(str::to_owned).to_vec());
        assert_eq!(classes.fast, [names[0], names[2]]);
        assert_eq!(classes.slow, [names[1], names[3]]);
        assert_eq!(includes(&classes.slow[..1]), "#include \"Vdevice__Syms.cpp\"\n");
    }
}
