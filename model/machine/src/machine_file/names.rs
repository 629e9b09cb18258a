//! Names that become Verilog identifiers.

/// Longest name of a machine or axis, in characters. Verilog and C join names to longer ones.
pub(super) const MAX_NAME_LENGTH: usize = 64;

/// Rule for a name, for messages.
pub(super) const NAME_RULE: &str = "[a-z][a-z0-9_]*, at most 64 characters, no Verilog or SystemVerilog keyword, no name of a hardware block, not beginning with posicast";

/// Prefix of the modules that are the same for every machine.
const LIBRARY: &str = "posicast";

/// Reserved names of this project: the hardware blocks, which are module names, and the ports that every module has.
const RESERVED: &[&str] = &[
    "axis",
    "cascade",
    "clk",
    "pulse_counter",
    "pwm",
    "registers",
    "rst",
    "shaper",
    "sliding_mode",
    "stage",
];

/// Reserved words of Verilog-2001 and SystemVerilog (IEEE 1800-2017, annex B).
const KEYWORDS: &str = "
accept_on alias always always_comb always_ff always_latch and assert assign assume automatic before begin bind bins
binsof bit break buf bufif0 bufif1 byte case casex casez cell chandle checker class clocking cmos config const
constraint context continue cover covergroup coverpoint cross deassign default defparam design disable dist do edge
else end endcase endchecker endclass endclocking endconfig endfunction endgenerate endgroup endinterface endmodule
endpackage endprimitive endprogram endproperty endsequence endspecify endtable endtask enum event eventually expect
export extends extern final first_match for force foreach forever fork forkjoin function generate genvar global highz0
highz1 if iff ifnone ignore_bins illegal_bins implements implies import incdir include initial inout input inside
instance int integer interconnect interface intersect join join_any join_none large let liblist library local
localparam logic longint macromodule matches medium modport module nand negedge nettype new nexttime nmos nor
noshowcancelled not notif0 notif1 null or output package packed parameter pmos posedge primitive priority program
property protected pull0 pull1 pulldown pullup pulsestyle_ondetect pulsestyle_onevent pure rand randc randcase
randsequence rcmos real realtime ref reg reject_on release repeat restrict return rnmos rpmos rtran rtranif0 rtranif1
s_always s_eventually s_nexttime s_until s_until_with scalared sequence shortint shortreal showcancelled signed small
soft solve specify specparam static string strong strong0 strong1 struct super supply0 supply1 sync_accept_on
sync_reject_on table tagged task this throughout time timeprecision timeunit tran tranif0 tranif1 tri tri0 tri1 triand
trior trireg type typedef union unique unique0 unsigned until until_with untyped use uwire var vectored virtual void
wait wait_order wand weak weak0 weak1 while wildcard wire with within wor xnor xor";

/// Returns whether a name can be used in Verilog and in C as it is.
pub(super) fn is_name(name: &str) -> bool {
    let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    name.starts_with(|c: char| c.is_ascii_lowercase())
        && name.len() <= MAX_NAME_LENGTH
        && name.chars().all(plain)
        && !RESERVED.contains(&name)
        && !name.starts_with(LIBRARY)
        && !KEYWORDS.split_whitespace().any(|keyword| keyword == name)
}

/// Turns a refused name into an allowed one: in small letters, with `_` in place of what is not allowed; `None` where
/// that is not allowed either.
pub(super) fn mended(name: &str) -> Option<String> {
    let plain = |c: char| {
        if c.is_ascii_alphanumeric() {
            c.to_ascii_lowercase()
        } else {
            '_'
        }
    };
    let small: String = name.trim().chars().map(plain).collect();
    [small.clone(), format!("my_{small}")]
        .into_iter()
        .find(|name| is_name(name) && !small.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_identifiers_in_every_generated_language() {
        assert!(is_name("xy_stage") && is_name("x") && is_name(&"x".repeat(64)));
        let refused = [
            "",
            "X",
            "1x",
            "_x",
            "x-y",
            "x y",
            "ä",
            "wire",
            "logic",
            "always_ff",
            "xor",
            "shaper",
            "clk",
        ];
        for name in refused {
            assert!(!is_name(name), "{name}");
        }
        assert!(!is_name(&"x".repeat(65)));
    }

    #[test]
    fn a_refused_name_is_mended_where_it_can_be() {
        assert_eq!(mended("XY-Stage").as_deref(), Some("xy_stage"));
        assert_eq!(mended("2slide").as_deref(), Some("my_2slide"));
        assert_eq!(mended("wire").as_deref(), Some("my_wire"));
        assert_eq!(mended(""), None);
        assert_eq!(mended(&"x".repeat(65)), None);
    }
}
