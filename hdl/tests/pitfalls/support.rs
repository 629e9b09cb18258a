//! Shared parts of the emitter's tests: a short way to write a kernel, its simulation over vectors, and small leaves.

use posicast_hdl::emit::{EmitError, EmitOptions, Header, Module, emit};
pub(crate) use rust_hdl_core::prelude::*;

/// A block that a row of the table can drive: all inputs except the clock and all outputs as bit patterns, in port
/// order.
pub(crate) trait Kernel: Block + Default {
    fn set(&mut self, inputs: &[u64]);
    fn get(&self) -> Vec<u64>;
    fn clock(&mut self, level: bool);
}

/// A bit pattern as a RustHDL value.
pub(crate) trait FromPattern {
    fn from_pattern(pattern: u64) -> Self;
}

impl FromPattern for bool {
    fn from_pattern(pattern: u64) -> Self {
        pattern & 1 == 1
    }
}

impl<const N: usize> FromPattern for Bits<N> {
    fn from_pattern(pattern: u64) -> Self {
        Bits::from(pattern & (u64::MAX >> (64 - N)))
    }
}

impl<const N: usize> FromPattern for Signed<N> {
    fn from_pattern(pattern: u64) -> Self {
        signed_cast(Bits::from_pattern(pattern))
    }
}

/// A RustHDL value as a bit pattern.
pub(crate) fn pattern<T: Synth>(value: T) -> u64 {
    let text = format!("{:x}", value.verilog());
    u64::from_str_radix(text.split_once("'h").unwrap().1, 16).unwrap()
}

/// A `signed_bit_cast` that accepts the most negative value, which RustHDL's own does not.
pub(crate) fn signed_bit_cast<const M: usize, const N: usize>(x: Signed<N>) -> Signed<M> {
    let bits = unsigned_cast(x);
    signed_cast(if x.sign_bit() {
        !bit_cast::<M, N>(!bits)
    } else {
        bit_cast::<M, N>(bits)
    })
}

/// `kernel!(Name { in a: T, .. out y: T, .. more { field: T = value, .. } update })`
macro_rules! kernel {
    ($name:ident { $($in:ident: $in_type:ty),* => $($out:ident: $out_type:ty),* }
     $({ $($field:ident: $type:ty = $value:expr),* })? $(@ $clk:ident)? ; $($update:tt)*) => {
        #[derive(LogicBlock)]
        struct $name {
            $($clk: Signal<In, Clock>,)?
            $($in: Signal<In, $in_type>,)*
            $($out: Signal<Out, $out_type>,)*
            $($($field: $type,)*)?
        }
        impl Default for $name {
            fn default() -> Self {
                Self {
                    $($clk: Default::default(),)?
                    $($in: Default::default(),)*
                    $($out: Default::default(),)*
                    $($($field: $value,)*)?
                }
            }
        }
        impl Logic for $name {
            $($update)*
        }
        impl $crate::pitfalls::support::Kernel for $name {
            fn set(&mut self, inputs: &[u64]) {
                let mut inputs = inputs.iter();
                $(self.$in.next = <$in_type as $crate::pitfalls::support::FromPattern>::from_pattern(*inputs.next().unwrap());)*
            }
            fn get(&self) -> Vec<u64> {
                vec![$($crate::pitfalls::support::pattern(self.$out.val())),*]
            }
            #[allow(unused_variables)]
            fn clock(&mut self, level: bool) {
                $(self.$clk.next = level.into();)?
            }
        }
    };
}

/// Creates a Local.
pub(crate) fn local<T: Synth>() -> Signal<Local, T> {
    Signal::default()
}

/// A kernel under test: its Verilog, and the outputs of the simulation for each stimulus.
pub(crate) struct Row {
    pub(crate) name: String,
    pub(crate) modules: Result<Vec<Module>, EmitError>,
    /// Inputs, then outputs, as in the port list without `clk`.
    pub(crate) vectors: Vec<Vec<u64>>,
}

/// Emits `K` as `NAME_dut`.
pub(crate) fn emit_as<K: Block + Default>(name: &str) -> Result<Vec<Module>, EmitError> {
    emit_block(&K::default(), name)
}

/// Emits `block` as `NAME_dut`; all its modules contain the name, so that kernels do not collide.
pub(crate) fn emit_block<B: Block>(block: &B, name: &str) -> Result<Vec<Module>, EmitError> {
    let header = Header {
        ports: Vec::new(),
        about: "A kernel of the emitter's tests.".to_owned(),
        parameters: Vec::new(),
    };
    let options = EmitOptions {
        top: "dut".to_owned(),
        prefix: String::new(),
        header,
    };
    let mut modules = emit(block, &options)?;
    let names: Vec<String> = modules.iter().map(|module| module.name.clone()).collect();
    for module in &mut modules {
        for old in &names {
            for (before, behind) in [("// ", "\n"), ("module ", " ("), ("    ", " u_")] {
                let renamed = format!("{before}{name}_{old}{behind}");
                module.text = module.text.replace(&format!("{before}{old}{behind}"), &renamed);
            }
        }
        module.name = format!("{name}_{}", module.name);
    }
    Ok(modules)
}

/// Returns the text of the top module of `K`.
pub(crate) fn text_of<K: Block + Default>() -> String {
    emit_as::<K>("of").unwrap().pop().unwrap().text
}

/// Emits `K` and simulates it in RustHDL, one clock per stimulus; the outputs are those before the rising edge.
pub(crate) fn row<K: Kernel>(name: &str, stimuli: Vec<Vec<u64>>) -> Row {
    let mut kernel = K::default();
    kernel.connect_all();
    let mut vectors = Vec::new();
    for inputs in stimuli {
        kernel.set(&inputs);
        assert!(simulate(&mut kernel, 100), "{name} does not settle");
        vectors.push([inputs, kernel.get()].concat());
        for level in [true, false] {
            kernel.clock(level);
            assert!(simulate(&mut kernel, 100), "{name} does not settle");
        }
    }
    Row {
        name: name.to_owned(),
        modules: emit_as::<K>(name),
        vectors,
    }
}

/// Returns every pair of the corner values of two widths.
pub(crate) fn pairs(a: u32, b: u32) -> Vec<Vec<u64>> {
    corners(a)
        .iter()
        .flat_map(|&x| corners(b).iter().map(move |&y| vec![x, y]))
        .collect()
}

fn corners(width: u32) -> &'static [u64] {
    match width {
        8 => &[0, 1, 2, 3, 4, 5, 6, 7, 15, 16, 100, 127, 128, 129, 200, 240, 254, 255],
        16 => &[
            0, 1, 4, 5, 7, 8, 15, 16, 127, 128, 240, 255, 256, 1000, 4095, 16384, 32766, 32767, 32768, 32769, 40000,
            65000, 65531, 65532, 65533, 65534, 65535,
        ],
        32 => &[
            0,
            1,
            32767,
            32768,
            65535,
            65536,
            0x7fff_ffff,
            0x8000_0000,
            0xffff_fff0,
            0xffff_ffff,
        ],
        64 => &[
            0,
            1,
            0x3ff,
            0x7fff_ffff,
            0x1_0000_0000,
            0x7fff_ffff_ffff_ffff,
            0x8000_0000_0000_0000,
            0x8000_0000_0000_0001,
            0xffff_ffff_0000_0000,
            0x0123_4567_89ab_cdef,
            0xffff_ffff_ffff_fffe,
            u64::MAX,
        ],
        _ => panic!("no corner values for {width} bits"),
    }
}

/// A register.
#[derive(LogicBlock, Clone, Debug)]
pub(crate) struct Dff<T: Synth> {
    pub(crate) clock: Signal<In, Clock>,
    pub(crate) rst: Signal<In, Bit>,
    pub(crate) d: Signal<In, T>,
    pub(crate) q: Signal<Out, T>,
    _initial: T,
}

impl<T: Synth> Dff<T> {
    pub(crate) fn new(initial: T) -> Self {
        Self {
            clock: Default::default(),
            rst: Default::default(),
            d: Default::default(),
            q: Signal::new_with_default(initial),
            _initial: initial,
        }
    }
}

impl<T: Synth> Logic for Dff<T> {
    fn update(&mut self) {
        if self.clock.pos_edge() {
            self.q.next = if self.rst.val() { self._initial } else { self.d.val() };
        }
    }
    fn connect(&mut self) {
        self.q.connect();
    }
    fn hdl(&self) -> Verilog {
        Verilog::Custom(format!("// @dff {}'h{:x}", T::BITS, pattern(self._initial)))
    }
}

/// Connects clock, reset and default value of registers; the emitter recognises the macro by its name.
macro_rules! dff_setup {
    ($self:ident, $clk:ident, $($dff:ident),+) => {
        $($self.$dff.clock.next = $self.$clk.val();
          $self.$dff.rst.next = $self.rst.val();
          $self.$dff.d.next = $self.$dff.q.val();)+
    };
}

/// RustHDL turns `comment!` into a comment, but provides no macro of that name.
macro_rules! comment {
    ($($text:tt)*) => {};
}

/// A block RAM of 16 x 8 bits.
#[derive(LogicBlock, Clone, Debug, Default)]
pub(crate) struct Ram16x8 {
    pub(crate) clk: Signal<In, Clock>,
    pub(crate) write_enable: Signal<In, Bit>,
    pub(crate) write_address: Signal<In, Bits<4>>,
    pub(crate) write_data: Signal<In, Bits<8>>,
    pub(crate) read_address: Signal<In, Bits<4>>,
    pub(crate) read_data: Signal<Out, Bits<8>>,
    _memory: [u64; 16],
}

impl Logic for Ram16x8 {
    fn update(&mut self) {
        if self.clk.pos_edge() {
            self.read_data.next = self._memory[self.read_address.val().index()].into();
            if self.write_enable.val() {
                self._memory[self.write_address.val().index()] = pattern(self.write_data.val());
            }
        }
    }
    fn connect(&mut self) {
        self.read_data.connect();
    }
    fn hdl(&self) -> Verilog {
        let text = "// @leaf ram_16x8 reg: read_data
// @about 16 x 8 bit block RAM, registered read.
reg [7:0] memory [0:15];
integer i;
initial begin
    read_data = 8'd0;
    for (i = 0; i < 16; i = i + 1) memory[i] = 8'd0;
end
always @(posedge clk) begin
    if (write_enable) memory[write_address] <= write_data;
    read_data <= memory[read_address];
end";
        Verilog::Custom(text.to_owned())
    }
}
