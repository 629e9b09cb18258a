//! The ownership of files in an output folder, and that no file is half written.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use posicast_synth::package::{self, Committed, Package, PackageError};
use tempfile::TempDir;

/// Returns every file under a folder, path to contents.
fn snapshot(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut files = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                files.insert(path.strip_prefix(folder).unwrap().to_owned(), fs::read(&path).unwrap());
            }
        }
    }
    files
}

/// Writes a package of these files.
fn write(folder: &Path, files: &[(&str, &str)]) -> Result<Committed, PackageError> {
    let mut package = Package::open(folder, "xy_stage")?;
    for (path, text) in files {
        package.add(path, text.as_bytes())?;
    }
    package.commit()
}

const FILES: [(&str, &str); 3] = [
    ("machine.toml", "name = \"xy_stage\"\n"),
    ("rtl/xy_stage.v", "module xy_stage; endmodule\n"),
    ("rtl/shaper_x.v", "module shaper_x; endmodule\n"),
];

/// Returns a folder with a package of [`FILES`].
fn written() -> (TempDir, PathBuf) {
    let scratch = tempfile::tempdir().unwrap();
    let folder = scratch.path().join("out");
    write(&folder, &FILES).unwrap();
    (scratch, folder)
}

#[test]
fn a_new_folder_is_made_and_read_back() {
    let scratch = tempfile::tempdir().unwrap();
    let folder = scratch.path().join("a/b/out");
    let paths = write(&folder, &FILES).unwrap().files;
    let names = ["machine.toml", "rtl/shaper_x.v", "rtl/xy_stage.v", "posicast.json"];
    assert_eq!(paths, names.map(|name| folder.join(name)));
    assert_eq!(snapshot(&folder).len(), 4, "nothing else, no staging folder");

    let contents = package::read(&folder).unwrap();
    assert_eq!(
        (contents.machine.as_str(), contents.machine_toml.as_str()),
        ("xy_stage", FILES[0].1)
    );
    assert_eq!(contents.version, env!("CARGO_PKG_VERSION"));
    assert_eq!(
        contents.rtl,
        [folder.join("rtl/shaper_x.v"), folder.join("rtl/xy_stage.v")]
    );
}

#[test]
fn an_empty_folder_is_ours() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &FILES).unwrap();
    assert!(package::read(folder.path()).is_ok());
}

#[test]
fn the_same_files_give_the_same_bytes() {
    let (_a, first) = written();
    let scratch = tempfile::tempdir().unwrap();
    let mut reversed = FILES;
    reversed.reverse();
    write(scratch.path(), &reversed).unwrap();
    assert_eq!(snapshot(&first), snapshot(scratch.path()));
    write(&first, &FILES).unwrap();
    assert_eq!(snapshot(&first), snapshot(scratch.path()), "written twice");
}

#[test]
fn a_folder_of_somebody_else_is_refused_untouched() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("thesis.tex"), "years of work").unwrap();
    let before = snapshot(folder.path());
    let error = write(folder.path(), &FILES).unwrap_err();
    assert!(matches!(error, PackageError::NotOurs(_)), "{error}");
    assert!(matches!(
        package::read(folder.path()),
        Err(PackageError::NotAPackage(_))
    ));
    assert_eq!(snapshot(folder.path()), before);
}

#[test]
fn a_file_in_place_of_the_folder_is_refused() {
    let scratch = tempfile::tempdir().unwrap();
    let file = scratch.path().join("out");
    fs::write(&file, "text").unwrap();
    assert!(matches!(Package::open(&file, "m"), Err(PackageError::NotAFolder(_))));
    assert!(matches!(package::read(&file), Err(PackageError::NotAFolder(_))));
}

#[test]
fn somebody_elses_manifest_is_refused() {
    for text in [
        "",
        "{}",
        "[1, 2]",
        "{\"files\": {}}",
        "\u{0}",
        "{\"version\":\"1\",\"machine\":\"m\",\"files\":[]}",
    ] {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("posicast.json"), text).unwrap();
        let error = write(folder.path(), &FILES).unwrap_err();
        assert!(matches!(error, PackageError::Manifest { .. }), "{text:?}: {error}");
    }
}

#[test]
fn a_manifest_cannot_point_outside() {
    let scratch = tempfile::tempdir().unwrap();
    fs::write(scratch.path().join("victim"), "").unwrap();
    let folder = scratch.path().join("out");
    fs::create_dir(&folder).unwrap();
    let empty = "sha256:e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855";
    let text = format!("{{\"version\":\"0\",\"machine\":\"m\",\"files\":{{\"../victim\":\"{empty}\"}}}}");
    fs::write(folder.join("posicast.json"), text).unwrap();
    assert!(matches!(write(&folder, &FILES), Err(PackageError::Manifest { .. })));
    assert!(scratch.path().join("victim").exists());
}

#[test]
fn an_edited_file_stops_the_next_run_before_anything_is_written() {
    let (_scratch, folder) = written();
    fs::write(
        folder.join("rtl/shaper_x.v"),
        "module shaper_x; /* my fix */ endmodule\n",
    )
    .unwrap();
    let before = snapshot(&folder);
    for files in [&FILES[..], &FILES[..2]] {
        let error = write(&folder, files).unwrap_err();
        assert!(
            matches!(&error, PackageError::Edited { files, .. } if files == &["rtl/shaper_x.v"]),
            "{error}"
        );
        assert!(error.to_string().contains("move it away or delete it"), "{error}");
        assert_eq!(snapshot(&folder), before);
    }
    assert!(package::read(&folder).is_ok(), "what was edited can still be verified");
    fs::remove_file(folder.join("rtl/shaper_x.v")).unwrap();
    write(&folder, &FILES).unwrap();
}

#[test]
fn an_edit_during_the_run_is_seen_at_the_end() {
    let (_scratch, folder) = written();
    let mut package = Package::open(&folder, "xy_stage").unwrap();
    package.add("machine.toml", b"new").unwrap();
    fs::write(folder.join("machine.toml"), "edited").unwrap();
    assert!(matches!(package.commit(), Err(PackageError::Edited { .. })));
    assert_eq!(fs::read_to_string(folder.join("machine.toml")).unwrap(), "edited");
}

#[test]
fn an_edit_that_equals_the_new_file_is_not_a_conflict() {
    let (_scratch, folder) = written();
    let mut package = Package::open(&folder, "xy_stage").unwrap();
    package.add("machine.toml", b"new").unwrap();
    fs::write(folder.join("machine.toml"), "new").unwrap();
    package.commit().unwrap();
}

#[test]
fn files_no_longer_produced_are_removed_and_extra_files_stay() {
    let (_scratch, folder) = written();
    fs::write(folder.join("notes.txt"), "mine").unwrap();
    write(&folder, &[("machine.toml", "x"), ("sopc/driver.h", "y")]).unwrap();
    let left: Vec<_> = snapshot(&folder).into_keys().collect();
    assert_eq!(
        left,
        ["machine.toml", "notes.txt", "posicast.json", "sopc/driver.h"].map(PathBuf::from)
    );
    assert!(!folder.join("rtl").exists(), "folders that became empty go too");
}

#[test]
fn a_file_in_the_way_is_never_overwritten() {
    let (_scratch, folder) = written();
    fs::write(folder.join("report.json"), "mine").unwrap();
    let before = snapshot(&folder);
    let error = write(&folder, &[("report.json", "{}")]).unwrap_err();
    assert!(
        matches!(&error, PackageError::InTheWay { files, .. } if files == &["report.json"]),
        "{error}"
    );
    assert_eq!(snapshot(&folder), before);
}

#[cfg(unix)]
#[test]
fn links_are_not_followed_out_of_the_folder() {
    let (scratch, folder) = written();
    let outside = scratch.path().join("outside");
    fs::rename(folder.join("rtl"), &outside).unwrap();
    std::os::unix::fs::symlink(&outside, folder.join("rtl")).unwrap();
    let before = snapshot(&outside);
    let error = write(&folder, &FILES[..1]).unwrap_err();
    assert!(
        matches!(error, PackageError::WrongType { found: "a link", .. }),
        "{error}"
    );
    assert_eq!(snapshot(&outside), before);
}

#[test]
fn a_dropped_package_leaves_nothing() {
    let scratch = tempfile::tempdir().unwrap();
    let folder = scratch.path().join("a/out");
    let mut package = Package::open(&folder, "xy_stage").unwrap();
    package.add("rtl/a.v", b"module a; endmodule").unwrap();
    assert!(!folder.join("rtl").exists(), "nothing shows before commit");
    drop(package);
    assert!(!scratch.path().join("a").exists());
}

#[test]
fn an_announced_file_that_nobody_wrote_is_an_error() {
    let (_scratch, folder) = written();
    let before = snapshot(&folder);
    let mut package = Package::open(&folder, "xy_stage").unwrap();
    package.add("machine.toml", b"new").unwrap();
    package.stage("wave/rtl.vcd").unwrap();
    assert!(matches!(package.commit(), Err(PackageError::NotWritten(path)) if path == "wave/rtl.vcd"));
    assert_eq!(snapshot(&folder), before);
}

#[test]
fn invalid_and_repeated_paths_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let mut package = Package::open(folder.path(), "m").unwrap();
    assert!(matches!(package.add("../evil", b""), Err(PackageError::Path { .. })));
    package.add("a", b"1").unwrap();
    assert!(matches!(package.add("a", b"2"), Err(PackageError::Twice(_))));
}

#[test]
fn two_runs_on_one_folder_exclude_each_other() {
    let scratch = tempfile::tempdir().unwrap();
    let first = Package::open(scratch.path(), "m").unwrap();
    assert!(matches!(Package::open(scratch.path(), "m"), Err(PackageError::Busy(_))));
    drop(first);
    assert!(Package::open(scratch.path(), "m").is_ok());
}

#[test]
fn staged_files_of_a_killed_run_are_removed() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir_all(folder.path().join(".posicast-staging/rtl")).unwrap();
    write(folder.path(), &FILES).unwrap();
    assert_eq!(snapshot(folder.path()).len(), 4);
    assert!(!folder.path().join(".posicast-staging").exists());
}

#[test]
fn a_file_where_a_folder_belongs_is_refused_untouched() {
    let (_scratch, folder) = written();
    fs::write(folder.join("wave"), "mine").unwrap();
    let before = snapshot(&folder);
    let error = write(&folder, &[("machine.toml", "new"), ("wave/rtl.vcd", "new")]).unwrap_err();
    assert!(
        matches!(error, PackageError::WrongType { found: "a file", .. }),
        "{error}"
    );
    assert_eq!(snapshot(&folder), before);
}

#[test]
fn what_is_missing_is_named() {
    let (_scratch, folder) = written();
    let files = package::read(&folder).unwrap().rtl;
    let text = fs::read(&files[0]).unwrap();
    fs::remove_file(&files[0]).unwrap();
    fs::write(folder.join("rtl/other.v"), "").unwrap();
    assert!(matches!(package::read(&folder), Err(PackageError::Missing(path)) if path == files[0]));
    fs::remove_file(folder.join("rtl/other.v")).unwrap();
    fs::write(&files[0], text).unwrap();
    fs::remove_file(folder.join("machine.toml")).unwrap();
    assert!(matches!(package::read(&folder), Err(PackageError::Missing(path)) if path.ends_with("machine.toml")));
    write(&folder, &FILES[..1]).unwrap();
    assert!(matches!(package::read(&folder), Err(PackageError::Missing(path)) if path.ends_with("rtl")));
    assert!(matches!(
        package::read(&folder.join("nowhere")),
        Err(PackageError::Missing(_))
    ));
}

/// Writes a package of these files with this evidence.
fn write_with_evidence(
    folder: &Path,
    files: &[(&str, &str)],
    evidence: &[(&str, &str)],
) -> Result<Committed, PackageError> {
    let mut package = Package::open(folder, "xy_stage")?.with_evidence()?;
    for (path, text) in files {
        package.add(path, text.as_bytes())?;
    }
    for (path, text) in evidence {
        package.add_evidence(path, text.as_bytes())?;
    }
    package.commit()
}

const EVIDENCE: [(&str, &str); 2] = [("report.json", "{\"result\": \"pass\"}\n"), ("wave/rtl.vcd", "$end\n")];

/// Returns [`FILES`] with another machine file, and a file whose name evidence may also have.
fn generated(machine: &'static str) -> Vec<(&'static str, &'static str)> {
    let mut files = FILES.to_vec();
    files[0].1 = machine;
    files.extend([("report.json", "{\"name\": \"xy_stage\"}\n"), ("driver/a.h", "//\n")]);
    files
}

#[test]
fn evidence_stays_while_machine_file_and_verilog_are_unchanged() {
    let scratch = tempfile::tempdir().unwrap();
    let folder = scratch.path().join("out");
    let files = &generated("1\n");
    let without_report: Vec<_> = files
        .iter()
        .copied()
        .filter(|(path, _)| *path != "report.json")
        .collect();
    write(&folder, files).unwrap();
    let committed = write_with_evidence(&folder, &without_report, &EVIDENCE).unwrap();
    assert!(
        committed.removed.is_empty() && committed.outdated.is_empty(),
        "{committed:?}"
    );
    let after_run = snapshot(&folder);
    assert_eq!(after_run.len(), 7, "both beside each other: {:?}", after_run.keys());
    let committed = write(&folder, files).unwrap();
    assert_eq!(committed.kept, ["report.json", "wave/rtl.vcd"]);
    assert_eq!(snapshot(&folder), after_run, "nothing of the run was lost");

    // A file of it that the user changed is not touched as long as it stays.
    fs::write(folder.join("wave/rtl.vcd"), "edited").unwrap();
    assert_eq!(write(&folder, files).unwrap().kept, ["report.json", "wave/rtl.vcd"]);
    let error = write_with_evidence(&folder, &without_report, &EVIDENCE).unwrap_err();
    assert!(matches!(error, PackageError::Edited { .. }), "{error}");
    let before = snapshot(&folder);
    let error = write(&folder, &generated("2\n")).unwrap_err();
    assert!(matches!(error, PackageError::Edited { .. }), "{error}");
    assert_eq!(snapshot(&folder), before);
}

#[test]
fn evidence_of_another_machine_file_or_other_verilog_goes_and_is_named() {
    let other_verilog = {
        let mut files = generated("1\n");
        files[1].1 = "module other; endmodule\n";
        files
    };
    let one_file_less = generated("1\n")
        .into_iter()
        .filter(|(path, _)| *path != "rtl/shaper_x.v");
    for (changed, removed) in [(generated("2\n"), 0), (other_verilog, 0), (one_file_less.collect(), 1)] {
        let scratch = tempfile::tempdir().unwrap();
        let folder = scratch.path().join("out");
        let files = generated("1\n");
        let files: Vec<_> = files.into_iter().filter(|(path, _)| *path != "report.json").collect();
        write_with_evidence(&folder, &files, &EVIDENCE).unwrap();
        let committed = write(&folder, &changed).unwrap();
        assert_eq!(committed.outdated, ["report.json", "wave/rtl.vcd"]);
        assert_eq!(committed.removed.len(), removed);
        assert!(!folder.join("wave").exists());
        let report = fs::read_to_string(folder.join("report.json")).unwrap();
        assert!(report.contains("name"), "{report}");
        // It does not return with the machine file.
        assert!(write(&folder, &generated("1\n")).unwrap().kept.is_empty());
    }
}

#[test]
fn evidence_that_the_user_deleted_is_not_missed() {
    let scratch = tempfile::tempdir().unwrap();
    let folder = scratch.path().join("out");
    let files: Vec<_> = generated("1\n")
        .into_iter()
        .filter(|(path, _)| *path != "report.json")
        .collect();
    write_with_evidence(&folder, &files, &EVIDENCE).unwrap();
    fs::remove_file(folder.join("report.json")).unwrap();
    assert_eq!(write(&folder, &generated("1\n")).unwrap().kept, ["wave/rtl.vcd"]);
    assert!(folder.join("report.json").exists(), "the package's own takes its place");
}
