//! Writes Verilog to disk, with or without a deliberate fault, and runs it beside a model.

use crate::support::broken;
use posicast_blocks::{ClockedBlock, Port};
use posicast_hdl::emit::Module;
use posicast_testbench::blocks::Sources;
use posicast_testbench::icarus::Icarus;
use posicast_testbench::lockstep::report::{LockstepReport, LockstepVerdict};
use posicast_testbench::lockstep::{self, Clock, Device, Instance, LockstepOptions};
use posicast_testbench::stimuli::Stimuli;
use posicast_testbench::verilator::{Verilated, VerilogSource, lint};

pub(crate) struct Bench {
    name: String,
    top: String,
    ports: Vec<Port>,
    sources: Sources,
}

impl Bench {
    /// Writes `modules`, the top last, with the first `from` replaced by `to`.
    pub(crate) fn new(name: &str, modules: &[Module], from: &str, to: &str) -> Self {
        let modules = broken(modules, from, to);
        let top = modules.last().unwrap();
        Self {
            name: name.to_owned(),
            top: top.name.clone(),
            ports: top.ports.clone(),
            sources: Sources::of_modules(&modules).unwrap(),
        }
    }

    fn source(&self) -> VerilogSource<'_> {
        VerilogSource {
            files: self.sources.files(),
            top: &self.top,
            ports: &self.ports,
        }
    }

    pub(crate) fn verilated(&self) -> Verilated {
        Verilated::build(&self.source(), 1).unwrap()
    }

    pub(crate) fn icarus(&self) -> Icarus {
        Icarus::build(&self.source()).unwrap()
    }

    pub(crate) fn assert_clean(&self) {
        assert_eq!(lint(self.sources.files(), &self.top).unwrap(), [""; 0]);
    }

    pub(crate) fn run(
        &self,
        model: &mut dyn ClockedBlock,
        device: &mut dyn Device,
        stimuli: &mut dyn Stimuli,
        cycles: u64,
        watch: &mut dyn FnMut(&Clock<'_>),
    ) -> LockstepReport {
        let instances = [Instance::whole(&self.name, "alone", model.ports())];
        let options = LockstepOptions::cycles(cycles);
        lockstep::run(model, device, stimuli, &instances, &options, watch, &mut |_| {}).unwrap()
    }
}

pub(crate) fn assert_match(report: &LockstepReport) {
    if let Some(first) = &report.blocks[0].first {
        panic!("{} mismatches\n{first}", report.blocks[0].mismatches);
    }
    assert_eq!(report.result, LockstepVerdict::Match);
}
