//! `loadrt posicast_shaper tables=FILE`: input shapers for LinuxCNC, with the integers of the hardware, bit for bit.
//!
//! ```text
//! joint.N.motor-pos-cmd ─► posicast-shaper.N.pos-in … posicast-shaper.N.pos-out ─► stepgen, drive
//! ```
//!
//! `docs/linuxcnc.md` has the pins. The arithmetic is `MotionShaper` of `posicast-blocks`, the model with which the hardware is
//! compared; the tables are in a file that `posicast generate --hal` writes.
//!
//! **No unwinding into C.** Functions that are `extern "C"` abort where a panic would leave them, which Rust guarantees since 1.81.
//! The profile `realtime` also compiles everything below with `panic = "abort"`.
//!
//! **Real time.** `update` allocates nothing, frees nothing, and makes no system call. Everything is allocated in `rtapi_app_main`.

#![allow(
    unsafe_code,
    reason = "LinuxCNC's interface is C: functions, addresses of pins, and symbols with fixed names"
)]

mod axis;
mod hal;

use axis::Axis;
use hal::{Component, Direction, INVALID, Pin};
use posicast_blocks::shaper_tables::ShaperTables;
use std::ffi::{CStr, c_char, c_int, c_long, c_void};
use std::ptr::null_mut;
use std::sync::atomic::{AtomicPtr, Ordering};

/// Largest relative difference between the period of the servo thread and that of the tables. LinuxCNC rounds periods to what its timer
/// can do.
const PERIOD_TOLERANCE: f64 = 0.01;

/// The parameter `tables=FILE`, as `RTAPI_MP_STRING` in C declares it: LinuxCNC finds it by these names.
static TABLES: AtomicPtr<c_char> = AtomicPtr::new(null_mut());

/// An address or a text that a symbol refers to.
#[repr(transparent)]
pub struct Symbol(*const c_void);

// SAFETY: nobody writes it, and what it refers to is static.
unsafe impl Sync for Symbol {}

/// Type of the parameter: a string.
#[unsafe(no_mangle)]
#[allow(non_upper_case_globals, reason = "LinuxCNC looks for this name")]
pub static rtapi_info_type_tables: Symbol = Symbol(c"s".as_ptr().cast());
/// Place of the parameter.
#[unsafe(no_mangle)]
#[allow(non_upper_case_globals, reason = "LinuxCNC looks for this name")]
pub static rtapi_info_address_tables: Symbol = Symbol((&raw const TABLES).cast());
/// Description of the parameter, for `modinfo`.
#[unsafe(no_mangle)]
#[allow(non_upper_case_globals, reason = "LinuxCNC looks for this name")]
pub static rtapi_info_description_tables: Symbol =
    Symbol(c"file of shapers that posicast generate --hal wrote".as_ptr().cast());
/// License, which LinuxCNC may check.
#[unsafe(no_mangle)]
#[allow(non_upper_case_globals, reason = "LinuxCNC looks for this name")]
pub static rtapi_info_license: Symbol = Symbol(c"MIT OR Apache-2.0".as_ptr().cast());

/// An axis with its pins.
struct Joint {
    axis: Axis,
    pos_in: Pin<f64>,
    pos_out: Pin<f64>,
    enable: Pin<bool>,
    table: Pin<u32>,
    table_used: Pin<u32>,
    changing: Pin<bool>,
    clamped: Pin<bool>,
    word_in: Pin<i32>,
    word_out: Pin<i32>,
}

/// The component, from `rtapi_app_main` to `rtapi_app_exit`.
struct Shapers {
    component: Component,
    period_s: f64,
    wrong_period: Pin<bool>,
    joints: Vec<Joint>,
}

static LOADED: AtomicPtr<Shapers> = AtomicPtr::new(null_mut());

impl Joint {
    fn new(component: Component, number: usize, axis: Axis) -> Result<Self, c_int> {
        let name = |pin: &str| format!("posicast-shaper.{number}.{pin}");
        Ok(Self {
            axis,
            pos_in: component.pin(&name("pos-in"), Direction::In, 0.0)?,
            pos_out: component.pin(&name("pos-out"), Direction::Out, 0.0)?,
            enable: component.pin(&name("enable"), Direction::In, true)?,
            table: component.pin(&name("table"), Direction::In, 0)?,
            table_used: component.pin(&name("table-used"), Direction::Out, 0)?,
            changing: component.pin(&name("changing"), Direction::Out, false)?,
            clamped: component.pin(&name("clamped"), Direction::Out, false)?,
            word_in: component.pin(&name("word-in"), Direction::Out, 0)?,
            word_out: component.pin(&name("word-out"), Direction::Out, 0)?,
        })
    }

    fn update(&mut self, shapes: bool) {
        let enable = shapes && self.enable.get();
        let shaped = self.axis.update(self.pos_in.get(), self.table.get(), enable);
        self.pos_out.set(shaped.position);
        self.table_used.set(shaped.table);
        self.changing.set(shaped.changes);
        self.clamped.set(shaped.clamped);
        self.word_in.set(shaped.word_in);
        self.word_out.set(shaped.word_out);
    }
}

impl Shapers {
    /// Reads the tables and makes the pins.
    fn load(component: Component) -> Result<Self, c_int> {
        let refused = |message: String| {
            hal::report(&message);
            INVALID
        };
        let file = TABLES.load(Ordering::Relaxed);
        if file.is_null() {
            return Err(refused("no tables: loadrt posicast_shaper tables=FILE".to_owned()));
        }
        // SAFETY: LinuxCNC sets a text that ends with 0, and keeps it.
        let file = unsafe { CStr::from_ptr(file) }.to_string_lossy();
        let text = std::fs::read_to_string(&*file).map_err(|error| refused(format!("{file}: {error}")))?;
        let tables = ShaperTables::parse(&text).map_err(|error| refused(format!("{file}: {error}")))?;
        let mut joints = Vec::new();
        for (number, axis) in tables.axes.iter().enumerate() {
            let axis = Axis::new(axis).map_err(|error| refused(format!("{file}: {error}")))?;
            joints.push(Joint::new(component, number, axis)?);
        }
        Ok(Self {
            component,
            period_s: 1.0 / tables.sample_hz,
            wrong_period: component.pin("posicast-shaper.wrong-period", Direction::Out, false)?,
            joints,
        })
    }
}

/// Shapes the commands of all axes: the function `posicast-shaper.update` of the servo thread.
unsafe extern "C" fn update(shapers: *mut c_void, period_ns: c_long) {
    // SAFETY: `rtapi_app_main` gave the HAL this address, and only this function uses what is there until the HAL no longer calls it.
    let shapers = unsafe { &mut *shapers.cast::<Shapers>() };
    let is_wrong = (period_ns as f64 * 1e-9 - shapers.period_s).abs() > PERIOD_TOLERANCE * shapers.period_s;
    shapers.wrong_period.set(is_wrong);
    for joint in &mut shapers.joints {
        joint.update(!is_wrong);
    }
}

/// Loads the component: called by `loadrt`. Returns 0, or the HAL's negative error.
#[unsafe(no_mangle)]
pub extern "C" fn rtapi_app_main() -> c_int {
    match Component::new(c"posicast_shaper").and_then(start) {
        Ok(()) => 0,
        Err(status) => status,
    }
}

fn start(component: Component) -> Result<(), c_int> {
    let begun = Shapers::load(component).and_then(|shapers| {
        let shapers = Box::into_raw(Box::new(shapers));
        LOADED.store(shapers, Ordering::Release);
        component.export(c"posicast-shaper.update", update, shapers.cast())?;
        component.ready()
    });
    if begun.is_err() {
        component.exit();
        free();
    }
    begun
}

/// Frees the shapers, which no thread uses any more.
fn free() {
    let shapers = LOADED.swap(null_mut(), Ordering::AcqRel);
    if !shapers.is_null() {
        // SAFETY: it came from a box, and the swap makes sure that it is freed once.
        drop(unsafe { Box::from_raw(shapers) });
    }
}

/// Unloads the component: called by `unloadrt`.
#[unsafe(no_mangle)]
pub extern "C" fn rtapi_app_exit() {
    let shapers = LOADED.load(Ordering::Acquire);
    if !shapers.is_null() {
        // SAFETY: `free` has not been called yet.
        unsafe { &*shapers }.component.exit();
    }
    free();
}
