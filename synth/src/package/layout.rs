//! Names of posicast's own files in an output folder.

/// Name of the file that marks a folder as posicast's.
pub const MANIFEST: &str = "posicast.json";
/// Name of the staging folder.
pub(super) const STAGING: &str = ".posicast-staging";
