//! The files that options name.

use crate::failure::Failure;
use posicast_system::output::OutputFiles;

/// What a front does with the document of a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ResultForm {
    /// It shows the text, on standard error where a file is the standard output.
    #[default]
    Text,
    /// It writes the document to the standard output, where there may be nothing else.
    Document,
}

/// Refuses a document where a file that the step writes is the standard output.
pub(crate) fn one_document(outputs: &OutputFiles, form: ResultForm) -> Result<(), Failure> {
    match form == ResultForm::Document && outputs.take_standard_output() {
        false => Ok(()),
        true => Err(Failure::from(miette::miette!(
            help = "name a file for it, or leave out --json",
            "--json: standard output takes one document, and a file is written there already"
        ))),
    }
}
