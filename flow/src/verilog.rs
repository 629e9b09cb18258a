//! Writes a machine's modules as files: into its folder, or into a temporary one.

use crate::failure::Failure;
use crate::machine::MachineFile;
use posicast_hdl::emit::Module;
use posicast_synth::package::Package;
use posicast_system::scratch;
use std::path::PathBuf;

/// Path of a module in the folder.
pub(crate) fn path(module: &Module) -> String {
    format!("rtl/{}.v", module.name)
}

/// Adds the machine file and its Verilog to the folder, and returns the paths of the Verilog until the folder is
/// complete.
pub(crate) fn add_sources(
    package: &mut Package,
    file: &MachineFile,
    modules: &[Module],
) -> Result<Vec<PathBuf>, Failure> {
    package
        .add("machine.toml", file.text.as_bytes())
        .map_err(Failure::because)?;
    for (name, text) in &file.beside {
        package.add(name, text.as_bytes()).map_err(Failure::because)?;
    }
    let write = |module: &Module| {
        let path = package.stage(&path(module)).map_err(Failure::because)?;
        std::fs::write(&path, &module.text).map_err(Failure::of_file(&path, "write it"))?;
        Ok(path)
    };
    modules.iter().map(write).collect()
}

/// Writes the modules into a temporary folder, for tools that read files. The folder is removed when the guard is
/// dropped.
pub(crate) fn write_scratch(modules: &[Module]) -> Result<(Vec<PathBuf>, scratch::Folder), Failure> {
    let folder = scratch_folder()?;
    let files: Result<Vec<_>, Failure> = modules
        .iter()
        .map(|module| {
            let path = folder.path().join(format!("{}.v", module.name));
            std::fs::write(&path, &module.text).map_err(Failure::of_file(&path, "write it"))?;
            Ok(path)
        })
        .collect();
    Ok((files?, folder))
}

/// A temporary folder, which is removed when it is dropped.
pub(crate) fn scratch_folder() -> Result<scratch::Folder, Failure> {
    let parent = std::env::temp_dir();
    scratch::Folder::new(scratch::PREFIX).map_err(Failure::of_file(&parent, "make a folder in it"))
}
