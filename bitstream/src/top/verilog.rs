//! The Verilog of the top.

use super::crc::{checksum, followed_by};
use super::{BAUD, BYTE_BITS, BoardTop, COMMAND_MARK, PAUSE_BITS, RESET_CLOCKS, RESULT_MARK};
use std::fmt::Write;

impl BoardTop {
    /// The module in Verilog.
    #[must_use]
    pub fn verilog(&self) -> String {
        let [receive, frame, send] = [self.receiver(), self.frame(), self.sender()];
        let (board, module, last_reset) = (self.board, self.module(), RESET_CLOCKS);
        let (led, lit) = match board.led_is_active_low {
            true => ("led_n", "!"),
            false => ("led", ""),
        };
        let flags: Vec<String> = self
            .axes
            .iter()
            .map(|axis| format!("{0}_saturated || {0}_overrun", axis.name))
            .collect();
        let flags = flags.join(" || ");
        format!(
            "\
// The shapers of {machine} on {title} ({device}), behind its serial line.
//
//   host -> board   {mark:02X}, the command words of all axes ({axes}), checksum
//   board -> host   {result:02X}, the shaped words of the same axes, checksum, at every sample
//
// The checksum of all bytes before it is a CRC-8 (polynomial 07, start value 0, highest bit first). A word has {word_bytes} bytes, the lowest
// first, with {word_bits} bits, two's complement. The line has {baud} baud, 8 data bits, no parity, one stop bit. A pause of {PAUSE_BITS} bits
// begins a new frame. {led} is lit while a shaper has clamped an output or lost a sample.
//
// Written by posicast {version} for the machine {machine}, for an oscillator of {mhz} MHz. Nobody has run it on hardware yet.

`default_nettype none

module {module} (
    input  wire clk,
    input  wire serial_rx,
    output wire serial_tx,
    output wire {led}
);
    // The device sets registers to 0 at power-up. Its memories cannot be read in the first microseconds, so the reset is long.
    reg  [7:0] resets = 8'd0;
    wire       rst    = (resets != 8'd{last_reset});

    always @(posedge clk) begin
        if (rst) resets <= resets + 8'd1;
    end

{receive}
{frame}
{shapers}
    assign {led} = {lit}({flags});

{send}endmodule

`default_nettype wire
",
            machine = self.machine,
            title = board.title,
            device = board.device.name(),
            mark = COMMAND_MARK,
            result = RESULT_MARK,
            axes = self.axes.iter().map(|axis| axis.name.as_str()).collect::<Vec<_>>().join(", "),
            word_bytes = self.word_bytes(),
            word_bits = self.word_bits(),
            baud = BAUD,
            version = env!("CARGO_PKG_VERSION"),
            mhz = f64::from(board.oscillator_hz) / 1e6,
            shapers = self.shapers(),
        )
    }

    /// The receiver of bytes.
    fn receiver(&self) -> String {
        let bit = self.bit_clocks();
        let width = bits_for(bit - 1);
        format!(
            "    // Serial input: two registers against metastability, then each bit from its middle. rx_bits counts the bits that are still to come.
    reg  [1:0] line      = 2'b00;
    reg  {range} rx_clocks = {width}'d0;
    reg  [3:0] rx_bits   = 4'd0;
    reg  [7:0] rx_byte   = 8'd0;
    reg        rx_done   = 1'b0;

    always @(posedge clk) begin
        line     <= {{line[0], serial_rx}};
        rx_done  <= 1'b0;
        if (rst) begin
            rx_bits <= 4'd0;
        end else if (rx_bits == 4'd0) begin
            rx_clocks <= {width}'d{half};
            if (!line[1]) rx_bits <= 4'd10;
        end else if (rx_clocks != {width}'d0) begin
            rx_clocks <= rx_clocks - {width}'d1;
        end else begin
            rx_clocks <= {width}'d{last};
            // A start bit that was only a spike ends the byte.
            rx_bits   <= (rx_bits == 4'd10 && line[1]) ? 4'd0 : rx_bits - 4'd1;
            if (rx_bits != 4'd1) rx_byte <= {{line[1], rx_byte[7:1]}};
            rx_done   <= (rx_bits == 4'd1) && line[1];
        end
    end
",
            range = range(width),
            half = bit / 2 - 1,
            last = bit - 1,
        )
    }

    /// The collector of command words.
    fn frame(&self) -> String {
        let (bytes, word_bits) = (self.words_bytes(), self.word_bits());
        let (place, bits) = (bits_for(bytes + 1), 8 * bytes);
        let pause = PAUSE_BITS * self.bit_clocks();
        let idle = bits_for(pause);
        let mut text = format!(
            "    // A frame: its mark at place 0, then the bytes of the words, then the checksum. The words are taken together, if it is right.
    reg  {place_range} place = {place}'d0;
    reg  {idle_range} idle  = {idle}'d0;
    reg  {words_range} words = {bits}'d0;
    reg  [7:0] crc   = 8'd0;
    wire [7:0] crc_in = crc ^ rx_byte;
    wire [7:0] crc_next = {crc_next};
",
            place_range = range(place),
            idle_range = range(idle),
            words_range = range(bits),
            crc_next = parities("crc_in", &[0, 1, 2, 3, 4, 5, 6, 7].map(|bit| followed_by(0, 1 << bit))),
        );
        let mut taken = String::new();
        let mut spare = Vec::new();
        for (index, axis) in self.axes.iter().enumerate() {
            let low = index as u32 * 8 * self.word_bytes();
            let high = low + word_bits - 1;
            let axis = &axis.name;
            let _ = writeln!(
                text,
                "    reg  signed {} {axis}_command = {word_bits}'sd0;",
                range(word_bits)
            );
            let _ = writeln!(taken, "                    {axis}_command <= words[{high}:{low}];");
            let end = low + 8 * self.word_bytes() - 1;
            if end > high {
                spare.push(format!("words[{end}:{}]", high + 1));
            }
        }
        if !spare.is_empty() {
            let _ = writeln!(text, "    wire unused_words = &{{1'b0, {}}};", spare.join(", "));
        }
        let _ = write!(
            text,
            "
    always @(posedge clk) begin
        if (rst) begin
            place <= {place}'d0;
        end else if (rx_done) begin
            idle <= {idle}'d0;
            if (place == {place}'d0) begin
                place <= (rx_byte == 8'h{COMMAND_MARK:02x}) ? {place}'d1 : {place}'d0;
                crc   <= 8'h{first_crc:02x};
            end else if (place == {place}'d{last}) begin
                place <= {place}'d0;
                if (rx_byte == crc) begin
{taken}                end
            end else begin
                place <= place + {place}'d1;
                crc   <= crc_next;
                words <= {shifted};
            end
        end else if (idle == {idle}'d{pause}) begin
            place <= {place}'d0;
        end else begin
            idle <= idle + {idle}'d1;
        end
    end
",
            first_crc = checksum([COMMAND_MARK]),
            last = bytes + 1,
            shifted = match bytes {
                1 => "rx_byte".to_owned(),
                _ => format!("{{rx_byte, words[{}:8]}}", bits - 1),
            },
        );
        text
    }

    /// The instance of the machine's example, which joins strobe and shapers.
    fn shapers(&self) -> String {
        let word = format!("signed [{}:0]", self.word_bits() - 1);
        let mut text =
            String::from("    // The machine's shapers with their strobe, as in the kit.\n    wire unused_strobe;\n");
        let mut ports = String::new();
        for (index, axis) in self.axes.iter().enumerate() {
            let axis = &axis.name;
            // Only one axis tells when all results stand.
            let valid = if index == self.slowest_axis() {
                format!("{axis}_valid")
            } else {
                format!("unused_{axis}_valid")
            };
            let _ = writeln!(
                text,
                "    wire {word} {axis}_shaped;\n    wire {valid}, {axis}_saturated, {axis}_overrun;"
            );
            for (port, wire) in [
                ("command", ""),
                ("shaped", ""),
                ("valid", valid.as_str()),
                ("saturated", ""),
                ("overrun", ""),
            ] {
                let wire = if wire.is_empty() {
                    format!("{axis}_{port}")
                } else {
                    wire.to_owned()
                };
                let _ = writeln!(ports, "        .{axis}_{port}({wire}),");
            }
        }
        let _ = write!(
            text,
            "\n    {machine}_example #(.SAMPLE_CLOCKS(32'd{clocks})) u_shapers (\n        .clk(clk),\n        .rst(rst),\n{ports}        \
             .strobe(unused_strobe)\n    );\n",
            machine = self.machine,
            clocks = self.sample_clocks,
        );
        text
    }

    /// The sender of results.
    fn sender(&self) -> String {
        let bits = BYTE_BITS * self.frame_bytes();
        let width = bits_for(self.bit_clocks() - 1);
        let (word_bits, padded) = (self.word_bits(), 8 * self.word_bytes());
        let mut words = String::new();
        let mut names = Vec::new();
        let mut frame = vec![format!("1'b1, 8'h{RESULT_MARK:02x}, 1'b0")];
        for axis in &self.axes {
            let axis = &axis.name;
            let value = match padded - word_bits {
                0 => format!("{axis}_shaped"),
                missing => format!("{{{{{missing}{{{axis}_shaped[{}]}}}}, {axis}_shaped}}", word_bits - 1),
            };
            let _ = writeln!(words, "    wire [{}:0] {axis}_word = {value};", padded - 1);
            for byte in 0..self.word_bytes() {
                frame.push(format!("1'b1, {axis}_word[{}:{}], 1'b0", 8 * byte + 7, 8 * byte));
            }
            names.push(format!("{axis}_word"));
        }
        frame.push("1'b1, result_crc, 1'b0".to_owned());
        frame.reverse();
        names.reverse();
        // What a bit of the words changes does not depend on the other bits.
        let zeros = vec![0; self.words_bytes() as usize];
        let crc_of = |words: Vec<u8>| checksum([RESULT_MARK].into_iter().chain(words));
        let of_zeros = crc_of(zeros.clone());
        let changed_by = |bit: usize| {
            let mut words = zeros.clone();
            words[bit / 8] |= 1 << (bit % 8);
            crc_of(words) ^ of_zeros
        };
        let changes: Vec<u8> = (0..8 * zeros.len()).map(changed_by).collect();
        let valid = self.axes.get(self.slowest_axis()).map_or("", |axis| axis.name.as_str());
        format!(
            "    // Serial output: the frame with the start and stop bits of its bytes, lowest bit first. Each bit of the checksum is the parity of
    // some bits of the words.
{words}    wire {words_range} result_words = {{{names}}};
    wire [7:0] result_crc = 8'h{of_zeros:02x} ^ {parities};
    reg  [{last_bit}:0] tx_bits   = {bits}'d0;
    reg  {range} tx_clocks = {width}'d0;

    assign serial_tx = tx_bits[0];

    always @(posedge clk) begin
        if (rst) begin
            tx_bits   <= {{{bits}{{1'b1}}}};
            tx_clocks <= {width}'d0;
        end else if ({valid}_valid) begin
            tx_bits <= {{
                {frame}
            }};
            tx_clocks <= {width}'d{last};
        end else if (tx_clocks != {width}'d0) begin
            tx_clocks <= tx_clocks - {width}'d1;
        end else begin
            tx_clocks <= {width}'d{last};
            tx_bits   <= {{1'b1, tx_bits[{last_bit}:1]}};
        end
    end
",
            last_bit = bits - 1,
            range = range(width),
            words_range = range(8 * self.words_bytes()),
            names = names.join(", "),
            parities = parities("result_words", &changes),
            frame = frame.join(",\n                "),
            last = self.bit_clocks() - 1,
        )
    }
}

/// The eight bits of a checksum, each the parity of those bits of the net `name` that change it: bit `i` of the net changes the bits of
/// `changes[i]`.
fn parities(name: &str, changes: &[u8]) -> String {
    let parity = |place: u32| {
        let digits = changes.chunks(4).rev().map(|four| {
            let bits = four
                .iter()
                .enumerate()
                .map(|(bit, change)| (change >> place & 1) << bit);
            format!("{:x}", bits.sum::<u8>())
        });
        format!("^({name} & {}'h{})", changes.len(), digits.collect::<String>())
    };
    let rows: Vec<String> = (0..u8::BITS).rev().map(parity).collect();
    format!("{{\n        {}\n    }}", rows.join(",\n        "))
}

/// Number of bits that hold `largest`.
fn bits_for(largest: u32) -> u32 {
    (u32::BITS - largest.leading_zeros()).max(1)
}

/// Range of a register of this width.
fn range(width: u32) -> String {
    format!("[{}:0]", width - 1)
}
