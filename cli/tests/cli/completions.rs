//! `posicast completions`, `posicast man` and `posicast --version`.

use crate::cli::support::posicast;

fn output(words: &[&str]) -> String {
    let output = posicast().args(words).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{words:?}");
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn every_shell_completes_every_command() {
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let script = output(&["completions", shell]);
        for word in ["doctor", "reproduce", "--json"] {
            let word = if shell == "fish" {
                word.trim_start_matches('-')
            } else {
                word
            };
            assert!(script.contains(word), "{shell}: {word}");
        }
    }
    assert_eq!(
        posicast().args(["completions", "csh"]).output().unwrap().status.code(),
        Some(2)
    );
}

#[test]
fn each_command_has_a_manual_page_and_pages_of_others_stay() {
    let folder = tempfile::tempdir().unwrap();
    let pages = folder.path().join("share/man1");
    let man = |words: &[&str]| posicast().arg("man").arg(&pages).args(words).output().unwrap();
    for _ in 0..2 {
        assert_eq!(man(&[]).status.code(), Some(0), "the second time they are ours");
    }
    let page = std::fs::read_to_string(pages.join("posicast-run.1")).unwrap();
    assert!(page.starts_with(".\\\" written by posicast "), "{page}");
    assert!(
        page.contains("posicast\\-run") && page.contains("Machine file"),
        "{page}"
    );
    // The synopsis has the values, and every page has its exit status.
    assert!(
        page.contains(r"[\fB\-o|\-\-output\fR \fIDIR\fR]") && page.contains(r"] \fIMACHINE\fR"),
        "{page}"
    );
    for name in ["posicast", "posicast-run", "posicast-new", "posicast-diff"] {
        let page = std::fs::read_to_string(pages.join(format!("{name}.1"))).unwrap();
        let (_, status) = page.split_once(".SH \"EXIT STATUS\"\n").expect(name);
        assert!(status.starts_with("0 ") && status.contains("130 "), "{page}");
        assert!(page.contains(".SH EXAMPLES") && !page.contains("EXTRA"), "{page}");
    }
    assert!(pages.join("posicast.1").is_file() && pages.join("posicast-identify.1").is_file());
    std::fs::write(pages.join("posicast-run.1"), "mine").unwrap();
    let refused = man(&[]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8(refused.stderr).unwrap().contains("--force"));
    assert_eq!(std::fs::read_to_string(pages.join("posicast-run.1")).unwrap(), "mine");
}

#[test]
fn the_version_has_the_commit_of_a_checkout() {
    let version = output(&["--version"]);
    let version = version.trim();
    let plain = format!("posicast {}", env!("CARGO_PKG_VERSION"));
    let rest = version.strip_prefix(&plain).unwrap();
    let commit = rest.strip_prefix(" (").and_then(|rest| rest.strip_suffix(')'));
    let is_hash = |hash: &str| hash.len() >= 7 && hash.bytes().all(|byte| byte.is_ascii_hexdigit());
    assert!(rest.is_empty() || commit.is_some_and(is_hash), "{version}");
}
