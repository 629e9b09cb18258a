//! One module of a name: what several blocks, axes and packages have in common is the same file.

use super::Module;
use super::error::{EmitCause, EmitError};
use super::names;

/// The name of the module `base` that is the same for every machine, as [`emit`](super::emit()) writes it: `posicast_BASE`, or the
/// base alone where the prefix is empty.
pub fn shared_name(prefix: &str, base: &str) -> String {
    names::module_name(prefix, false, base)
}

/// The name of the module `base` that holds something of a machine: `PREFIX_BASE`, or the base alone where the prefix is empty.
pub fn own_name(prefix: &str, base: &str) -> String {
    names::module_name(prefix, true, base)
}

/// What stands in a name for a content that is too long for one: FNV-1a, 32 bits.
pub(crate) fn digest(text: &str) -> u32 {
    text.bytes().fold(0x811c_9dc5, |hash, byte| {
        (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193)
    })
}

/// Adds modules to those of a package, each once.
///
/// # Errors
/// [`EmitCause::OtherContent`] where a module of the same name is there that says something else.
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
