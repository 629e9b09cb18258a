//! Checks generated files with independent tools: systemrdl-compiler, the schema of CMSIS-SVD and its parser, FuseSoC
//! with Verilator and Icarus, LiteX, cocotb with the bus drivers of cocotb-bus, cocotbext-axi and cocotbext-wishbone, and encoders, walks
//! and a probe in cocotb.
//!
//! These are Python programs in `.venv` of the repository, which `scripts/install-tools` creates.

mod absolute;
mod amd;
mod buses;
mod capture;
mod compare;
mod litex;
mod vhdl;

use posicast_blocks::component::Component;
use posicast_blocks::pwm::{ActiveLow, BridgeMode, PwmConfig};
use posicast_blocks::registers::{Access, Field, RegisterMap};
use posicast_machine::hardware;
use posicast_machine::machine_file;
use posicast_machine::plan::design_machine;
use posicast_synth::core_file::{self, Core};
use posicast_synth::register_documents;
use posicast_testbench::blocks::Block;
use posicast_testbench::component::ComponentBlock;
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

/// Returns a tool of the virtual environment.
fn tool(name: &str) -> Command {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../.venv/bin").join(name);
    assert!(
        path.exists(),
        "{} is missing: scripts/install-tools makes it",
        path.display()
    );
    Command::new(path)
}

fn python(script: &str) -> Command {
    let mut python = tool("python");
    python.arg(
        Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("tests/independent")
            .join(script),
    );
    python
}

/// Returns what a command prints, if it succeeds.
fn output(command: &mut Command) -> String {
    let output = command.output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let (out, err) = (text(&output.stdout), text(&output.stderr));
    assert!(output.status.success(), "{command:?}: {}\n{out}{err}", output.status);
    out
}

fn stage() -> Component {
    let machine = machine_file::parse("xy-stage.toml", include_str!("../../../examples/xy-stage.toml")).unwrap();
    let stage = hardware::stage(&machine, &design_machine(&machine).unwrap()).unwrap();
    Component::stage(&stage.unwrap().config).unwrap()
}

fn pwm() -> Component {
    let config = PwmConfig::new(ActiveLow::default(), 25, 50).unwrap();
    Component::pwm(config, BridgeMode::HalfBridge, 2500).unwrap()
}

/// Writes text below a folder.
fn write(folder: &Path, path: &str, text: &str) -> PathBuf {
    let path = folder.join(path);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(&path, text).unwrap();
    path
}

/// Writes the documents of a component into a folder; returns the paths of SystemRDL and SVD.
fn documents(folder: &TempDir, top: &str, map: &RegisterMap) -> [PathBuf; 2] {
    let [_, rdl, svd] =
        register_documents::files(top, &[top.to_owned()], map).map(|(path, text)| write(folder.path(), &path, &text));
    [rdl, svd]
}

/// Returns a line per field, as the Python programs print them. `array` returns the name of a word of several.
fn fields(map: &RegisterMap, array: fn(&str, u32) -> String) -> Vec<String> {
    let mut lines = Vec::new();
    for register in map.registers() {
        let access = match &register.access {
            Access::Constant | Access::Live | Access::Shadow { .. } => "r",
            Access::Sticky | Access::InterruptState => "rw1c",
            Access::Command { .. } | Access::Words { .. } | Access::Snapshot | Access::InterruptTest => "w",
            _ => "rw",
        };
        let resets = ["rw", "rw1c"].contains(&access) || register.access == Access::Constant;
        let whole = [Field::new("any", 0, 32, "")];
        let mut fields: Vec<&Field> = match map.fields(register) {
            [] => whole.iter().collect(),
            fields => fields.iter().collect(),
        };
        fields.sort_by_key(|field| field.low);
        for word in 0..register.words() {
            let name = register.name.to_uppercase();
            let name = if register.words() > 1 { array(&name, word) } else { name };
            for field in &fields {
                let reset = if resets {
                    (field.reset & field.ones()).to_string()
                } else {
                    "-".to_owned()
                };
                let address = 4 * (register.offset + word);
                let (field, low, width) = (&field.name, field.low, field.width);
                lines.push(format!("{address} {name} {field} {low} {width} {access} {reset}"));
            }
        }
    }
    lines
}

#[test]
fn systemrdl_compiler_reads_the_registers_of_the_map() {
    let folder = tempfile::tempdir().unwrap();
    for (top, component) in [("xy_stage_stage", stage()), ("xy_stage_x_pwm_avalon", pwm())] {
        let [rdl, _] = documents(&folder, top, component.map());
        let said = output(python("read_rdl.py").arg(rdl));
        let expected = fields(component.map(), |name, _| name.to_owned());
        assert_eq!(said.lines().collect::<Vec<_>>(), expected);
    }
}

#[test]
fn the_svd_is_valid_and_reads_as_the_map() {
    let folder = tempfile::tempdir().unwrap();
    for (top, component) in [("xy_stage_stage", stage()), ("xy_stage_x_pwm_avalon", pwm())] {
        let [_, svd] = documents(&folder, top, component.map());
        let said = output(python("read_svd.py").arg(svd));
        let expected = fields(component.map(), |name, word| format!("{name}_{word}"));
        assert_eq!(said.lines().collect::<Vec<_>>(), expected);
    }
}

#[test]
fn fusesoc_runs_lint_and_sim() {
    let folder = tempfile::tempdir().unwrap();
    let component = stage();
    let block = ComponentBlock::new(component.clone(), "xy_stage_stage", "x, y");
    let modules = block.modules().unwrap();
    let files: Vec<String> = modules.iter().map(|module| format!("rtl/{}.v", module.name)).collect();
    for (path, module) in files.iter().zip(&modules) {
        write(folder.path(), path, &module.text);
    }
    let core = Core {
        machine: "xy_stage",
        top: "xy_stage_stage",
        link: None,
        files: &files,
        bus: Some((component.map(), component.composition().ports())),
    };
    for (path, text) in core_file::files(&core) {
        write(folder.path(), &path, &text);
    }
    let run = |target: &str| {
        let mut fusesoc = tool("fusesoc");
        fusesoc
            .arg("--cores-root")
            .arg(folder.path())
            .args(["run", "--target", target]);
        // Its settings and caches stay in the folder.
        fusesoc.current_dir(folder.path()).env("HOME", folder.path());
        output(fusesoc.arg("posicast:machines:xy_stage"))
    };
    run("lint");
    let said = run("sim");
    assert!(said.contains("PASS"), "{said}");
    // A constant that differs from the map stops the testbench.
    let bench = folder.path().join("sim/xy_stage_stage_bench.v");
    let text = std::fs::read_to_string(&bench).unwrap();
    std::fs::write(&bench, text.replacen("45475453", "45475454", 1)).unwrap();
    let mut fusesoc = tool("fusesoc");
    fusesoc
        .arg("--cores-root")
        .arg(folder.path())
        .args(["run", "--target", "sim", "posicast:machines:xy_stage"]);
    let broken = fusesoc
        .current_dir(folder.path())
        .env("HOME", folder.path())
        .output()
        .unwrap();
    assert!(!broken.status.success());
}

#[test]
fn crosssim_cocotb_reads_writes_and_runs_a_period_of_the_pwm() {
    let folder = tempfile::tempdir().unwrap();
    let component = pwm();
    let top = "xy_stage_x_pwm_avalon";
    let [_, svd] = documents(&folder, top, component.map());
    let modules = ComponentBlock::new(component, top, "x").modules().unwrap();
    let files = modules
        .iter()
        .map(|module| write(folder.path(), &format!("{}.v", module.name), &module.text));
    let build = folder.path().join("build");
    let bench = [Path::new("bench_pwm"), Path::new(top), &build];
    let mut run = python("run_cocotb.py");
    let said = output(run.env("POSICAST_SVD", svd).args(bench).args(files));
    assert!(said.contains("3 tests, 0 failed"), "{said}");
}
