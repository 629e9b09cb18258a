//! Which tools the proofs lack. It is apart from the program that runs them, on whose text their recorded results depend.

use super::tool::{ABC, YOSYS};
use crate::error::MissingTool;
use crate::tool::Tool;

/// Returns the tools that the proofs need and that are not installed.
pub fn missing_tools() -> Vec<MissingTool> {
    [YOSYS, ABC].iter().filter_map(Tool::missing).collect()
}
