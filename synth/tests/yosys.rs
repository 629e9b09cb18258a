//! Estimates and checks by the installed Yosys; these tests fail without it.

use std::path::{Path, PathBuf};
use std::time::Duration;

use posicast_synth::yosys::{BlockEstimate, Estimate, Family, Mapping, Resources, Yosys, YosysError};

fn rtl(names: &[&str]) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/rtl");
    names.iter().map(|name| folder.join(name).with_extension("v")).collect()
}

fn stage(family: Family) -> Estimate {
    Yosys::installed()
        .unwrap()
        .estimate(&rtl(&["stage", "filter"]), "stage", family)
        .unwrap()
}

fn sum(blocks: &[BlockEstimate]) -> Resources {
    let mut total = Resources::default();
    for block in blocks {
        total += block.resources;
    }
    total
}

#[test]
fn netlist_every_instance_is_a_block() {
    for family in Family::ALL {
        let estimate = stage(family);
        let names: Vec<&str> = estimate.blocks.iter().map(|b| b.name.as_str()).collect();
        assert_eq!(names, ["x_filter", "y_filter", "stage"], "{family}");
        assert_eq!(estimate.total, sum(&estimate.blocks), "{family}");
        assert!(estimate.excesses().is_empty(), "{family}");
    }
}

#[test]
fn netlist_memory_multipliers_and_registers_match_the_source() {
    for family in Family::ALL {
        let blocks = stage(family).blocks;
        let of = |index: usize| {
            let r = blocks[index].resources;
            (r.memory_bits, r.multipliers, r.registers)
        };
        // Ring and ROM keep their read registers; the upper bits of the product are flip-flops. The lower 16 are
        // never read and are removed.
        assert_eq!(of(0), (1024 * 16 + 64 * 18, 1, 16), "{family}");
        assert_eq!(of(1), (1024 * 32 + 64 * 18, 2, 32), "{family}");
        assert_eq!(of(2), (0, 0, 10), "{family}");
    }
}

#[test]
fn netlist_a_counter_takes_about_a_cell_per_bit() {
    // Each bit needs its LUT; the carry stays in the chain, the clear in the flip-flops.
    let cells = stage(Family::Cyclone2).blocks[2].resources.cells;
    assert!(
        (10..=12).contains(&cells),
        "{cells} logic elements for a 10-bit counter"
    );
    let cells = stage(Family::Cyclone5).blocks[2].resources.cells;
    assert!((5..=10).contains(&cells), "{cells} ALMs for a 10-bit counter");
}

#[test]
fn netlist_the_json_document_has_its_fixed_keys() {
    let estimate = stage(Family::Cyclone2);
    let json = serde_json::to_value(&estimate).unwrap();
    let resources = ["cells", "registers", "memory_bits", "multipliers"];
    for block in json["blocks"].as_array().unwrap() {
        assert!(block["name"].is_string());
        assert!(resources.iter().all(|key| block[key].is_u64()), "{block}");
    }
    for part in ["total", "device"] {
        assert!(resources.iter().all(|key| json[part][key].is_u64()), "{part}");
    }
    assert_eq!(json["family"], "cyclone2");
    assert_eq!(json["device"]["name"], "EP2C20F484C7");
    assert!(json["clock_mhz_estimate"].is_null());
    assert_eq!(json["method"]["mapped_as"], "cycloneive");
    let note = json["method"]["note"].as_str().unwrap();
    assert!(note.contains("cyclone2 estimated as cycloneive"), "{note}");
}

#[test]
fn netlist_a_design_without_instances_is_one_block() {
    let yosys = Yosys::installed().unwrap();
    let estimate = yosys.estimate(&rtl(&["filter"]), "filter", Family::Cyclone4e).unwrap();
    assert_eq!(estimate.blocks.len(), 1);
    assert_eq!(estimate.blocks[0].name, "filter");
}

#[test]
fn netlist_a_memory_without_clocked_read_is_logic() {
    let yosys = Yosys::installed().unwrap();
    let files = rtl(&["async_memory"]);
    let total = yosys.estimate(&files, "async_memory", Family::Cyclone2).unwrap().total;
    assert_eq!((total.memory_bits, total.registers), (0, 64 * 8));
}

#[test]
fn netlist_a_multiplier_is_as_wide_as_what_its_operands_carry() {
    let yosys = Yosys::installed().unwrap();
    let total = yosys
        .estimate(&rtl(&["product"]), "product", Family::Cyclone2)
        .unwrap()
        .total;
    assert_eq!(total.multipliers, 1);
}

#[test]
fn netlist_cells_of_late_optimisations_are_mapped_too() {
    let yosys = Yosys::installed().unwrap();
    for family in Family::ALL {
        let total = yosys.estimate(&rtl(&["counter"]), "counter", family).unwrap().total;
        assert_eq!(total.registers, 16, "{family}");
    }
}

#[test]
fn netlist_resources_that_do_not_suffice_are_named() {
    let mut estimate = stage(Family::Cyclone2);
    estimate.device.memory_bits = 1024;
    let excesses = estimate.excesses();
    assert_eq!(excesses.len(), 1);
    assert_eq!((excesses[0].resource, excesses[0].block), ("memory_bits", "y_filter"));
}

#[test]
fn netlist_a_sound_design_is_accepted() {
    let yosys = Yosys::installed().unwrap();
    yosys.check(&rtl(&["stage", "filter"]), "stage").unwrap();
}

#[test]
fn netlist_an_unsound_design_is_refused_with_the_reason() {
    let yosys = Yosys::installed().unwrap();
    let cases: [(&[&str], &str, &str); 5] = [
        (&["stage"], "stage", "filter"), // a module is missing
        (&["filter"], "absent", "absent"),
        (&["latch"], "latch", "latch"),
        (&["conflict"], "conflict", "conflict"),
        (&["broken"], "broken", "broken.v:3"),
    ];
    for (files, top, reason) in cases {
        let error = yosys.check(&rtl(files), top).unwrap_err();
        let YosysError::Failed { last_lines, .. } = &error else {
            panic!("{files:?}: {error}")
        };
        assert!(
            last_lines.contains("ERROR") && last_lines.contains(reason),
            "{files:?}: {last_lines}"
        );
    }
    assert!(matches!(
        yosys.estimate(&rtl(&["broken"]), "broken", Family::Cyclone5),
        Err(YosysError::Failed { .. })
    ));
}

#[test]
fn netlist_a_module_name_cannot_carry_commands() {
    let yosys = Yosys::installed().unwrap();
    for top in ["", "a b", "stage; shell touch x", "1st", "a\"", "größe"] {
        assert!(matches!(yosys.check(&[], top), Err(YosysError::Top(_))), "{top:?}");
    }
}

#[test]
fn netlist_paths_with_spaces_work() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("my [new] filter;x.v");
    std::fs::copy(&rtl(&["filter"])[0], &path).unwrap();
    Yosys::installed().unwrap().check(&[path], "filter").unwrap();
}

#[test]
fn a_missing_tool_is_its_own_error() {
    let error = Yosys::at(Path::new("/nowhere/yosys")).unwrap_err();
    assert!(matches!(error, YosysError::Missing(_)), "{error}");
    assert!(error.to_string().contains("apt-get install"), "{error}");
}

#[test]
fn a_file_that_is_missing_is_named() {
    let yosys = Yosys::installed().unwrap();
    let error = yosys.check(&rtl(&["nothing"]), "nothing").unwrap_err();
    assert!(
        matches!(&error, YosysError::Io { path, .. } if path.ends_with("nothing.v")),
        "{error}"
    );
}

#[cfg(unix)]
#[test]
fn a_tool_that_hangs_is_stopped() {
    let folder = tempfile::tempdir().unwrap();
    let program = folder.path().join("yosys");
    std::fs::write(&program, "#!/bin/sh\n[ \"$2\" = -V ] && exit 0\nexec sleep 60\n").unwrap();
    std::fs::set_permissions(&program, std::os::unix::fs::PermissionsExt::from_mode(0o755)).unwrap();
    let yosys = Yosys::at(&program).unwrap().with_time_limit(Duration::from_millis(50));
    assert!(matches!(yosys.check(&[], "top"), Err(YosysError::TimeOut { .. })));
}

#[test]
fn netlist_the_logic_element_has_a_carry_chain_and_a_synchronous_clear() {
    let cells = |mapping| {
        let yosys = Yosys::installed().unwrap().with_mapping(mapping);
        let total = yosys.estimate(&rtl(&["accumulator"]), "accumulator", Family::Cyclone2);
        total.unwrap().total.cells
    };
    // 24 bits of a sum and 24 of a difference; the enable of the register is combined with its reset.
    assert_eq!(cells(Mapping::LogicElement), 49);
    assert!(cells(Mapping::Luts) > 120, "{}", cells(Mapping::Luts));
}
