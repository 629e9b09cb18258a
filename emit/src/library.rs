//! Names and deduplication of modules: a module that several blocks, axes and packages share is one file.

use super::Module;
use super::error::{EmitCause, EmitError};
use super::names;

/// Name that [`emit`](super::emit()) gives to the module `base` if it is the same for every machine: `posicast_BASE`,
/// or the base alone where the prefix is empty.
pub fn shared_name(prefix: &str, base: &str) -> String {
    names::module_name(prefix, false, base)
}

/// Name of the module `base` whose contents depend on the machine: `PREFIX_BASE`, or the base alone where the prefix is
/// empty.
pub fn own_name(prefix: &str, base: &str) -> String {
    names::module_name(prefix, true, base)
}

/// A short hash that represents contents in a name: FNV-1a, 32 bits.
pub fn digest(text: &str) -> u32 {
    text.bytes().fold(0x811c_9dc5, |hash, byte| {
        (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193)
    })
}

/// Adds modules to those of a package, without duplicates.
///
/// # Errors
/// [`EmitCause::OtherContent`] where a different module with the same name exists.
pub fn add(modules: &mut Vec<Module>, more: Vec<Module>) -> Result<(), EmitError> {
    for module in more {
        match modules.iter().find(|there| there.name == module.name) {
            None => modules.push(module),
            Some(there) if *there == module => {}
            Some(_) => {
                return Err(EmitError::new(
                    &module.name,
                    "",
                    EmitCause::OtherContent(module.name.clone()),
                ));
            }
        }
    }
    Ok(())
}
