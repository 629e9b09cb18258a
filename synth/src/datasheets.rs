//! The datasheets of the blocks, to which registers and Verilog refer: pages of `docs/`, copied into the output
//! folder.
//!
//! They are in the folder's `docs/`, as in the project. A link to a page that is not copied is replaced by its text.

use posicast_blocks::bus_component::BridgedBus;

/// Folder of the datasheets in the output folder.
pub const FOLDER: &str = "docs";

macro_rules! pages {
    ($($name:literal)*) => {
        [$(($name, include_str!(concat!("../datasheets/", $name, ".md")))),*]
    };
}

/// Datasheets of every machine.
const SHAPER: [(&str, &str); 1] = pages!["shaper"];
/// Datasheets of machines with components.
const COMPONENTS: [(&str, &str); 5] = pages!["registers" "pulse_counter" "divider" "pwm" "sliding_mode"];
/// Datasheets of machines with a stage.
const STAGE: [(&str, &str); 13] = pages![
    "stage" "axis" "segments" "drive_command" "linear_scale" "error_table" "encoder_generator" "excitation" "trace"
    "step_generator" "compare" "capture" "absolute_encoder"
];
/// Datasheets of machines whose stage or inline shaper has a line to a host.
const LINK: [(&str, &str); 1] = pages!["uart_bridge"];
/// Datasheets of machines whose line is SPI; its frames are described in the page above.
const SPI_LINK: [(&str, &str); 1] = pages!["spi_bridge"];

/// Datasheets of the bridges to other buses, by the name of the block.
const BUS: [(&str, &str); 2] = pages!["axi_lite_bridge" "wishbone_bridge"];
/// Datasheets of machines with an inline shaper.
const INLINE: [(&str, &str); 4] = pages!["inline" "inline_axis" "pulse_counter" "step_generator"];

/// Datasheets of machines with a shaper of half sums.
const CASCADE: [(&str, &str); 1] = pages!["cascade"];

/// Hardware of a machine in addition to the shapers of its top module.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum BuiltBlocks {
    /// None.
    Shapers,
    /// Blocks of axes, as components on a bus.
    Components,
    /// Blocks of axes joined to a stage.
    Stage,
    /// A stage with a serial line.
    LinkedStage,
    /// A stage with SPI lines.
    SpiLinkedStage,
    /// An inline shaper.
    Inline,
    /// An inline shaper with a serial line.
    LinkedInline,
    /// An inline shaper with SPI lines.
    SpiLinkedInline,
}

/// The datasheets of a machine whose registers are on this bus if not on Avalon-MM, as path in the output folder and text.
/// `has_cascade`: a shaper of its top module is made of half sums.
pub fn files(built: BuiltBlocks, bus: Option<BridgedBus>, has_cascade: bool) -> Vec<(String, String)> {
    let is_inline = built >= BuiltBlocks::Inline;
    let at_least = |least| move |_: &&(&str, &str)| !is_inline && built >= least;
    let components = COMPONENTS.iter().filter(at_least(BuiltBlocks::Components));
    let stage = STAGE.iter().filter(at_least(BuiltBlocks::Stage));
    let linked = built > BuiltBlocks::Inline || (!is_inline && built >= BuiltBlocks::LinkedStage);
    let with_spi = matches!(built, BuiltBlocks::SpiLinkedStage | BuiltBlocks::SpiLinkedInline);
    let link = LINK.iter().filter(|_| linked);
    let spi = SPI_LINK.iter().filter(|_| with_spi);
    let registers = COMPONENTS.iter().filter(|(name, _)| *name == "registers");
    let registers = registers.filter(|_| built > BuiltBlocks::Inline);
    let pages: Vec<_> = SHAPER
        .iter()
        .chain(CASCADE.iter().filter(|_| has_cascade))
        .chain(components)
        .chain(stage)
        .chain(link)
        .chain(spi)
        .chain(
            BUS.iter()
                .filter(|(name, _)| bus.is_some_and(|bus| bus.block() == *name)),
        )
        .chain(INLINE.iter().filter(|_| is_inline))
        .chain(registers)
        .collect();
    with_links(&pages)
}

/// The datasheets of a block alone: its own, if it has one, and those of registers and buses if it has registers.
pub fn of_block(name: &str, has_registers: bool) -> Vec<(String, String)> {
    let all = (SHAPER
        .iter()
        .chain(&COMPONENTS)
        .chain(&STAGE)
        .chain(&LINK)
        .chain(&SPI_LINK))
    .chain(&BUS)
    .chain(&INLINE)
    .chain(&CASCADE);
    let is_bus = |page: &str| page == "registers" || BUS.iter().any(|(bus, _)| *bus == page);
    let mut pages: Vec<_> = all
        .filter(|(page, _)| *page == name || (has_registers && is_bus(page)))
        .collect();
    // A page may be one of several kinds of machines.
    pages.sort_unstable();
    pages.dedup();
    with_links(&pages)
}

/// The pages as files, with links to each other.
fn with_links(pages: &[&(&str, &str)]) -> Vec<(String, String)> {
    let is_there = |name: &str| pages.iter().any(|(page, _)| *page == name);
    let file = |(name, text): &&(&str, &str)| (format!("{FOLDER}/{name}.md"), with_links_to(text, is_there));
    pages.iter().map(file).collect()
}

/// Returns the page; links to other pages are kept only if `is_there` returns `true` for the page's name.
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

/// The first link: the text before it, its label, its target, and the text after it.
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
    fn links_to_missing_pages_become_text() {
        let text = "see [the pin rule](pwm.md#the-pin-rule), [area](area.md) and [below](#below), x[0] (y)";
        let kept = with_links_to(text, |name| name == "pwm");
        assert_eq!(
            kept,
            "see [the pin rule](pwm.md#the-pin-rule), area and [below](#below), x[0] (y)"
        );
    }

    #[test]
    fn every_page_that_a_folder_links_to_is_in_it() {
        let with_cascade = files(BuiltBlocks::Shapers, None, true);
        assert!(with_cascade.iter().any(|(path, _)| path == "docs/cascade.md"));
        for (built, pages) in [
            (BuiltBlocks::Shapers, 1),
            (BuiltBlocks::Components, 6),
            (BuiltBlocks::Stage, 19),
            (BuiltBlocks::LinkedStage, 20),
            (BuiltBlocks::Inline, 5),
        ] {
            let files = files(built, None, false);
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
