//! A small design with every kind of cell that is read back, and its model.

#![cfg(test)] // lets clippy see that this is test code

use posicast_bitstream::boards::FpgaBoard;
use posicast_bitstream::network::{NetlistSimulation, Network};

/// A shift register at the serial line addresses four memories, of which one has words of 36 bits with other contents in each half, and one
/// has 16 words that are read without a clock; sums with and without enable, reset and set; wide choices.
pub(crate) const DESIGN: &str = "\
module small (input wire clk, input wire serial_rx, output reg serial_tx, output wire led_n);
    reg [43:0] shift = 44'd0;
    reg [35:0] wide [0:511];
    reg [17:0] word [0:1023];
    reg [8:0] byte [0:2047];
    reg [7:0] few [0:15];
    reg [35:0] wide_q = 36'd0;
    reg [17:0] word_q = 18'd0;
    reg [8:0] byte_q = 9'd0;
    reg [15:0] sum = 16'd0;
    reg [11:0] down = 12'hFFF;
    integer i;
    initial begin
        for (i = 0; i < 512; i = i + 1) wide[i] = {18'd0 + i, 18'h2AAAA};
        for (i = 0; i < 1024; i = i + 1) word[i] = i * 5;
        for (i = 0; i < 2048; i = i + 1) byte[i] = i * 3;
        for (i = 0; i < 16; i = i + 1) few[i] = i * 29;
        serial_tx = 1'b0;
    end
    wire [63:0] choices = {wide_q, word_q, byte_q, shift[0]};
    wire [7:0] few_q = few[shift[26:23]];
    assign led_n = ^{sum[15], down[11], byte_q[8], few_q[shift[33:31]]};
    always @(posedge clk) begin
        shift <= {shift[42:0], serial_rx};
        if (shift[43]) wide[shift[8:0]] <= shift[40:5];
        if (shift[42]) word[shift[19:10]] <= shift[37:20];
        if (shift[41]) byte[shift[20:10]] <= shift[30:22];
        if (!shift[40]) few[shift[15:12]] <= shift[39:32];
        wide_q <= wide[shift[17:9]];
        word_q <= word[shift[9:0]];
        byte_q <= byte[shift[10:0]];
        serial_tx <= choices[shift[36:31]];
        if (shift[7] & shift[12]) sum <= 16'd0;
        else if (shift[3]) sum <= sum + shift[30:15];
        if (shift[8:5] == 4'd9) down <= 12'hFFF;
        else if (!shift[4]) down <= down - shift[22:11];
    end
endmodule
";

/// The same design.
struct Model {
    shift: u64,
    wide: Vec<u64>,
    word: Vec<u64>,
    byte: Vec<u64>,
    few: Vec<u64>,
    read: [u64; 3],
    sum: u64,
    down: u64,
    serial_tx: bool,
}

impl Model {
    fn new() -> Self {
        Self {
            shift: 0,
            wide: (0..512).map(|i| i << 18 | 0x2_AAAA).collect(),
            word: (0..1024).map(|i| (i * 5) & 0x3_FFFF).collect(),
            byte: (0..2048).map(|i| (i * 3) & 0x1FF).collect(),
            few: (0..16).map(|i| (i * 29) & 0xFF).collect(),
            read: [0; 3],
            sum: 0,
            down: 0xFFF,
            serial_tx: false,
        }
    }

    fn led_n(&self) -> bool {
        let few = self.few[(self.shift >> 23 & 15) as usize] >> (self.shift >> 31 & 7);
        (self.sum >> 15 ^ self.down >> 11 ^ self.read[2] >> 8 ^ few) & 1 == 1
    }

    fn clock(&mut self, serial_rx: bool) {
        let shift = self.shift;
        let bits = |high: u32, low: u32| shift >> low & ((1 << (high - low + 1)) - 1);
        let bit = |bit: u32| shift >> bit & 1 == 1;
        let [wide, word, byte] = self.read;
        let choices = u128::from(wide) << 28 | u128::from(word) << 10 | u128::from(byte) << 1 | u128::from(shift & 1);
        self.serial_tx = choices >> bits(36, 31) & 1 == 1;
        self.read = [
            self.wide[bits(17, 9) as usize],
            self.word[bits(9, 0) as usize],
            self.byte[bits(10, 0) as usize],
        ];
        if bit(43) {
            self.wide[bits(8, 0) as usize] = bits(40, 5);
        }
        if bit(42) {
            self.word[bits(19, 10) as usize] = bits(37, 20);
        }
        if bit(41) {
            self.byte[bits(20, 10) as usize] = bits(30, 22);
        }
        if !bit(40) {
            self.few[bits(15, 12) as usize] = bits(39, 32);
        }
        if bit(7) && bit(12) {
            self.sum = 0;
        } else if bit(3) {
            self.sum = (self.sum + bits(30, 15)) & 0xFFFF;
        }
        if bits(8, 5) == 9 {
            self.down = 0xFFF;
        } else if !bit(4) {
            self.down = self.down.wrapping_sub(bits(22, 11)) & 0xFFF;
        }
        self.shift = (shift << 1 | u64::from(serial_rx)) & ((1 << 44) - 1);
    }
}

/// The first clock in which a pin of the bits is not that of the model.
pub(crate) fn first_difference(network: &Network, board: &FpgaBoard, clocks: u64) -> Option<u64> {
    let [(_, clock), (_, rx), (_, tx), (_, led)] = board.pins();
    let mut simulation = NetlistSimulation::new(network, clock.pin).unwrap();
    let rx = simulation.input(rx.pin).unwrap();
    let [tx, led] = [tx, led].map(|pin| simulation.output(pin.pin).unwrap());
    let mut model = Model::new();
    let mut random = 1u64;
    (0..clocks).find(|_| {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        let level = random >> 63 == 1;
        simulation.set(rx, level);
        simulation.settle();
        let differs = (simulation.level(tx), simulation.level(led)) != (model.serial_tx, model.led_n());
        simulation.clock();
        model.clock(level);
        differs
    })
}
