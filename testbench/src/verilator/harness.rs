//! The C++ between Verilator's class and our C interface, and the check that the class has the expected ports.
//!
//! The ports are read from the class's header, where Verilator writes each as `VL_IN8(&name,msb,lsb);`. Unlike the
//! C++ types this is exact in bits, and it names the member even where the name had to be changed for C++.

use std::fmt::Write as _;

use posicast_blocks::{Direction, Port};

use super::VerilogSource;
use crate::Error;

/// Name of the class that Verilator writes.
pub(super) const CLASS: &str = "Vdevice";

/// Included first into Verilator's own files: the simulation's output goes to standard error, because standard output is ours.
pub(super) const PRINT: &str = r#"#include <cstdio>
#define VL_PRINTF(...) std::fprintf(stderr, __VA_ARGS__)
#define VL_USER_FATAL
#define VL_USER_STOP
#define VL_USER_FINISH
"#;

/// Included first into the harness: the headers that are compiled beforehand. A compiler that refuses their compiled form reads them.
pub(super) const HEADERS: &str = r#"#include "harness_print.h"
#include <cstdint>
#include <exception>
#include <stdexcept>
#include <string>
#include "verilated.h"
"#;

/// Makefile beside Verilator's. The compiled headers are an order-only prerequisite, as those from the cache are older than the build.
pub(super) const MAKEFILE: &str = r"include Vdevice.mk

FIRST = harness_print.h
harness.o: private FIRST = harness_headers.h
CPPFLAGS += -include $(FIRST)

harness.o: | harness_headers.h.gch
harness_headers.h.gch:
	$(CXX) $(CXXFLAGS) $(CPPFLAGS) $(OPT_FAST) -x c++-header -o $@ harness_headers.h
";

/// Name of the headers' compiled form in a build folder.
pub(super) const COMPILED_HEADERS: &str = "harness_headers.h.gch";

/// The harness; `@INPUTS@` and `@OUTPUTS@` become one assignment per port, `@EQUAL@` one comparison per output.
pub(super) const TEMPLATE: &str = r#"#include "Vdevice.h"

#define EXPORT extern "C" __attribute__((visibility("default")))

static const uint64_t INPUTS = @INPUT_COUNT@, OUTPUTS = @OUTPUT_COUNT@;

static thread_local std::string stopped;

static std::string place(const char* file, int line) {
    return (file && *file) ? std::string(" (") + file + ":" + std::to_string(line) + ")" : std::string();
}
void vl_finish(const char* file, int line, const char*) { stopped = "the Verilog called $finish" + place(file, line); }
void vl_stop(const char* file, int line, const char*) { stopped = "the Verilog called $stop" + place(file, line); }
// This throws, because Verilator's loops continue if it returns.
void vl_fatal(const char* file, int line, const char*, const char* message) {
    throw std::runtime_error(std::string(message ? message : "fatal error") + place(file, line));
}

struct Simulation {
    VerilatedContext context;
    Vdevice* device = nullptr;
    std::string message;
};

EXPORT Simulation* posicast_new(uint32_t seed) {
    try {
        Simulation* simulation = new Simulation;
        simulation->context.randReset(2);
        simulation->context.randSeed(static_cast<int>(seed));
        simulation->device = new Vdevice(&simulation->context);
        return simulation;
    } catch (...) {
        return nullptr;
    }
}

EXPORT void posicast_free(Simulation* simulation) {
    delete simulation->device;
    delete simulation;
}

EXPORT const char* posicast_message(Simulation* simulation) { return simulation->message.c_str(); }

static void fall(Vdevice& device) {
    device.clk = 0;
    device.eval();
}

static void rise(Vdevice& device) {
    device.clk = 1;
    device.eval();
    if (VL_UNLIKELY(!stopped.empty())) throw std::runtime_error(stopped);
}

static void set(Vdevice& device, const uint64_t* in) {
@INPUTS@}

static void get(const Vdevice& device, uint64_t* out) {
@OUTPUTS@}

template <typename Work> static int guarded(Simulation* simulation, Work work) {
    stopped.clear();
    try {
        work(*simulation->device);
    } catch (const std::exception& cause) {
        simulation->message = cause.what();
        return 1;
    } catch (...) {
        simulation->message = "unknown C++ exception";
        return 1;
    }
    return 0;
}

EXPORT int posicast_run(Simulation* simulation, const uint64_t* in, uint64_t* out, uint64_t clocks) {
    return guarded(simulation, [&](Vdevice& device) {
        for (; clocks; --clocks, in += INPUTS, out += OUTPUTS) {
            set(device, in);
            fall(device);
            get(device, out);
            rise(device);
        }
    });
}

EXPORT int posicast_hold(Simulation* simulation, const uint64_t* in, const uint64_t* expected, uint64_t clocks, uint64_t* out,
                         uint64_t* equal) {
    *equal = 0;
    return guarded(simulation, [&](Vdevice& device) {
        set(device, in);
        for (bool same = true; same && *equal < clocks;) {
            fall(device);
            same = true@EQUAL@;
            if (same) {
                ++*equal;
            } else {
                get(device, out);
            }
            rise(device);
        }
    });
}

int main() { return 0; }
"#;

/// Appended to the harness of a simulation that counts what its Verilog does.
pub(super) const COVERAGE: &str = r#"
#include "verilated_cov.h"

EXPORT int posicast_coverage(Simulation* simulation, const char* path) {
    try {
        simulation->context.coveragep()->write(path);
    } catch (...) {
        return 1;
    }
    return 0;
}
"#;

/// A port as Verilator declares it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Declared {
    /// Name of the C++ member.
    member: String,
    /// Name in the Verilog.
    name: String,
    /// Direction; `None` for `inout`.
    direction: Option<Direction>,
    width: u64,
}

/// Ports from the text of the class's header.
pub(super) fn declared_ports(header: &str) -> Vec<Declared> {
    header.lines().filter_map(declared_port).collect()
}

fn declared_port(line: &str) -> Option<Declared> {
    let line = line.trim();
    let (kind, arguments) = line.strip_prefix("VL_")?.split_once('(')?;
    let direction = if kind.starts_with("INOUT") {
        None
    } else if kind.starts_with("IN") {
        Some(Direction::Input)
    } else if kind.starts_with("OUT") {
        Some(Direction::Output)
    } else {
        return None;
    };
    let mut arguments = arguments.split(')').next()?.split(',');
    let member = arguments.next()?.trim().trim_start_matches('&').to_owned();
    let msb: i64 = arguments.next()?.trim().parse().ok()?;
    let lsb: i64 = arguments.next()?.trim().parse().ok()?;
    Some(Declared {
        name: verilog_name(&member),
        member,
        direction,
        width: msb.abs_diff(lsb).checked_add(1)?,
    })
}

/// Undoes Verilator's renaming: `__0HH` is the character with that code, `__SYM__` guards a word of C++.
fn verilog_name(member: &str) -> String {
    let mut rest = member.strip_prefix("__SYM__").unwrap_or(member);
    let mut name = String::new();
    while let Some(at) = rest.find("__0") {
        let code = rest
            .get(at + 3..at + 5)
            .and_then(|hex| u8::from_str_radix(hex, 16).ok());
        let Some(code) = code else { break };
        name.push_str(&rest[..at]);
        name.push(char::from(code));
        rest = &rest[at + 5..];
    }
    name + rest
}

/// The C++ member of each port in the order of `source.ports`; the error lists all differences.
pub(super) fn members(source: &VerilogSource<'_>, declared: &[Declared]) -> Result<Vec<String>, Error> {
    let mut problems = Vec::new();
    let mut members = Vec::with_capacity(source.ports.len());
    let clock = Port {
        name: "clk".to_owned(),
        direction: Direction::Input,
        width: 1,
        signed: false,
    };
    let expected = |name: &str| name == "clk" || source.ports.iter().any(|p| p.name == name);
    for port in std::iter::once(&clock).chain(source.ports) {
        let Some(found) = declared.iter().find(|d| d.name == port.name) else {
            problems.push(format!("  `{}` is missing", port.name));
            continue;
        };
        if found.direction != Some(port.direction) {
            let way = if port.direction == Direction::Input {
                "input"
            } else {
                "output"
            };
            problems.push(format!("  `{}` is not an {way}", port.name));
        }
        if found.width != u64::from(port.width) {
            problems.push(format!(
                "  `{}` has {} bits, not {}",
                port.name, found.width, port.width
            ));
        }
        members.push(found.member.clone());
    }
    let unexpected = declared.iter().filter(|d| !expected(&d.name));
    problems.extend(unexpected.map(|d| format!("  `{}` is not expected", d.name)));
    if !problems.is_empty() {
        return Err(Error::Ports {
            top: source.top.to_owned(),
            problems,
        });
    }
    members.remove(0);
    Ok(members)
}

/// The harness for these ports.
pub(super) fn source_text(ports: &[Port], members: &[String]) -> String {
    let (mut inputs, mut outputs, mut equal) = (String::new(), String::new(), String::new());
    let (mut input, mut output) = (0, 0);
    for (port, member) in ports.iter().zip(members) {
        // Writing to a `String` cannot fail.
        let _ = match port.direction {
            Direction::Input => {
                let mask = u64::MAX >> (64 - port.width);
                input += 1;
                writeln!(inputs, "    device.{member} = in[{}] & UINT64_C({mask:#x});", input - 1)
            }
            Direction::Output => {
                output += 1;
                let _ = writeln!(outputs, "    out[{}] = device.{member};", output - 1);
                write!(
                    equal,
                    "\n                && device.{member} == expected[{}]",
                    output - 1
                )
            }
        };
    }
    TEMPLATE
        .replace("@INPUTS@", &inputs)
        .replace("@OUTPUTS@", &outputs)
        .replace("@EQUAL@", &equal)
        .replace("@INPUT_COUNT@", &input.to_string())
        .replace("@OUTPUT_COUNT@", &output.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ports_are_read_from_the_header_with_their_verilog_names() {
        let header = "  VL_IN8(&clk,0,0);\n VL_OUT16(&a___05Fb,15,0);\n  VL_INW(&wide,99,0,4);\n VL_INOUT8(&z,0,7);\n \
                      VL_IN8(&__SYM__class,0,0);\n CData x;\n VL_ATTR(x)";
        let found: Vec<_> = declared_ports(header)
            .into_iter()
            .map(|d| (d.name, d.direction, d.width))
            .collect();
        let expected = [
            ("clk", Some(Direction::Input), 1),
            ("a__b", Some(Direction::Output), 16),
            ("wide", Some(Direction::Input), 100),
            ("z", None, 8),
            ("class", Some(Direction::Input), 1),
        ];
        assert_eq!(found, expected.map(|(n, d, w)| (n.to_owned(), d, w)));
    }

    #[test]
    fn a_name_that_only_looks_renamed_stays() {
        assert_eq!(verilog_name("x__0"), "x__0");
        assert_eq!(verilog_name("x__0é"), "x__0é");
        assert_eq!(verilog_name("plain_name"), "plain_name");
    }
}
