//! The mutation rung on small blocks: the fate of every mutant is known, and stimuli that do not detect a mutant are reported.

use posicast_ladder::mutation::{Fate, INSIDE, Mutant, MutationOptions, Subject, hunt, named, run, run_with};
use posicast_machine::plan::design_machine;
use posicast_machine::{hardware, machine_file};
use posicast_testbench::blocks::Block;
use posicast_testbench::parts::{PartBlock, SmallPart};

fn subject(block: &str) -> Subject {
    named(block).unwrap().swap_remove(0)
}

fn options(mutants: usize) -> MutationOptions {
    MutationOptions {
        mutants,
        clocks: 100_000,
        ..MutationOptions::default()
    }
}

fn fates(subject: &Subject, mutants: usize) -> Vec<(Mutant, Fate)> {
    let folder = tempfile::tempdir().unwrap();
    run(subject, &options(mutants), folder.path()).unwrap()
}

#[test]
fn long_mutate_no_mutant_of_a_small_block_is_unknown() {
    for block in ["group", "divider_share"] {
        let fates = fates(&subject(block), 30);
        assert!(fates.len() > 20, "{block}: {} mutants", fates.len());
        for (mutant, fate) in fates {
            let is_known = !matches!(fate, Fate::Unknown { .. });
            assert!(is_known, "{block}, {mutant}: {fate:?}");
        }
    }
}

#[test]
fn long_mutate_stimuli_that_do_nothing_leave_mutants_alive_and_no_proof_calls_them_equivalent() {
    let subject = subject("group");
    let seen = fates(&subject, 12);
    let folder = tempfile::tempdir().unwrap();
    let mut nothing = |_clocks, _seed| Box::new(|_: &[u64], inputs: &mut [u64]| inputs.fill(0)) as Box<_>;
    let unseen = run_with(&subject, &options(12), &[], folder.path(), &mut nothing).unwrap();
    let mut lost = 0;
    for ((mutant, fate), (same, idle)) in seen.iter().zip(&unseen) {
        assert_eq!(mutant, same);
        if *idle != *fate && !matches!((fate, idle), (Fate::Lockstep(_), Fate::Lockstep(_))) {
            lost += 1;
            let is_found = matches!(idle, Fate::Property(_) | Fate::Unknown { differs: Some(_) });
            assert!(is_found, "{mutant}: {fate:?}, and {idle:?} without stimuli");
        }
    }
    assert!(lost >= 2, "only {lost} mutants need stimuli");
}

#[test]
fn long_mutate_equal_seeds_choose_equal_mutants_and_others_do_not() {
    let subject = subject("schedule");
    let few = |seed| {
        let folder = tempfile::tempdir().unwrap();
        let options = MutationOptions { seed, ..options(5) };
        run(&subject, &options, folder.path()).unwrap()
    };
    assert_eq!(few(1), few(1));
    assert_ne!(few(1), few(2));
}

/// The rows that check a folder, on the stage of the example machine, with the default clocks and seed.
#[test]
fn long_mutate_every_named_mutant_inside_the_stage_is_found() {
    let machine = machine_file::parse("xy-stage.toml", include_str!("../../examples/xy-stage.toml")).unwrap();
    let stage = hardware::stage(&machine, &design_machine(&machine).unwrap());
    let config = stage.unwrap().unwrap().config;
    for mutant in INSIDE {
        let found = hunt(&mutant, &config, "xy_stage_stage", 1_000_000, 1).unwrap();
        assert!(found.is_some(), "not found: {}", mutant.name);
    }
}

#[test]
fn mutate_a_named_mutant_whose_text_is_gone_is_an_error() {
    let mutant = INSIDE.iter().find(|mutant| mutant.module == Some("group")).unwrap();
    let modules = PartBlock::new(SmallPart::Group(2), "top").modules().unwrap();
    assert!(mutant.put_into(&modules).is_ok());
    for (text, times) in [(String::new(), "0 times"), (mutant.from.repeat(2), "2 times")] {
        let mut outdated = modules.clone();
        outdated.last_mut().unwrap().text = text;
        let refused = mutant.put_into(&outdated).unwrap_err().to_string();
        assert!(refused.contains(times), "{refused}");
    }
}
