//! The files that options name.

use crate::failure::Failure;
use posicast_system::output::OutputFiles;

/// How a front shows the document of a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ResultForm {
    /// It shows the text: on standard error if a file is the standard output.
    #[default]
    Text,
    /// It writes only the document to the standard output.
    Document,
}

/// Refuses a document if a file that the step writes is the standard output.
pub(crate) fn one_document(outputs: &OutputFiles, form: ResultForm) -> Result<(), Failure> {
    if form == ResultForm::Document && outputs.take_standard_output() {
        Err(
            Failure::input("--json: standard output takes one document, and a file is written there already")
                .with_help("name a file for it, or leave out --json"),
        )
    } else {
        Ok(())
    }
}
