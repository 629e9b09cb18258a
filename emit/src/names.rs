//! Rules for names in the Verilog: lower-case snake case that no tool reserves.

use super::error::EmitCause;
use std::collections::{BTreeMap, HashSet};
use std::sync::LazyLock;

/// Keywords of Verilog (IEEE 1364-2001 and -2005) and SystemVerilog (IEEE 1800-2017), annex B of each.
const RESERVED: &str = "\
    accept_on alias always always_comb always_ff always_latch and assert assign assume automatic before begin bind \
    bins binsof bit break buf bufif0 bufif1 byte case casex casez cell chandle checker class clocking cmos config \
    const constraint context continue cover covergroup coverpoint cross deassign default defparam design disable dist \
    do edge else end endcase endchecker endclass endclocking endconfig endfunction endgenerate endgroup endinterface \
    endmodule endpackage endprimitive endprogram endproperty endsequence endspecify endtable endtask enum event \
    eventually expect export extends extern final first_match for force foreach forever fork forkjoin function \
    generate genvar global highz0 highz1 if iff ifnone ignore_bins illegal_bins implements implies import incdir \
    include initial inout input inside instance int integer interconnect interface intersect join join_any join_none \
    large let liblist library local localparam logic longint macromodule matches medium modport module nand negedge \
    nettype new nexttime nmos nor noshowcancelled not notif0 notif1 null or output package packed parameter pmos \
    posedge primitive priority program property protected pull0 pull1 pulldown pullup pulsestyle_ondetect \
    pulsestyle_onevent pure rand randc randcase randsequence rcmos real realtime ref reg reject_on release repeat \
    restrict return rnmos rpmos rtran rtranif0 rtranif1 s_always s_eventually s_nexttime s_until s_until_with scalared \
    sequence shortint shortreal showcancelled signed small soft solve specify specparam static string strong strong0 \
    strong1 struct super supply0 supply1 sync_accept_on sync_reject_on table tagged task this throughout time \
    timeprecision timeunit tran tranif0 tranif1 tri tri0 tri1 triand trior trireg type typedef union unique unique0 \
    unsigned until until_with untyped use uwire var vectored virtual void wait wait_order wand weak weak0 weak1 while \
    wildcard wire with within wor xnor xor";

/// The same, to be looked up: every net of every module is.
static RESERVED_WORDS: LazyLock<HashSet<&str>> = LazyLock::new(|| RESERVED.split(' ').collect());

/// Checks a name that is used by itself in the Verilog.
///
/// # Errors
/// [`EmitCause::BadName`] if it is not plain lower-case snake case, [`EmitCause::ReservedWord`] if it is a keyword of
/// Verilog or SystemVerilog.
pub fn check_name(name: &str) -> Result<(), EmitCause> {
    check_form(name)?;
    if RESERVED_WORDS.contains(name) {
        return Err(EmitCause::ReservedWord(name.to_owned()));
    }
    Ok(())
}

/// Checks a name that is only used as part of another, and may be a keyword.
pub(super) fn check_form(name: &str) -> Result<(), EmitCause> {
    let mut characters = name.chars();
    let plain = characters.next().is_some_and(|first| first.is_ascii_lowercase())
        && characters.all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_');
    if plain {
        Ok(())
    } else {
        Err(EmitCause::BadName(name.to_owned()))
    }
}

/// Prefix of the modules that are the same for every machine.
pub const LIBRARY: &str = "posicast";

/// The full name of a module: `posicast_BASE` if it is the same for every machine, `PREFIX_BASE` if its contents depend
/// on the machine, and the base alone without a prefix, as in a bench.
pub(super) fn module_name(prefix: &str, of_machine: bool, base: &str) -> String {
    match (prefix, of_machine) {
        ("", _) => base.to_owned(),
        (prefix, true) => format!("{prefix}_{base}"),
        (_, false) => format!("{LIBRARY}_{base}"),
    }
}

/// Converts RustHDL's path of a signal (`bus$value$0`, `State$Idle`) to a part of a Verilog name (`bus_value_0`).
pub(super) fn flatten(raw: &str) -> String {
    raw.replace('$', "_")
}

/// Converts `State$HoldOff` to the name of a constant: `STATE_HOLD_OFF`.
pub(super) fn constant_name(raw: &str) -> String {
    let mut name = String::new();
    let mut after_small = false;
    for c in raw.chars() {
        if after_small && c.is_ascii_uppercase() {
            name.push('_');
        }
        after_small = c.is_ascii_lowercase() || c.is_ascii_digit();
        name.push(if c == '$' { '_' } else { c.to_ascii_uppercase() });
    }
    name
}

/// The names of one Verilog scope, each with its owner.
#[derive(Debug, Default)]
pub(super) struct Taken(BTreeMap<String, String>);

impl Taken {
    /// Reserves `name` for `owner`.
    pub(super) fn take(&mut self, name: &str, owner: &str) -> Result<(), EmitCause> {
        match self.0.insert(name.to_owned(), owner.to_owned()) {
            None => Ok(()),
            Some(other) => Err(EmitCause::NameCollision {
                name: name.to_owned(),
                other,
            }),
        }
    }
}

/// First words in the name of a constant 0 that only repeats its value.
const NOTHING: [&str; 6] = ["NO", "NONE", "NOTHING", "NOBODY", "NIL", "ZERO"];

/// Whether the name of a constant only repeats its value: `NO_CLOCKS` for 0, `ONE_TICK` for 1, `CHANNEL_2` for 2. Such
/// a constant is written as a literal.
pub(super) fn says_its_value(name: &str, value: u64) -> bool {
    let first = name.split('_').next().unwrap_or_default();
    match value {
        0 if NOTHING.contains(&first) => true,
        1 if first == "ONE" => true,
        _ => name.rsplit_once('_').is_some_and(|(_, last)| last == value.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reserved_words_are_found() {
        for word in [
            "always",
            "bit",
            "initial",
            "logic",
            "signed",
            "output",
            "xor",
            "within",
            "accept_on",
        ] {
            assert_eq!(check_name(word), Err(EmitCause::ReservedWord(word.to_owned())));
        }
    }

    #[test]
    fn names_are_lower_snake_case() {
        assert_eq!(check_name("tap_3"), Ok(()));
        assert_eq!(check_form("small"), Ok(()));
        for bad in ["", "Tap", "3d", "_x", "a$b", "a-b", "größe"] {
            assert_eq!(check_name(bad), Err(EmitCause::BadName(bad.to_owned())));
        }
    }

    #[test]
    fn a_name_that_says_its_value_is_told_from_one_that_says_more() {
        let says = [("NO_CLOCKS", 0), ("NOTHING", 0), ("ONE_TICK", 1), ("CHANNEL_2", 2)];
        assert!(says.iter().all(|(name, value)| says_its_value(name, *value)));
        let more = [
            ("NO_CLOCKS", 3),
            ("ONE_TICK", 2),
            ("FIRST_TAP", 0),
            ("AXIS_0", 1),
            ("NORTH", 0),
        ];
        assert!(!more.iter().any(|(name, value)| says_its_value(name, *value)));
    }

    #[test]
    fn constants_are_upper_snake_case() {
        assert_eq!(constant_name("State$HoldOff"), "STATE_HOLD_OFF");
        assert_eq!(constant_name("one_a"), "ONE_A");
        assert_eq!(constant_name("limit$0"), "LIMIT_0");
    }
}
