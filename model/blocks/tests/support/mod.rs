//! What the tests of the models share.

pub(crate) mod link;
pub(crate) mod plain;
pub(crate) mod random_inputs;
pub(crate) mod stage;
pub(crate) mod wrong;
