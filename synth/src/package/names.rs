//! Rules for paths inside an output folder.

use super::error::PackageError;
use super::layout::{MANIFEST, STAGING};

/// Accepts a path relative to the folder, with parts separated by `/`, that neither leaves it nor is one of
/// posicast's own files.
pub(super) fn check(relative: &str) -> Result<(), PackageError> {
    let refuse = |reason| {
        Err(PackageError::Path {
            path: relative.to_owned(),
            reason,
        })
    };
    if relative.chars().any(|c| c.is_control() || c == '\\') {
        return refuse("has a control character or a backslash");
    }
    for (index, part) in relative.split('/').enumerate() {
        match part {
            "" => return refuse("is empty, absolute, or has an empty part"),
            "." | ".." => return refuse("leads out of the folder or in circles"),
            MANIFEST | STAGING if index == 0 => return refuse("is reserved"),
            _ => {}
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::path::{Component, Path};

    #[test]
    fn paths_that_leave_the_folder_are_refused() {
        let bad = [
            "",
            "/etc/passwd",
            "..",
            "../x",
            "rtl/../../x",
            "rtl//x",
            "rtl/",
            "./x",
            "a\\b",
            "a\0b",
            "a\nb",
        ];
        for path in bad
            .into_iter()
            .chain([MANIFEST, ".posicast-staging/x", ".posicast-staging"])
        {
            assert!(matches!(check(path), Err(PackageError::Path { .. })), "{path:?}");
        }
    }

    #[test]
    fn plain_paths_are_accepted() {
        for path in [
            "machine.toml",
            "rtl/xy_stage.v",
            "sopc/c/..x/driver.h",
            "sopc/posicast.json",
        ] {
            assert!(check(path).is_ok(), "{path:?}");
        }
    }

    proptest! {
        #[test]
        fn prop_an_accepted_path_has_only_plain_parts(path in "[a./\\\\]{0,12}") {
            if check(&path).is_ok() {
                prop_assert!(Path::new(&path).components().all(|c| matches!(c, Component::Normal(_))));
            }
        }
    }
}
