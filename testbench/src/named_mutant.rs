//! A deliberate fault: one text of the Verilog is replaced by another.

use posicast_hdl::emit::Module;

use crate::Error;

/// A named fault. A missing text is an error, because a mutant that is not applied proves nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NamedMutant<'a> {
    /// Description of the fault.
    pub name: &'a str,
    /// Name of the module without its size. Every module of that name gets the fault, and must contain the text exactly once.
    /// `None`: the first occurrence in the first module that contains the text.
    pub module: Option<&'a str>,
    /// Text in the Verilog.
    pub from: &'a str,
    /// Text that replaces it.
    pub to: &'a str,
}

impl NamedMutant<'_> {
    /// Returns these modules with the fault applied.
    ///
    /// # Errors
    /// [`Error::Option`] where no module has that name, or the text is missing or, in a named module, occurs more than once.
    pub fn put_into(&self, modules: &[Module]) -> Result<Vec<Module>, Error> {
        let mut modules = modules.to_vec();
        let mut found = false;
        for module in &mut modules {
            let times = module.text.matches(self.from).count();
            match self.module {
                Some(name) if !module.is(name) => continue,
                Some(_) if times != 1 => {
                    return Err(self.outdated(format!("`{}` is {times} times in `{}`", self.from, module.name)));
                }
                None if found || times == 0 => continue,
                _ => {}
            }
            module.text = module.text.replacen(self.from, self.to, 1);
            found = true;
        }
        match (found, self.module) {
            (true, _) => Ok(modules),
            (false, Some(name)) => Err(self.outdated(format!("there is no module `{name}`"))),
            (false, None) => Err(self.outdated(format!("no module has `{}`", self.from))),
        }
    }

    fn outdated(&self, why: String) -> Error {
        Error::Option(format!("the mutant `{}` cannot be put in: {why}", self.name))
    }
}
