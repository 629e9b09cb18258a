//! Assigns the ports of the top level to pins of a board.
//!
//! Clock, reset and the system's serial line, if the fabric has one, have fixed pins on the board. The line of a stage without a processor
//! is on the headers, because the board's own serial line has an RS-232 driver, which is slower than the rates of `[link]`. All other ports
//! are on the expansion headers from `GPIO_0[0]` upwards, in the order of the stage's ports: first those that belong to no axis, then axis
//! by axis.

use super::SopcError;
use super::board::Board;
use super::core::{Core, Line};
use super::unit::{PINS, Unit};

/// Ports of the stage that do not leave the device: the tick is for a trace, and there is no PLL to monitor.
const INSIDE: [&str; 2] = ["tick", "pll_locked"];

/// Suffix of the ports that start an ADC's conversion. The ADC's own logic is in the device, and these boards'
/// headers have no pins to spare for four axes.
const ADC_TRIGGER: &str = "_pwm_trigger";

/// Returns whether a port of the stage has no pin.
pub(super) fn stays_inside(port: &str) -> bool {
    INSIDE.contains(&port) || port.ends_with(ADC_TRIGGER)
}

/// Ports of the top level in addition to those of the stage.
pub(super) const CLOCK: &str = "clock_50";
pub(super) const RESET: &str = "reset_button_n";
pub(super) const UART_RECEIVE: &str = "uart_rxd";
pub(super) const UART_TRANSMIT: &str = "uart_txd";
/// The lines of SPI, which have the names of the stage's ports, and whether they are inputs.
pub(super) const SPI: [(&str, bool); 4] = [
    ("spi_sck", true),
    ("spi_cs_n", true),
    ("spi_mosi", true),
    ("spi_miso", false),
];

/// Lines to a host that are high while nobody sends, or nobody is connected.
pub(super) const RESTS_HIGH: [&str; 2] = [UART_RECEIVE, "spi_cs_n"];

/// Purpose of a port of the top level.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Use {
    Clock,
    Reset,
    /// A line to the host.
    Line,
    /// A port of the stage's conduits.
    Stage,
}

/// A one-bit port of the top level with its pin.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Pin {
    pub(super) port: String,
    pub(super) is_input: bool,
    pub(super) purpose: Use,
    /// Pin of the device, without `PIN_`.
    pub(super) location: &'static str,
    /// Name on the board.
    pub(super) on_board: String,
    /// Conduit and role of a port of the stage.
    pub(super) conduit: Option<(String, String)>,
}

/// Assigns the pins of a project on a board.
///
/// # Errors
/// [`SopcError::Pins`] if the headers have fewer pins than needed, [`SopcError::Wide`] for a port of more than one bit.
pub(super) fn assign(board: Board, core: Core<'_>, stage: &Unit<'_>) -> Result<Vec<Pin>, SopcError> {
    let facts = board.facts();
    let fixed = |port: &str, is_input, purpose, location, on_board: &str| Pin {
        port: port.to_owned(),
        is_input,
        purpose,
        location,
        on_board: on_board.to_owned(),
        conduit: None,
    };
    let mut pins = vec![
        fixed(CLOCK, true, Use::Clock, facts.clock_pin, "CLOCK_50"),
        fixed(RESET, true, Use::Reset, facts.reset_pin.0, facts.reset_pin.1),
    ];
    let mut on_headers = Vec::new();
    match (core, facts.uart_pins) {
        (Core::Link(_, Line::Spi), _) => {
            on_headers.extend(SPI.map(|(port, is_input)| (port.to_owned(), is_input, Use::Line, None)));
        }
        (Core::System, Some([receive, transmit])) => pins.extend([
            fixed(UART_RECEIVE, true, Use::Line, receive, "UART_RXD"),
            fixed(UART_TRANSMIT, false, Use::Line, transmit, "UART_TXD"),
        ]),
        _ => on_headers.extend([
            (UART_RECEIVE.to_owned(), true, Use::Line, None),
            (UART_TRANSMIT.to_owned(), false, Use::Line, None),
        ]),
    }
    let mut conduits = stage.conduits();
    conduits.sort_by_key(|conduit| conduit.name != PINS);
    for conduit in conduits {
        for signal in conduit.signals {
            if stays_inside(&signal.port) {
                continue;
            }
            if signal.width != 1 {
                return Err(SopcError::Wide { port: signal.port });
            }
            let place = Some((conduit.name.clone(), signal.role));
            on_headers.push((signal.port, signal.is_input, Use::Stage, place));
        }
    }
    let places = facts.headers.iter().enumerate().flat_map(|(header, locations)| {
        let place = move |(index, location): (usize, &&'static str)| (format!("GPIO_{header}[{index}]"), *location);
        locations.iter().enumerate().map(place)
    });
    let available = facts.headers.as_flattened().len();
    if on_headers.len() > available {
        return Err(SopcError::Pins {
            board,
            needed: on_headers.len(),
            available,
        });
    }
    let placed = on_headers.into_iter().zip(places);
    pins.extend(
        placed.map(|((port, is_input, purpose, conduit), (on_board, location))| Pin {
            port,
            is_input,
            purpose,
            location,
            on_board,
            conduit,
        }),
    );
    Ok(pins)
}
