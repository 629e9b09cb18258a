//! A block's Verilog in files, and the simulators that read them.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use posicast_blocks::Port;
use posicast_hdl::emit::Module;
use posicast_system::scratch;

use super::Block;
use crate::Error;
use crate::icarus::Icarus;
use crate::lockstep::{Device, TwoValued};
use crate::verilator::{self, Verilated, VerilogSource};

/// The Verilog files of a block, in a temporary folder that is removed with this value, or in an existing one.
#[derive(Debug)]
pub struct Sources {
    files: Vec<PathBuf>,
    _folder: Option<scratch::Folder>,
}

impl Sources {
    /// Writes the block's modules, one file each, into a temporary folder.
    ///
    /// # Errors
    /// [`Error::Block`] if the block cannot be written as Verilog, [`Error::File`] if the files cannot be written.
    pub fn write(block: &dyn Block) -> Result<Self, Error> {
        Self::of_modules(&block.modules()?)
    }

    /// Writes these modules instead, for a block with a deliberate change.
    ///
    /// # Errors
    /// [`Error::File`] if the files cannot be written.
    pub fn of_modules(modules: &[Module]) -> Result<Self, Error> {
        let temporary = std::env::temp_dir();
        let folder = scratch::Folder::new(scratch::PREFIX);
        let folder = folder.map_err(Error::file(&temporary, "create a folder in"))?;
        let file = |module: &Module| {
            let path = folder.path().join(format!("{}.v", module.name));
            std::fs::write(&path, &module.text).map_err(Error::file(&path, "write"))?;
            Ok(path)
        };
        Ok(Self {
            files: modules.iter().map(file).collect::<Result<_, Error>>()?,
            _folder: Some(folder),
        })
    }

    /// Takes existing Verilog files without a change, one module per file. They may include modules of other blocks.
    pub fn found(files: Vec<PathBuf>) -> Self {
        Self { files, _folder: None }
    }

    /// Keeps the files that a block's top needs, so that a change elsewhere does not rebuild it: the top's file, and
    /// every file whose name occurs as a word in one that is needed. Keeps all if no file has the top's name.
    ///
    /// # Errors
    /// [`Error::File`] if a file cannot be read.
    pub fn reached_by(&self, block: &dyn Block) -> Result<Self, Error> {
        let stem = |file: &Path| file.file_stem().map(|stem| stem.to_string_lossy().into_owned());
        let top = block.top();
        let (mut reached, mut rest): (Vec<PathBuf>, Vec<PathBuf>) = self
            .files
            .iter()
            .cloned()
            .partition(|file| stem(file).as_ref() == Some(&top));
        if reached.is_empty() {
            return Ok(Self::found(self.files.clone()));
        }
        let mut next = 0;
        while let Some(file) = reached.get(next) {
            let text = std::fs::read(file).map_err(Error::file(file, "read the Verilog"))?;
            let text = String::from_utf8_lossy(&text);
            let words: HashSet<&str> = text.split(|c: char| !(c.is_alphanumeric() || c == '_')).collect();
            let found = |file: &PathBuf| stem(file).is_some_and(|stem| words.contains(stem.as_str()));
            let (new, others) = rest.into_iter().partition(found);
            rest = others;
            reached.extend::<Vec<PathBuf>>(new);
            next += 1;
        }
        Ok(Self::found(reached))
    }

    /// Writes copies of these files; `text` makes the new text of each from its stem and its old text.
    ///
    /// # Errors
    /// [`Error::File`] if a file cannot be read or written.
    pub fn rewritten(&self, text: impl Fn(&str, &str) -> String) -> Result<Self, Error> {
        let module = |file: &PathBuf| {
            let old = std::fs::read(file).map_err(Error::file(file, "read the Verilog"))?;
            let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            Ok(Module {
                text: text(&name, &String::from_utf8_lossy(&old)),
                name,
                ports: Vec::new(),
                clocked: true,
                notes: Vec::new(),
            })
        };
        Self::of_modules(&self.files.iter().map(module).collect::<Result<Vec<_>, Error>>()?)
    }

    /// Returns the files.
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// Returns whether a file has the name of the block's top.
    pub fn hold(&self, block: &dyn Block) -> bool {
        let file = format!("{}.v", block.top());
        let is_top = |path: &PathBuf| path.file_name().is_some_and(|name| name == Path::new(&file));
        self.files.iter().any(is_top)
    }

    /// Compiles the block with Verilator.
    ///
    /// # Errors
    /// As [`Verilated::build`].
    pub fn verilated(&self, block: &dyn Block, seed: u64) -> Result<Verilated, Error> {
        self.with_source(block, |source| Verilated::build(source, seed))
    }

    /// Compiles the block with Verilator, with counters for lines and toggling nets.
    ///
    /// # Errors
    /// As [`Verilated::build`].
    pub fn counting(&self, block: &dyn Block, seed: u64) -> Result<Verilated, Error> {
        self.with_source(block, |source| Verilated::counting(source, seed))
    }

    /// Compiles the block with Icarus.
    ///
    /// # Errors
    /// As [`Icarus::build`].
    pub fn icarus(&self, block: &dyn Block) -> Result<Icarus, Error> {
        self.with_source(block, Icarus::build)
    }

    /// Compiles the block with Icarus; the run writes a waveform.
    ///
    /// # Errors
    /// As [`Icarus::build`].
    pub fn icarus_recording(&self, block: &dyn Block) -> Result<Icarus, Error> {
        self.with_source(block, Icarus::recording)
    }

    /// Returns whether Verilator's simulation of the block is kept, so that no compiler is needed to run it.
    ///
    /// # Errors
    /// As [`verilator::is_built`].
    pub fn is_built(&self, block: &dyn Block) -> Result<bool, Error> {
        self.with_source(block, verilator::is_built)
    }

    /// Returns the warnings of Verilator's lint; the list is empty if there are none.
    ///
    /// # Errors
    /// As [`verilator::lint`].
    pub fn lint(&self, block: &dyn Block) -> Result<Vec<String>, Error> {
        verilator::lint(&self.files, &block.top())
    }

    fn with_source<T>(
        &self,
        block: &dyn Block,
        build: impl Fn(&VerilogSource<'_>) -> Result<T, Error>,
    ) -> Result<T, Error> {
        let ports: Vec<Port> = block.model(0).ports().to_vec();
        build(&VerilogSource {
            files: &self.files,
            top: &block.top(),
            ports: &ports,
        })
    }
}

/// Creates the block in RustHDL's simulator, as a device.
///
/// # Errors
/// [`Error::Block`] if RustHDL finds a fault in it.
pub fn rusthdl(block: &dyn Block) -> Result<Box<dyn Device>, Error> {
    Ok(Box::new(TwoValued(block.simulate()?)))
}
