//! The proofs of blocks that have several, or whose macros come from tables of the model.

pub(super) mod axis;
pub(super) mod part;
pub(super) mod registers;
pub(super) mod shaper;
pub(super) mod sliding_mode;
pub(super) mod stage;
