//! Input shapers: from the modes of an axis to impulses, and from these to the tap table of the hardware.
//!
//! ```text
//! axis (modes, choice) ─► design ─► impulses ─► digitise ─► taps
//!                                      └────────────┴─────► analysis, certify
//! ```
//!
//! Nothing here knows a machine file, hardware, or files. [`firmware`] has the shapers as firmware of printers computes them.
//!
//! ```
//! use posicast_shaper::design::kind::ShaperKind;
//! use posicast_shaper::design::zv;
//! use posicast_shaper::mode::Mode;
//!
//! let mode = Mode { frequency_hz: 40.0, damping: 0.0 };
//! let impulses = zv::design(ShaperKind::Zv, &mode, 1)?;
//! assert!((impulses.impulses()[1].time_s - 0.0125).abs() < 1e-12);
//! # Ok::<(), posicast_shaper::design::DesignError>(())
//! ```

pub mod analysis;
pub mod axis;
pub mod certify;
pub mod design;
pub mod digitise;
pub mod firmware;
pub mod impulse;
pub mod mode;
pub mod unit;
