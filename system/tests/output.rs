//! The files that a command may write to, and their contents after it.

use posicast_system::output::{Draft, OutputError, OutputFiles, is_ours, write_text};
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

struct Scratch(tempfile::TempDir);

impl Scratch {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn file(&self, name: &str, text: &str) -> PathBuf {
        fs::write(self.path(name), text).unwrap();
        self.path(name)
    }

    fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<String> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }
}

fn claim(force: bool, path: &Path) -> Result<(), OutputError> {
    OutputFiles::new(force).claim("--plot", path)
}

#[test]
fn a_machine_file_is_replaced_by_a_machine_file_alone() {
    let scratch = Scratch::new();
    let path = scratch.path("mill.toml");
    write_text(&path, "name = 1\n").unwrap();
    assert!(matches!(claim(false, &path), Err(OutputError::MachineFile { .. })));
    OutputFiles::new(false).claim_machine_file("-o", &path).unwrap();
    claim(true, &path).unwrap();
    let mut outputs = OutputFiles::new(false);
    outputs.input("the machine file", &path);
    assert!(matches!(outputs.claim("--plot", &path), Err(OutputError::Input { .. })));
    fs::write(&path, "name = 2\n").unwrap();
    assert!(matches!(claim(false, &path), Err(OutputError::Foreign { .. })));
}

#[test]
fn a_file_of_posicast_is_known_as_long_as_nobody_changes_it() {
    let scratch = Scratch::new();
    for text in [
        "<svg/>\n",
        "<?xml version=\"1.0\"?>\n<a/>\n",
        "[size] 1 2\n",
        "zoom_fit\n",
    ] {
        let path = scratch.path("file");
        write_text(&path, text).unwrap();
        let written = fs::read_to_string(&path).unwrap();
        assert!(is_ours(&path).unwrap(), "{written}");
        assert!(!written.contains(&"0".repeat(64)), "{written}");
        claim(false, &path).unwrap();
        write_text(&path, text).unwrap();
        assert_eq!(
            fs::read_to_string(&path).unwrap(),
            written,
            "the same text gives the same bytes"
        );
        for changed in [
            written.clone() + " ",
            written.replacen("posicast", "Posicast", 1),
            written.replace('s', "S"),
            String::new(),
        ] {
            fs::write(&path, changed).unwrap();
            assert!(!is_ours(&path).unwrap());
            assert!(matches!(claim(false, &path), Err(OutputError::Foreign { .. })));
            claim(true, &path).unwrap();
        }
        fs::remove_file(&path).unwrap();
    }
}

#[test]
fn a_long_file_is_sealed_to_its_end() {
    let scratch = Scratch::new();
    let path = scratch.path("long");
    let mut draft = Draft::new(&path).unwrap();
    writeln!(draft, "$comment {} $end", posicast_system::output::seal::blank()).unwrap();
    for n in 0..100_000 {
        writeln!(draft, "#{n}").unwrap();
    }
    assert!(!path.exists(), "not before it is complete");
    draft.put().unwrap();
    assert!(is_ours(&path).unwrap());
    let mut text = fs::read(&path).unwrap();
    *text.last_mut().unwrap() = b' ';
    fs::write(&path, text).unwrap();
    assert!(!is_ours(&path).unwrap());
}

#[test]
fn a_draft_that_is_dropped_leaves_nothing() {
    let scratch = Scratch::new();
    let path = scratch.file("file", "mine");
    let mut draft = Draft::new(&path).unwrap();
    draft.write_all(b"half").unwrap();
    drop(draft);
    assert_eq!(scratch.names(), ["file"]);
    assert_eq!(fs::read_to_string(&path).unwrap(), "mine");
}

#[cfg(unix)]
#[test]
fn an_input_is_never_replaced_under_whatever_name() {
    let scratch = Scratch::new();
    let input = scratch.path("machine.toml");
    // Even a file of posicast's own is an input here.
    write_text(&input, "a\n").unwrap();
    fs::create_dir(scratch.path("folder")).unwrap();
    std::os::unix::fs::symlink(&input, scratch.path("link")).unwrap();
    std::os::unix::fs::symlink(scratch.0.path(), scratch.path("folder/up")).unwrap();
    fs::hard_link(&input, scratch.path("hard")).unwrap();
    for name in [
        "machine.toml",
        "link",
        "hard",
        "folder/../machine.toml",
        "folder/up/link",
    ] {
        for force in [false, true] {
            for input in ["machine.toml", "link", "folder/../hard"] {
                let mut outputs = OutputFiles::new(force);
                outputs.input("the machine file", &scratch.path(input));
                let error = outputs.claim("--plot", &scratch.path(name)).unwrap_err();
                assert!(matches!(error, OutputError::Input { .. }), "{name}: {error}");
                let said = error.to_string();
                assert!(
                    said.contains("--plot") && said.contains(name) && said.contains("the machine file"),
                    "{said}"
                );
            }
        }
    }
}

#[test]
fn what_is_no_place_for_a_file_is_told() {
    let scratch = Scratch::new();
    assert!(matches!(claim(true, scratch.0.path()), Err(OutputError::Folder { .. })));
    assert!(matches!(
        claim(true, &scratch.path("no/file")),
        Err(OutputError::NoFolder { .. })
    ));
    let file = scratch.file("file", "");
    assert!(matches!(
        claim(true, &file.join("inside")),
        Err(OutputError::Io { .. } | OutputError::NoFolder { .. })
    ));
    let mut outputs = OutputFiles::new(false);
    outputs.claim("--junit", &scratch.path("new")).unwrap();
    let again = scratch.0.path().join(".").join("new");
    assert!(matches!(
        outputs.claim("--show", &again),
        Err(OutputError::Twice { .. })
    ));
}

#[cfg(unix)]
#[test]
fn a_link_stays_and_the_file_behind_it_is_written() {
    let scratch = Scratch::new();
    std::os::unix::fs::symlink("behind", scratch.path("link")).unwrap();
    for text in ["one\n", "two\n"] {
        claim(false, &scratch.path("link")).unwrap();
        write_text(&scratch.path("link"), text).unwrap();
        assert!(fs::read_to_string(scratch.path("behind")).unwrap().starts_with(text));
    }
    assert!(scratch.path("link").symlink_metadata().unwrap().is_symlink());
    assert_eq!(scratch.names(), ["behind", "link"]);
}

#[cfg(unix)]
#[test]
fn a_device_or_a_pipe_is_written_to_and_stays() {
    let null = Path::new("/dev/null");
    claim(false, null).unwrap();
    write_text(null, "gone\n").unwrap();
    assert!(!null.metadata().unwrap().is_file());

    let scratch = Scratch::new();
    let pipe = scratch.path("pipe");
    assert!(
        std::process::Command::new("mkfifo")
            .arg(&pipe)
            .status()
            .unwrap()
            .success()
    );
    claim(false, &pipe).unwrap();
    let reader = std::thread::spawn({
        let pipe = pipe.clone();
        move || fs::read_to_string(pipe).unwrap()
    });
    write_text(&pipe, "through\n").unwrap();
    assert!(reader.join().unwrap().starts_with("through\n"));
    assert_eq!(scratch.names(), ["pipe"]);
}
