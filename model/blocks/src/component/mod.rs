//! Components: blocks that stand alone, each with its registers on an Avalon-MM agent and the blocks that it needs.
//!
//! ```text
//! avs_* ─► registers ─┬─► configuration, commands ─► block ─► conduit pins
//!   irq ◄─            └─◄ live words, events ◄──────
//! ```
//!
//! | component | block | additional blocks |
//! |---|---|---|
//! | [`Component::shaper`] | [`shaper`](super::shaper) | [`sample_select`](super::sample_select) |
//! | [`Component::pwm`] | [`pwm`](super::pwm) | [`sample_select`](super::sample_select) |
//! | [`Component::sliding_mode`] | [`sliding_mode`](super::sliding_mode) | [`sample_select`](super::sample_select), [`setting_banks`](super::setting_banks) |
//! | [`Component::pulse_counter`] | [`pulse_counter`](super::pulse_counter) | [`divider`](super::divider), [`time_base`](super::time_base) |
//!
//! A component consists of its register map and its [`Composition`]; this crate's model and
//! `posicast_hdl::component`'s Verilog are made from these.
//!
//! ```
//! use posicast_blocks::ClockedBlock;
//! use posicast_blocks::component::Component;
//! use posicast_blocks::divider::DividerConfig;
//!
//! let counter = Component::pulse_counter(DividerConfig::new(5000)?, 8, false)?;
//! let model = counter.model(1);
//! assert_eq!(model.ports()[1].name, "avs_address");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod joined;
mod pulse_counter;
mod pwm;
mod shaper;
mod sliding_mode;

pub(crate) use self::joined::Wiring;
pub use self::joined::{ComponentPart, JoinedBlocks};

use super::Moore;
use super::composition::{Composed, Composition, CompositionError};
use super::divider::{DIVISION_CLOCKS, DividerConfig};
use super::pwm::{BridgeMode, PwmConfig};
use super::registers::{Description, MapError, RegisterMap};
use super::shaper::ShaperConfig;
use super::sliding_mode::{Law, Settings};

/// Input ports of the agent, with reset.
const BUS_INPUTS: [&str; 6] = [
    "rst",
    "avs_address",
    "avs_read",
    "avs_write",
    "avs_byteenable",
    "avs_writedata",
];
/// Output ports of the agent.
const BUS_OUTPUTS: [&str; 2] = ["avs_readdata", "irq"];

/// A block that stands alone, with its registers.
#[derive(Debug, Clone, PartialEq)]
pub struct Component {
    map: RegisterMap,
    joined: JoinedBlocks,
}

/// Why a component cannot be made.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ComponentError {
    /// Ticks are shorter than a division.
    #[error(
        "ticks of {0} clocks: a division takes {DIVISION_CLOCKS}; ticks must be longer, so choose a lower sample rate or a \
         faster clock"
    )]
    Tick(u32),
    /// The register does not hold the filter length.
    #[error("a filter of {0} clocks: the pulse counter has one of 0 to 63")]
    Filter(u32),
    /// The carrier cannot have this period.
    #[error("a PWM period of {0} clocks: 2 to 65536 are possible; choose another PWM frequency")]
    Period(u32),
    /// The register map has an error.
    #[error(transparent)]
    Map(#[from] MapError),
    /// The composition has an error.
    #[error(transparent)]
    Composition(#[from] CompositionError),
}

impl Component {
    /// The stand-alone shaper: samples come from registers or pins, tables are loaded through registers.
    ///
    /// # Errors
    /// This never returns an error for a valid `config`.
    pub fn shaper(config: ShaperConfig) -> Result<Self, ComponentError> {
        let blocks = vec![
            ComponentPart::SampleSelect {
                word_bits: config.word_bits(),
                channels: config.channels(),
            },
            ComponentPart::Shaper(Box::new(config.clone())),
        ];
        let wiring = shaper::wiring(&config);
        Self::new(super::registers::maps::shaper(&config), blocks, wiring)
    }

    /// The pulse counter with its own divider and time base. After reset its filter is `filter_clocks` long, and its
    /// direction is reversed with `invert`.
    ///
    /// # Errors
    /// [`ComponentError`] for ticks no longer than a division, or a filter above 63.
    pub fn pulse_counter(divider: DividerConfig, filter_clocks: u32, invert: bool) -> Result<Self, ComponentError> {
        if divider.tick_clocks() <= DIVISION_CLOCKS {
            return Err(ComponentError::Tick(divider.tick_clocks()));
        }
        if filter_clocks > 63 {
            return Err(ComponentError::Filter(filter_clocks));
        }
        let blocks = vec![
            ComponentPart::TimeBase(divider),
            ComponentPart::PulseCounter,
            ComponentPart::Divider(divider),
        ];
        let map = super::registers::maps::pulse_counter(&divider, filter_clocks, invert);
        Self::new(map, blocks, pulse_counter::wiring())
    }

    /// The controller with its settings in banks, the machine's in bank 0. Reference and measurement come from
    /// registers or pins.
    ///
    /// # Errors
    /// This never returns an error.
    pub fn sliding_mode(settings: &Settings, law: Law, modulo: bool) -> Result<Self, ComponentError> {
        let blocks = vec![
            ComponentPart::SampleSelect {
                word_bits: 32,
                channels: sliding_mode::MOTION.len(),
            },
            ComponentPart::SettingBanks(Box::new(*settings)),
            ComponentPart::SlidingMode,
        ];
        let map = super::registers::maps::sliding_mode(law as u32, modulo);
        Self::new(map, blocks, sliding_mode::wiring())
    }

    /// The PWM, with this mode and period after reset. Its duty comes from a register or from pins.
    ///
    /// # Errors
    /// [`ComponentError`] for periods other than 2 to 65,536 clocks.
    pub fn pwm(config: PwmConfig, mode: BridgeMode, period_clocks: u32) -> Result<Self, ComponentError> {
        if !(2..=65_536).contains(&period_clocks) {
            return Err(ComponentError::Period(period_clocks));
        }
        let blocks = vec![
            ComponentPart::SampleSelect {
                word_bits: pwm::DUTY_BITS,
                channels: 1,
            },
            ComponentPart::Pwm(config),
        ];
        let map = super::registers::maps::pwm(&config, mode, period_clocks);
        Self::new(map, blocks, pwm::wiring())
    }

    fn new(description: Description, blocks: Vec<ComponentPart>, wiring: Wiring) -> Result<Self, ComponentError> {
        let name = description.name.clone();
        let blocks = blocks.into_iter().map(|block| (block.name().to_owned(), block));
        Self::joined(RegisterMap::new(description)?, &name, blocks.collect(), wiring)
    }

    /// Joins a register bank of `map` with blocks, each under the name of its part.
    pub(super) fn joined(
        map: RegisterMap,
        name: &str,
        blocks: Vec<(String, ComponentPart)>,
        wiring: Wiring,
    ) -> Result<Self, ComponentError> {
        let bank = ("registers".to_owned(), ComponentPart::Registers(Box::new(map.clone())));
        let blocks = [vec![bank], blocks].concat();
        let bus = |pins: &[&str], more: Vec<String>| {
            let pins = pins.iter().map(|pin| (*pin).to_owned());
            pins.chain(more).collect()
        };
        let wiring = Wiring {
            inputs: bus(&BUS_INPUTS, wiring.inputs),
            outputs: bus(&BUS_OUTPUTS, wiring.outputs),
            part: wiring.part,
        };
        Ok(Self {
            map,
            joined: JoinedBlocks::new(name, blocks, wiring)?,
        })
    }

    /// Name of its block, for example `shaper`.
    pub fn name(&self) -> &str {
        self.map.name()
    }

    /// Its register map.
    pub fn map(&self) -> &RegisterMap {
        &self.map
    }

    /// Its blocks; the register bank comes first.
    pub fn blocks(&self) -> impl Iterator<Item = &ComponentPart> {
        self.joined.blocks()
    }

    /// Connections of its blocks: one part per block, in order.
    pub fn composition(&self) -> &Composition {
        self.joined.composition()
    }

    /// Its blocks, joined.
    pub fn whole(&self) -> &JoinedBlocks {
        &self.joined
    }

    /// The model of the whole after reset. `seed` determines the arbitrary contents of its memories.
    pub fn model(&self, seed: u64) -> Composed {
        self.joined.model(seed)
    }

    /// The models of its blocks, in order, after reset.
    pub fn block_models(&self, seed: u64) -> Vec<Box<dyn Moore>> {
        self.blocks().map(|block| block.model(seed)).collect()
    }
}
