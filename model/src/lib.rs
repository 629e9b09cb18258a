//! All computations of posicast, without RTL and without input and output: the machine file, shaper design, analysis,
//! digitising, the simulated plant, and one bit-exact, cycle-accurate model per hardware block.
//!
//! A number flows from left to right once:
//!
//! ```text
//! machine_file ─► design ─► impulses ─► digitise ─► taps ─► rtl::shaper
//!   │                           └────────────┴────────────► analysis, plant
//!   └─► control ─► gains ─► rtl::sliding_mode
//! machine_file, design ─► hardware: what is built of all that
//! ```

pub mod analysis;
pub mod certify;
pub mod compare;
pub mod contour;
pub mod control;
pub mod design;
pub mod digitise;
pub mod firmware;
pub mod hardware;
pub mod impulse;
pub mod link;
pub mod machine_file;
pub mod mechanics;
pub mod mode;
pub mod motion;
pub mod papers;
pub mod plant;
pub mod rtl;
pub mod shaper_tables;
pub mod simulation;
pub mod spelling;
pub mod taps;
pub mod unit;
