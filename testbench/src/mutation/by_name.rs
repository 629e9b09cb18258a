//! A fault that someone thought of: a text of the Verilog replaced by another.

use posicast_hdl::emit::Module;

use crate::Error;

/// One of them. A text that is no longer there is an error: a mutant that is not put in proves nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NamedMutant<'a> {
    /// What the fault does, in words.
    pub name: &'a str,
    /// What the module is called, without a size; several of these all get the fault, and each has the text once. Without a
    /// module: the first that has the text, where it has it first.
    pub module: Option<&'a str>,
    /// What is there.
    pub from: &'a str,
    /// And what is put there.
    pub to: &'a str,
}

impl NamedMutant<'_> {
    /// These modules with the fault in them.
    ///
    /// # Errors
    /// [`Error::Option`] where no module has that name, or its text is not there.
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
