//! `kernel!` generates a kernel from its ports, registers, wires, parts and constants: everything except the logic.
//!
//! ```text
//! kernel! {
//!     /// Counts to a limit.
//!     pub(super) struct Counter(config: &CounterConfig);      no parentheses where the kernel needs no configuration
//!
//!     inputs { rst: Bit, enable: Bit, limit: Bits<8> }        the input `clk` is always there
//!     outputs { count: Bits<8>, wrapped: Bit }
//!     parts { filter: GlitchFilter, divider: Divider = Divider::new(config) }
//!     registers { count_q: Bits<8>, level: Bit = true }       with a reset value that is not 0
//!     wires { sum: Bits<8> }
//!     constants { first: Bits<8> = from_u64(config.first()) }
//!     connect {
//!         filter: raw, length;                                inputs of a part, from the kernel's inputs and wires
//!         divider from filter: level;                         ... from outputs of another part
//!         outputs from divider: quotient;                     outputs of the kernel, from those of a part
//!     }
//! }
//!
//! impl Logic for Counter {
//!     #[hdl_gen]
//!     fn update(&mut self) {
//!         comment!("@module counter");
//!         if self.enable.val() {
//!             self.count_q.d.next = self.sum.val();
//!         }
//!         ...
//! ```
//!
//! | section | field | initial value |
//! |---|---|---|
//! | `inputs`, `outputs`, `wires` | `Signal<In, T>`, `Signal<Out, T>`, `Signal<Local, T>` | 0 |
//! | `parts` | `T`, another kernel or a leaf, wired to `clk` and `rst`; `connect` and the logic wire its other inputs | `= T::new(..)`, else `T::default()` |
//! | `registers` | [`Dff<T>`](crate::prim::Dff), clocked by `clk` and reset by `rst`; it keeps its value unless the logic sets `d` | `= reset value`, else 0 |
//! | `constants` | `Constant<T>` | `= value` |
//!
//! `name[N]: T` makes an array of N; constants of an array are a function of the index, `= |index| ..`. Sections are
//! in the order of the Verilog's declarations, and each may occur several times. The macro also makes the
//! constructor: `new` with the arguments after the name, or `default` where there are none.
//!
//! `connect` joins ports of the same name. Each of its lines may list several parts, `line_a, line_b: ready;`. Where
//! the names differ, or something is computed, the logic assigns the input.
//!
//! Conditions on sizes follow the name: `struct Product<const W: usize, const P: usize> where P == W + 18;`.
//!
//! The top kernel of a block takes its inputs, outputs and raw ports from the block's list of ports, which `ports!`
//! makes in the model. The sizes of such a list are those with the same names here:
//!
//! ```text
//! kernel! {
//!     pub(super) struct Pwm(config: &PwmConfig);
//!     ports posicast_blocks::pwm_ports;
//!
//!     parts { .. }
//! }
//! ```

/// See the [module](self).
macro_rules! kernel {
    // The ports come from a list in the model, whose macro calls this one back with them.
    (
        $(#[$about:meta])*
        $seen:vis struct $name:ident $(<$(const $size:ident: usize),+ $(,)?>)? $(($($argument:ident: $of:ty),+ $(,)?))?
            $(where $condition:expr)?;
        ports $($list:ident)::+;
        $($sections:tt)*
    ) => {
        $($list)::+! {
            kernel
            {
                $(#[$about])*
                $seen struct $name $(<$(const $size: usize),+>)? $(($($argument: $of),+))?
                    $(where $condition)?;
            }
            { $($sections)* }
        }
    };
    (@ports $inputs:tt $outputs:tt { $($header:tt)* } { $($sections:tt)* }) => {
        $crate::kernel::kernel! { $($header)* inputs $inputs outputs $outputs $($sections)* }
        $crate::kernel::kernel! { @pins $inputs $outputs $($header)* }
    };
    (
        @pins
        { $($input:ident $([$inputs:expr])?: $input_type:ty),* $(,)? }
        { $($output:ident $([$outputs:expr])?: $output_type:ty),* $(,)? }
        $(#[$about:meta])*
        $seen:vis struct $name:ident $(<$(const $size:ident: usize),+ $(,)?>)? $(($($argument:ident: $of:ty),+ $(,)?))?
            $(where $condition:expr)?;
    ) => {
        impl $(<$(const $size: usize),+>)? $crate::simulation::Pins for $name $(<$($size),+>)? {
            fn set_clk(&mut self, level: bool) {
                self.clk.next = level.into();
            }

            fn drive(&mut self, inputs: &[u64]) {
                let mut patterns = inputs.iter().copied();
                $($crate::simulation::InputPins::drive(&mut self.$input, &mut patterns);)*
            }

            fn read(&self, outputs: &mut [u64]) {
                let mut patterns = outputs.iter_mut();
                $($crate::simulation::OutputPins::read(&self.$output, &mut patterns);)*
            }
        }
    };
    // The sections with fields come first, then the connections.
    (@sort $header:tt [$($fields:tt)*] [$($connections:tt)*] connect { $($lines:tt)* } $($sections:tt)*) => {
        $crate::kernel::kernel! { @sort $header [$($fields)*] [$($connections)* $($lines)*] $($sections)* }
    };
    (@sort $header:tt [$($fields:tt)*] $connections:tt $section:ident $entries:tt $($sections:tt)*) => {
        $crate::kernel::kernel! { @sort $header [$($fields)* $section $entries] $connections $($sections)* }
    };
    (@sort { $($header:tt)* } [$($fields:tt)*] $connections:tt) => {
        $crate::kernel::kernel! { @block $connections $($header)* $($fields)* }
    };
    (
        @block
        [$($connections:tt)*]
        $(#[$about:meta])*
        $seen:vis struct $name:ident $(<$(const $size:ident: usize),+ $(,)?>)? $(($($argument:ident: $of:ty),+ $(,)?))?
            $(where $condition:expr)?;
        $($section:ident {
            $($(#[$meaning:meta])* $field:ident $([$count:expr])?: $type:ty $(= $initial:expr)?),* $(,)?
        })*
    ) => {
        $(#[$about])*
        $seen struct $name $(<$(const $size: usize),+>)? {
            $seen clk: Signal<In, Clock>,
            $($($(#[$meaning])* $seen $field: $crate::kernel::field_type!($section $([$count])? $type),)*)*
        }

        $crate::kernel::constructor! {
            [$(<$(const $size: usize),+>)?] $name $(<$($size),+>)?, $seen, ($($($argument: $of),+)?) {
                $(const { assert!($condition) };)?
                Self {
                    clk: Signal::default(),
                    $($($field: $crate::kernel::initial!($section $([$count])? $type $(= $initial)?),)*)*
                }
            }
        }

        impl $(<$(const $size: usize),+>)? $crate::prim::Clocked for $name $(<$($size),+>)? {
            fn clk(&mut self) -> &mut Signal<In, Clock> {
                &mut self.clk
            }

            $($($crate::kernel::reset_input!($section $field);)*)*
        }

        impl $(<$(const $size: usize),+>)? Block for $name $(<$($size),+>)? {
            fn connect_all(&mut self) {
                self.connect();
                $($($crate::kernel::claim!($section self $field);)*)*
                $crate::kernel::connections!(claim self $($connections)*);
                self.clk.connect_all();
                $($(self.$field.connect_all();)*)*
            }

            fn update_all(&mut self) {
                $($($crate::kernel::keep!($section self $field);)*)*
                self.update();
                $($($crate::kernel::clock!($section self $field);)*)*
                $crate::kernel::connections!(drive self $($connections)*);
                self.clk.update_all();
                $($(self.$field.update_all();)*)*
            }

            fn has_changed(&self) -> bool {
                self.clk.has_changed() $($(|| self.$field.has_changed())*)*
            }

            fn accept(&self, name: &str, probe: &mut dyn Probe) {
                probe.visit_start_scope(name, self);
                self.clk.accept("clk", probe);
                $($(self.$field.accept(stringify!($field), probe);)*)*
                let connections = &mut $crate::prim::Connections::default();
                $($($crate::kernel::list_part!($section connections $field);)*)*
                $crate::kernel::connections!(list connections $($connections)*);
                connections.accept("connections", probe);
                probe.visit_end_scope(name, self);
            }
        }
    };
    (
        $(#[$about:meta])*
        $seen:vis struct $name:ident $(<$(const $size:ident: usize),+ $(,)?>)? $(($($argument:ident: $of:ty),+ $(,)?))?
            $(where $condition:expr)?;
        $($sections:tt)*
    ) => {
        $crate::kernel::kernel! {
            @sort
            {
                $(#[$about])*
                $seen struct $name $(<$(const $size: usize),+>)? $(($($argument: $of),+))? $(where $condition)?;
            }
            [] [] $($sections)*
        }
    };
}

/// The type of a field in its section.
macro_rules! field_type {
    ($section:ident [$count:expr] $type:ty) => { [$crate::kernel::field_type!($section $type); $count] };
    (inputs $type:ty) => { Signal<In, $type> };
    (outputs $type:ty) => { Signal<Out, $type> };
    (wires $type:ty) => { Signal<Local, $type> };
    (registers $type:ty) => { $crate::prim::Dff<$type> };
    (parts $type:ty) => { $type };
    (constants $type:ty) => { Constant<$type> };
}

/// Initial value of a field.
macro_rules! initial {
    (constants [$count:expr] $type:ty = $of_index:expr) => {{
        let of_index: fn(usize) -> $type = $of_index;
        std::array::from_fn(|index| Constant::new(of_index(index)))
    }};
    ($section:ident [$count:expr] $($rest:tt)+) => {
        std::array::from_fn(|_| $crate::kernel::initial!($section $($rest)+))
    };
    (registers $type:ty) => { $crate::prim::Dff::new(<$type>::default()) };
    (registers $type:ty = $initial:expr) => { $crate::prim::Dff::new($initial) };
    (parts $type:ty = $initial:expr) => { $initial };
    (constants $type:ty = $initial:expr) => { Constant::new($initial) };
    ($section:ident $type:ty) => { Default::default() };
}

/// Wires a register; does nothing for other sections.
macro_rules! keep {
    (registers $kernel:ident $field:ident) => {
        $crate::prim::Keep::keep(&mut $kernel.$field, $kernel.clk.val(), $kernel.rst.val())
    };
    ($section:ident $kernel:ident $field:ident) => {};
}

/// Wires clock and reset of a part; does nothing for other sections.
macro_rules! clock {
    (parts $kernel:ident $field:ident) => {
        $crate::prim::Part::wire(&mut $kernel.$field, $kernel.clk.val(), $kernel.rst.val())
    };
    ($section:ident $kernel:ident $field:ident) => {};
}

/// Tells RustHDL that clock and reset of a part are wired.
macro_rules! claim {
    (parts $kernel:ident $field:ident) => {
        $crate::prim::Part::claim(&mut $kernel.$field)
    };
    ($section:ident $kernel:ident $field:ident) => {};
}

/// The reset input, for `Clocked`.
macro_rules! reset_input {
    (inputs rst) => {
        fn rst(&mut self) -> Option<&mut Signal<In, Bit>> {
            Some(&mut self.rst)
        }
    };
    ($section:ident $field:ident) => {};
}

/// Adds a part to the list of connections; does nothing for other sections.
macro_rules! list_part {
    (parts $list:ident $field:ident) => {
        $list.part(stringify!($field))
    };
    ($section:ident $list:ident $field:ident) => {};
}

/// Does `$action` for every connection of a `connect` section.
macro_rules! connections {
    ($action:ident $of:ident) => {};
    ($action:ident $of:ident $($part:ident),+: $($port:ident),+; $($lines:tt)*) => {
        $crate::kernel::connections!($action $of [$($part)+] [] [$($port),+]);
        $crate::kernel::connections!($action $of $($lines)*);
    };
    ($action:ident $of:ident $($part:ident),+ from $source:ident: $($port:ident),+; $($lines:tt)*) => {
        $crate::kernel::connections!($action $of [$($part)+] [$source] [$($port),+]);
        $crate::kernel::connections!($action $of $($lines)*);
    };
    ($action:ident $of:ident [] $source:tt $ports:tt) => {};
    ($action:ident $of:ident [$part:ident $($parts:ident)*] $source:tt [$($port:ident),+]) => {
        $($crate::kernel::connection!($action $of $part $source $port);)+
        $crate::kernel::connections!($action $of [$($parts)*] $source [$($port),+]);
    };
}

/// One connection: of an output of the kernel, or of an input of a part.
macro_rules! connection {
    (drive $kernel:ident outputs [$source:ident] $port:ident) => {
        $kernel.$port.next = $kernel.$source.$port.val()
    };
    (drive $kernel:ident $part:ident [$($source:ident)?] $port:ident) => {
        $kernel.$part.$port.next = $kernel$(.$source)?.$port.val()
    };
    (claim $kernel:ident outputs $source:tt $port:ident) => {
        $kernel.$port.connect()
    };
    (claim $kernel:ident $part:ident $source:tt $port:ident) => {
        $kernel.$part.$port.connect()
    };
    (list $list:ident outputs [$source:ident] $port:ident) => {
        $list.output(stringify!($port), concat!(stringify!($source), ".", stringify!($port)))
    };
    (list $list:ident $part:ident [$($source:ident)?] $port:ident) => {
        $list.input(
            concat!(stringify!($part), ".", stringify!($port)),
            concat!($(stringify!($source), ".",)? stringify!($port)),
        )
    };
}

/// Makes `new`, or `default` where there are no arguments.
macro_rules! constructor {
    ([$($sizes:tt)*] $kernel:ty, $seen:vis, () $body:block) => {
        impl $($sizes)* Default for $kernel {
            fn default() -> Self $body
        }
    };
    ([$($sizes:tt)*] $kernel:ty, $seen:vis, ($($arguments:tt)+) $body:block) => {
        impl $($sizes)* $kernel {
            $seen fn new($($arguments)+) -> Self $body
        }
    };
}

pub(crate) use {
    claim, clock, connection, connections, constructor, field_type, initial, keep, kernel, list_part, reset_input,
};
