//! The datasheets of the blocks, which registers and Verilog name: the pages of `docs/`, for the output folder.
//!
//! They stand in `docs/` of the folder, as in the project. A link to a page that does not go with them becomes its words.

/// Folder of the datasheets in the output folder.
pub const FOLDER: &str = "docs";

macro_rules! pages {
    ($($name:literal)*) => {
        [$(($name, include_str!(concat!("../datasheets/", $name, ".md")))),*]
    };
}

/// Of every machine.
const SHAPER: [(&str, &str); 1] = pages!["shaper"];
/// Of machines with components.
const COMPONENTS: [(&str, &str); 5] = pages!["registers" "pulse_counter" "divider" "pwm" "sliding_mode"];
/// Of machines with a stage.
const STAGE: [(&str, &str); 9] = pages![
    "stage" "axis" "segments" "drive_command" "linear_scale" "error_table" "encoder_generator" "excitation" "trace"
];

/// What a machine has beside the shapers of its top module.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum BuiltBlocks {
    /// Nothing.
    Shapers,
    /// Blocks of axes, as components on a bus.
    Components,
    /// Those, joined to a stage.
    Stage,
}

/// The datasheets of a machine, as path in the output folder and text.
pub fn files(built: BuiltBlocks) -> Vec<(String, String)> {
    let components = COMPONENTS.iter().filter(|_| built >= BuiltBlocks::Components);
    let stage = STAGE.iter().filter(|_| built >= BuiltBlocks::Stage);
    let pages: Vec<_> = SHAPER.iter().chain(components).chain(stage).collect();
    let is_there = |name: &str| pages.iter().any(|(page, _)| *page == name);
    let file = |(name, text): &&(&str, &str)| (format!("{FOLDER}/{name}.md"), with_links_to(text, is_there));
    pages.iter().map(file).collect()
}

/// A page whose links to other pages are kept where `is_there` knows the page's name.
fn with_links_to(text: &str, is_there: impl Fn(&str) -> bool) -> String {
    let mut rest = text;
    let mut page = String::with_capacity(text.len());
    while let Some((before, words, target, after)) = link(rest) {
        page.push_str(before);
        let name = target.split('#').next().unwrap_or_default();
        match name.strip_suffix(".md") {
            Some(name) if !is_there(name) => page.push_str(words),
            _ => page.push_str(&format!("[{words}]({target})")),
        }
        rest = after;
    }
    page + rest
}

/// The first link: what is before it, its words, its target, what is after it.
fn link(text: &str) -> Option<(&str, &str, &str, &str)> {
    let middle = text.find("](")?;
    let begin = text[..middle].rfind('[')?;
    let end = middle + text[middle..].find(')')?;
    Some((
        &text[..begin],
        &text[begin + 1..middle],
        &text[middle + 2..end],
        &text[end + 1..],
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_links_to_pages_that_are_missing_become_words() {
        let text = "see [the pin rule](pwm.md#the-pin-rule), [area](area.md) and [below](#below), x[0] (y)";
        let kept = with_links_to(text, |name| name == "pwm");
        assert_eq!(
            kept,
            "see [the pin rule](pwm.md#the-pin-rule), area and [below](#below), x[0] (y)"
        );
    }

    #[test]
    fn unit_every_page_that_a_folder_links_to_is_in_it() {
        for (built, pages) in [
            (BuiltBlocks::Shapers, 1),
            (BuiltBlocks::Components, 6),
            (BuiltBlocks::Stage, 15),
        ] {
            let files = files(built);
            assert_eq!(files.len(), pages);
            for (_, text) in &files {
                for (at, _) in text.match_indices("](") {
                    let target = text[at + 2..].split([')', '#']).next().unwrap_or_default();
                    let path = format!("{FOLDER}/{target}");
                    assert!(
                        !target.ends_with(".md") || files.iter().any(|file| file.0 == path),
                        "{target}"
                    );
                }
            }
        }
    }
}
