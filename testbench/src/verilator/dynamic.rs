//! The one file with `unsafe`: loads the shared object that Verilator and the C++ compiler built, and calls it.
//!
//! Why it is sound: the object is built from our own harness (`harness.rs`), whose functions have exactly the types
//! below; its content hash is its name, so an object of another harness is never loaded. C++ exceptions do not leave
//! the harness. The buffers' lengths are checked here before every call against the numbers of ports for which the
//! harness was made. The simulation is freed before the library with its code is unloaded.
#![allow(unsafe_code)] // dlopen and calls through the C interface have no safe form

use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::path::Path;
use std::ptr::NonNull;

use libloading::Library;
use posicast_blocks::StepError;

use crate::Error;

type New = unsafe extern "C" fn(u32) -> *mut c_void;
type Free = unsafe extern "C" fn(*mut c_void);
type Message = unsafe extern "C" fn(*mut c_void) -> *const c_char;
type WriteCoverage = unsafe extern "C" fn(*mut c_void, *const c_char) -> c_int;
type Run = unsafe extern "C" fn(*mut c_void, *const u64, *mut u64, u64) -> c_int;
type Hold = unsafe extern "C" fn(*mut c_void, *const u64, *const u64, u64, *mut u64, *mut u64) -> c_int;

/// A simulation in a loaded shared object.
#[derive(Debug)]
pub(super) struct Simulation {
    state: NonNull<c_void>,
    run: Run,
    hold: Hold,
    free: Free,
    message: Message,
    /// Function of a simulation that was built to count.
    coverage: Option<WriteCoverage>,
    inputs: usize,
    outputs: usize,
    // This field comes last, so that the code outlives the state.
    _library: Library,
}

impl Simulation {
    /// Loads `object`, which was built for this many inputs and outputs, and starts it with a random state from
    /// `seed`.
    pub(super) fn load(object: &Path, seed: u64, [inputs, outputs]: [usize; 2]) -> Result<Self, Error> {
        let refuse = |reason: String| Error::Load {
            path: object.to_owned(),
            reason,
        };
        // Verilator takes 31 bits; 0 means that it chooses a seed itself.
        let seed = ((seed ^ (seed >> 32)) as u32 & 0x7fff_fffe) | 1;
        // SAFETY: the object's initialisers are those of Verilator's runtime library; the types are those of the module
        // doc.
        let (library, new, free, message, run, hold, coverage) = unsafe {
            let library = Library::new(object).map_err(|cause| refuse(cause.to_string()))?;
            let missing = |cause: libloading::Error| refuse(cause.to_string());
            let new: New = *library.get(b"posicast_new\0").map_err(missing)?;
            let free: Free = *library.get(b"posicast_free\0").map_err(missing)?;
            let message: Message = *library.get(b"posicast_message\0").map_err(missing)?;
            let run: Run = *library.get(b"posicast_run\0").map_err(missing)?;
            let hold: Hold = *library.get(b"posicast_hold\0").map_err(missing)?;
            let coverage = library.get(b"posicast_coverage\0").ok().map(|found| *found);
            (library, new, free, message, run, hold, coverage)
        };
        // SAFETY: `new` takes any seed and returns a simulation or null.
        let state = NonNull::new(unsafe { new(seed) });
        let state = state.ok_or_else(|| refuse("it does not start".to_owned()))?;
        Ok(Self {
            state,
            run,
            hold,
            free,
            message,
            coverage,
            inputs,
            outputs,
            _library: library,
        })
    }

    /// Simulates as many clocks as there are rows.
    pub(super) fn run(&mut self, inputs: &[u64], outputs: &mut [u64]) -> Result<(), StepError> {
        let clocks = match (
            inputs.len().checked_div(self.inputs),
            outputs.len().checked_div(self.outputs),
        ) {
            (_, Some(rows)) => rows,
            (Some(rows), None) => rows,
            (None, None) => return Ok(()),
        };
        if inputs.len() != clocks * self.inputs || outputs.len() != clocks * self.outputs {
            return Err(StepError(format!(
                "{} input and {} output values are not {clocks} clocks of {} inputs and {} outputs",
                inputs.len(),
                outputs.len(),
                self.inputs,
                self.outputs
            )));
        }
        // SAFETY: `state` came from this library's `posicast_new` and is not shared; the harness reads `clocks` rows of
        // inputs and writes `clocks` rows of outputs, which is what the slices hold.
        let failed = unsafe {
            (self.run)(
                self.state.as_ptr(),
                inputs.as_ptr(),
                outputs.as_mut_ptr(),
                clocks as u64,
            )
        };
        self.answer(failed)
    }

    /// Simulates clocks with the same inputs up to the first one in which an output is not `expected`, or `clocks` of them. Returns how
    /// many were as expected, also where the simulation stops; `outputs` are those of the one that was not.
    pub(super) fn hold(
        &mut self,
        inputs: &[u64],
        expected: &[u64],
        clocks: u64,
        outputs: &mut [u64],
    ) -> (u64, Result<(), StepError>) {
        if (inputs.len(), expected.len(), outputs.len()) != (self.inputs, self.outputs, self.outputs) {
            let (inputs, outputs) = (self.inputs, self.outputs);
            return (
                0,
                Err(StepError(format!(
                    "a clock has {inputs} input and {outputs} output values"
                ))),
            );
        }
        let mut equal = 0;
        // SAFETY: `state` came from this library's `posicast_new` and is not shared; the harness reads one row of inputs and of expected
        // outputs, and writes at most one row of outputs and `equal`.
        let failed = unsafe {
            (self.hold)(
                self.state.as_ptr(),
                inputs.as_ptr(),
                expected.as_ptr(),
                clocks,
                outputs.as_mut_ptr(),
                &raw mut equal,
            )
        };
        (equal, self.answer(failed))
    }

    /// The error of a call that returned this.
    fn answer(&self, failed: c_int) -> Result<(), StepError> {
        if failed == 0 {
            return Ok(());
        }
        // SAFETY: the result is a string that ends in 0 and lives until the next call.
        let message = unsafe { CStr::from_ptr((self.message)(self.state.as_ptr())) };
        Err(StepError(format!("Verilator: {}", message.to_string_lossy())))
    }
}

impl Simulation {
    /// Writes the counts since the start into the file `path`, in Verilator's format.
    pub(super) fn write_coverage(&mut self, path: &Path) -> Result<(), StepError> {
        let name = CString::new(path.as_os_str().as_encoded_bytes());
        let (Some(write), Ok(name)) = (self.coverage, name) else {
            return Err(StepError("this simulation was not built to count".to_owned()));
        };
        // SAFETY: `state` came from this library, and `name` is a string that ends in 0 and outlives the call.
        match unsafe { write(self.state.as_ptr(), name.as_ptr()) } {
            0 => Ok(()),
            _ => Err(StepError(format!("Verilator cannot write {}", path.display()))),
        }
    }
}

impl Drop for Simulation {
    fn drop(&mut self) {
        // SAFETY: the state was made by this library's `posicast_new`, and is freed once.
        unsafe { (self.free)(self.state.as_ptr()) }
    }
}
