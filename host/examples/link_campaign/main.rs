//! The fault campaign of the host link, as a table.
//!
//! ```text
//! cargo run --release -p posicast-host --example link_campaign -- [CASES] [SEED]
//! ```

#![allow(clippy::print_stdout, reason = "this is a program")]

mod campaign;

use campaign::{Kind, Outcome};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut numbers = std::env::args().skip(1).map(|word| word.parse::<u64>());
    let cases = numbers.next().transpose()?.unwrap_or(1000);
    let seed = numbers.next().transpose()?.unwrap_or(1);
    campaign::comparison_finds_wrong_writes();
    let all = campaign::run(0..cases, seed)?;
    print!("{}", table(&all));
    let failed: Vec<_> = all.iter().filter(|(_, outcome)| !outcome.failures.is_empty()).collect();
    for (number, outcome) in &failed {
        println!(
            "case {number}, {}: {}",
            outcome.kind.name(),
            outcome.failures.join("; ")
        );
    }
    println!("\n{} cases, {} failed, seed {seed}", all.len(), failed.len());
    if failed.is_empty() {
        Ok(())
    } else {
        Err("there are failures".into())
    }
}

fn table(all: &[(u64, Outcome)]) -> String {
    let head = "| fault | cases | failed | bytes damaged or lost | words written | at the target | else: off, ticks after the last byte |\n";
    let mut text = format!("{head}|---|---|---|---|---|---|---|\n");
    for kind in Kind::ALL {
        let of: Vec<&Outcome> = all
            .iter()
            .map(|(_, outcome)| outcome)
            .filter(|outcome| outcome.kind == kind)
            .collect();
        let count = |holds: fn(&Outcome) -> bool| of.iter().filter(|outcome| holds(outcome)).count();
        let off = of.iter().filter_map(|outcome| outcome.off_ticks).max();
        text += &format!(
            "| {} | {} | {} | {} | {} | {} | {} |\n",
            kind.name(),
            of.len(),
            count(|outcome| !outcome.failures.is_empty()),
            of.iter().map(|outcome| outcome.faults).sum::<u64>(),
            of.iter().map(|outcome| outcome.writes).sum::<usize>(),
            count(|outcome| outcome.arrived),
            off.map_or_else(|| "–".to_owned(), |ticks| ticks.to_string()),
        );
    }
    text
}
