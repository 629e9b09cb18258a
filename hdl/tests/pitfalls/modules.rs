//! Whole designs: names, files, sharing, headers, unread bits, composition.

use crate::pitfalls::support::{Dff, Ram16x8, emit_as, local, text_of};
use crate::pitfalls::tools;
use posicast_blocks::{Direction, Port};
use posicast_hdl::emit::{EmitCause, EmitOptions, Header, Module, ModuleInstance, Parameter, add, compose, emit};
use rust_hdl_core::prelude::*;

/// A counter that adds `STEP` per clock.
#[derive(LogicBlock)]
struct Counter<const STEP: u64> {
    clk: Signal<In, Clock>,
    rst: Signal<In, Bit>,
    count: Signal<Out, Bits<8>>,
    value: Dff<Bits<8>>,
    step: Constant<Bits<8>>,
}

impl<const STEP: u64> Default for Counter<STEP> {
    fn default() -> Self {
        Self {
            clk: Default::default(),
            rst: Default::default(),
            count: Default::default(),
            value: Dff::new(0.into()),
            step: Constant::new(STEP.into()),
        }
    }
}

impl<const STEP: u64> Logic for Counter<STEP> {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module counter_by_${value step}");
        dff_setup!(self, clk, value);
        self.value.d.next = self.value.q.val() + self.step.val();
        self.count.next = self.value.q.val();
    }
}

/// A block without a tag of its own.
#[derive(LogicBlock, Default)]
struct Inverter {
    a: Signal<In, Bits<8>>,
    y: Signal<Out, Bits<8>>,
}

impl Logic for Inverter {
    #[hdl_gen]
    fn update(&mut self) {
        self.y.next = !self.a.val();
    }
}

kernel!(Pair { rst: Bit => y: Bits<8>, high: Bits<4> } {
    first: Counter<1> = Counter::default(), second: Counter<1> = Counter::default(), by_three: Counter<3> = Counter::default(),
    invert: [Inverter; 2] = Default::default(), sum: Signal<Local, Bits<8>> = local()
} @ clk;
#[hdl_gen] fn update(&mut self) {
    self.first.clk.next = self.clk.val();
    self.first.rst.next = self.rst.val();
    self.second.clk.next = self.clk.val();
    self.second.rst.next = self.rst.val();
    self.by_three.clk.next = self.clk.val();
    self.by_three.rst.next = self.rst.val();
    self.invert[0].a.next = self.first.count.val();
    self.invert[1].a.next = self.second.count.val();
    self.sum.next = self.invert[0].y.val() + self.invert[1].y.val();
    self.high.next = self.sum.val().get_bits::<4>(4);
    self.y.next = self.by_three.count.val();
});
/// A block that adds `STEP`, which its name does not show.
#[derive(LogicBlock)]
struct Sized<const STEP: u64> {
    a: Signal<In, Bits<8>>,
    y: Signal<Out, Bits<8>>,
    step: Constant<Bits<8>>,
}

impl<const STEP: u64> Default for Sized<STEP> {
    fn default() -> Self {
        Self {
            a: Signal::default(),
            y: Signal::default(),
            step: Constant::new(STEP.into()),
        }
    }
}

impl<const STEP: u64> Logic for Sized<STEP> {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module sized");
        self.y.next = self.a.val() + self.step.val();
    }
}

kernel!(Ambiguous { a: Bits<8> => y: Bits<8> } { one: Sized<1> = Sized::default(), two: Sized<2> = Sized::default() };
#[hdl_gen] fn update(&mut self) {
    self.one.a.next = self.a.val();
    self.two.a.next = self.one.y.val();
    self.y.next = self.two.y.val();
});

/// A block whose name uses a constant that it does not have.
#[derive(LogicBlock, Default)]
struct WithoutNumber {
    a: Signal<In, Bits<8>>,
    y: Signal<Out, Bits<8>>,
}

impl Logic for WithoutNumber {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module without_${value nothing}");
        self.y.next = !self.a.val();
    }
}

kernel!(Unnumbered { a: Bits<8> => y: Bits<8> } { inner: WithoutNumber = WithoutNumber::default() };
#[hdl_gen] fn update(&mut self) {
    self.inner.a.next = self.a.val();
    self.y.next = self.inner.y.val();
});

/// A block whose name uses every kind of number.
#[derive(LogicBlock)]
struct Numbered {
    clk: Signal<In, Clock>,
    rst: Signal<In, Bit>,
    a: [Signal<In, Bits<8>>; 2],
    y: Signal<Out, Bits<8>>,
    value: Dff<Bits<8>>,
    minus: Constant<Signed<8>>,
    seven: Constant<Bits<8>>,
    zero: Constant<Bit>,
    one: Constant<Bit>,
}

impl Default for Numbered {
    fn default() -> Self {
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            a: Default::default(),
            y: Signal::default(),
            value: Dff::new(5.into()),
            minus: Constant::new((-16).into()),
            seven: Constant::new(7.into()),
            zero: Constant::new(false),
            one: Constant::new(true),
        }
    }
}

impl Logic for Numbered {
    #[hdl_gen]
    fn update(&mut self) {
        comment!(
            "@module numbers_${width y}x${words y}x${count a}_${value seven}_reset${value value}_e${log2 minus}${if zero _un}${if one _set}"
        );
        dff_setup!(self, clk, value);
        self.value.d.next = self.a[0].val() + self.a[1].val();
        self.y.next = self.value.q.val();
    }
}

kernel!(Numbers { rst: Bit, a: Bits<8> => y: Bits<8> } { inner: Numbered = Numbered::default() } @ clk;
#[hdl_gen] fn update(&mut self) {
    self.inner.clk.next = self.clk.val();
    self.inner.rst.next = self.rst.val();
    self.inner.a[0].next = self.a.val();
    self.inner.a[1].next = self.a.val();
    self.y.next = self.inner.y.val();
});

kernel!(Unread { a: Bits<8>, spare: Bit => y: Bits<3> } { r: Dff<Bits<8>> = Dff::new(0x5A.into()), ram: Ram16x8 = Ram16x8::default() } @ clk;
#[hdl_gen] fn update(&mut self) {
    self.y.next = self.a.val().get_bits::<3>(2);
});

kernel!(LongComment { a: Bits<8> => y: Bits<8> };
#[hdl_gen] fn update(&mut self) {
    comment!("The first of the counters, whose value is inverted before it is added to the other, which is inverted too");
    self.y.next = !self.a.val();
});

kernel!(Commented { rst: Bit, a: Bits<8> => y: Bits<8>, z: Bits<8> } {
    first: Counter<1> = Counter::default(), kept: Dff<Bits<8>> = Dff::new(0.into()), counted: Dff<Bits<8>> = Dff::new(0.into())
} @ clk;
#[hdl_gen] fn update(&mut self) {
    dff_setup!(self, clk, kept, counted);
    comment!("Counts; without a pause (see its own file);");
    self.first.clk.next = self.clk.val();
    self.first.rst.next = self.rst.val();
    comment!("Of the register");
    self.counted.d.next = self.first.count.val();
    comment!("Of the choice");
    if self.a.val().any() {
        self.kept.d.next = self.a.val();
    }
    self.y.next = self.kept.q.val() + self.counted.q.val();
    comment!("Of the inverse");
    self.z.next = !self.a.val();
});

fn options(top: &str, prefix: &str) -> EmitOptions {
    let parameter = |name: &str, value: &str, meaning: &str| Parameter {
        name: name.into(),
        value: value.into(),
        meaning: meaning.into(),
    };
    let header = Header {
        ports: Vec::new(),
        about: "Two counters.\nNothing else.".into(),
        parameters: vec![
            parameter("word_bits", "8", "width of a count"),
            parameter("f", "16", "none"),
        ],
    };
    EmitOptions {
        top: top.into(),
        prefix: prefix.into(),
        header,
    }
}

fn names(modules: &[Module]) -> Vec<&str> {
    modules.iter().map(|module| module.name.as_str()).collect()
}

#[test]
fn equal_modules_are_shared_and_named() {
    let modules = emit(&Pair::default(), &options("pair", "xy_stage")).unwrap();
    let expected = [
        "posicast_counter_by_1",
        "posicast_counter_by_3",
        "posicast_invert_0",
        "posicast_pair",
    ];
    assert_eq!(names(&modules), expected);
    let top = &modules[3].text;
    assert!(
        top.contains("posicast_counter_by_1 u_first (") && top.contains("posicast_counter_by_1 u_second ("),
        "{top}"
    );
    assert!(
        top.contains("posicast_counter_by_3 u_by_three (") && top.contains("posicast_invert_0 u_invert_1 ("),
        "{top}"
    );
    for module in &modules {
        assert!(module.text.contains(&format!("\nmodule {} (", module.name)));
        assert!(!module.text.contains('$'), "{}", module.text);
    }
    let folder = tempfile::tempdir().unwrap();
    tools::write(folder.path(), &modules);
    tools::lint(folder.path(), "posicast_pair");
}

/// A name identifies one content: a difference that the name does not show is refused.
#[test]
fn different_modules_of_one_name_are_refused() {
    let error = emit(&Ambiguous::default(), &options("ambiguous", "")).unwrap_err();
    assert_eq!(*error.cause, EmitCause::OtherContent("sized".to_owned()));
    let error = emit(&Unnumbered::default(), &options("unnumbered", "")).unwrap_err();
    assert!(
        matches!(&*error.cause, EmitCause::Leaf(text) if text.contains("value nothing")),
        "{error}"
    );
}

#[test]
fn numbers_of_a_name_come_from_its_signals() {
    let modules = emit(&Numbers::default(), &options("top", "")).unwrap();
    assert_eq!(names(&modules), ["numbers_8x256x2_7_reset5_e4_set", "top"]);
}

#[test]
fn a_package_takes_each_module_once() {
    let pair = emit(&Pair::default(), &options("pair", "xy_stage")).unwrap();
    let mut package = Vec::new();
    add(&mut package, pair.clone()).unwrap();
    add(&mut package, pair.clone()).unwrap();
    assert_eq!(package, pair);
    let mut other = pair[0].clone();
    other.text.push('\n');
    let error = add(&mut package, vec![other]).unwrap_err();
    assert_eq!(
        *error.cause,
        EmitCause::OtherContent("posicast_counter_by_1".to_owned())
    );
}

#[test]
fn output_is_the_same_each_time() {
    let emitted = || emit(&Pair::default(), &options("pair", "xy_stage")).unwrap();
    let first = emitted();
    assert!((0..5).all(|_| emitted() == first));
}

#[test]
fn header_says_version_purpose_and_parameters() {
    let modules = emit(&Pair::default(), &options("pair", "xy_stage")).unwrap();
    let version = env!("CARGO_PKG_VERSION");
    let expected = format!(
        "// posicast_pair
// Two counters.
// Nothing else.
//
// Generated by posicast {version} from its RustHDL description; do not edit.
//
// parameter  value  meaning
// word_bits  8      width of a count
// f          16     none

`default_nettype none

module posicast_pair ("
    );
    assert!(modules[3].text.starts_with(&expected), "{}", modules[3].text);
    assert!(
        modules[0]
            .text
            .starts_with("// posicast_counter_by_1\n//\n// Generated by posicast")
    );
    assert!(
        modules
            .iter()
            .all(|module| module.text.ends_with("endmodule\n\n`default_nettype wire\n"))
    );
}

/// A comment stands above the statement that follows it, whichever construct that becomes, and nowhere else.
#[test]
fn a_comment_stands_once_above_its_statement() {
    let text = emit_as::<Commented>("of").unwrap().pop().unwrap().text;
    for (comment, statement) in [
        (
            "Counts; without a pause (see its own file);",
            "of_counter_by_1 u_first (",
        ),
        ("Of the register", "counted <= first_count;"),
        ("Of the choice", "if ((|a)) begin"),
        ("Of the inverse", "assign z = ~a;"),
    ] {
        let lines: Vec<&str> = text.lines().map(str::trim).collect();
        let places: Vec<usize> = (0..lines.len())
            .filter(|at| lines[*at] == format!("// {comment}"))
            .collect();
        assert_eq!(places.len(), 1, "{comment}: {text}");
        assert_eq!(lines[places[0] + 1], statement, "{text}");
    }
}

/// RustHDL wraps the text of long comments, on which its own generator then fails.
#[test]
fn long_comments_are_wrapped_between_words() {
    let text = text_of::<LongComment>();
    let comment = "    // The first of the counters, whose value is inverted before it is added to the other, which is\n    \
                   // inverted too\n";
    assert!(text.contains(comment), "{text}");
}

#[test]
fn ports_are_told_without_the_clock() {
    let top = emit_as::<Pair>("x").unwrap().pop().unwrap();
    let port = |name: &str, direction, width| Port {
        name: name.into(),
        direction,
        width,
        signed: false,
    };
    let expected = [
        port("rst", Direction::Input, 1),
        port("y", Direction::Output, 8),
        port("high", Direction::Output, 4),
    ];
    assert_eq!(top.ports, expected);
    assert!(top.clocked);
}

/// A register that is never read is an error; an unread input or bit is listed in `unused`, so that lint tools do not
/// report it.
#[test]
fn unread_bits_are_named() {
    let text = text_of::<Pair>();
    assert!(text.contains("wire unused = &{1'b0, sum[3:0]};"), "{text}");
    assert_eq!(emit_as::<Unread>("x").unwrap_err().signal, "r");
}

#[test]
fn compose_shares_inputs_and_lifts_the_rest() {
    let module = emit_as::<Pair>("part").unwrap();
    let part = module.last().unwrap();
    let header = Header {
        ports: Vec::new(),
        about: "Both axes.".into(),
        parameters: Vec::new(),
    };
    let instances = [
        ModuleInstance {
            name: "x",
            module: part,
        },
        ModuleInstance {
            name: "y",
            module: part,
        },
    ];
    let top = compose("xy_stage", &header, &["clk", "rst"], &instances).unwrap();
    let ports: Vec<_> = top.ports.iter().map(|port| port.name.as_str()).collect();
    assert_eq!(ports, ["rst", "x_y", "x_high", "y_y", "y_high"]);
    assert!(
        top.text
            .contains("    part_dut u_y (\n        .clk  (clk),\n        .rst  (rst),\n        .y    (y_y),\n"),
        "{}",
        top.text
    );
    let folder = tempfile::tempdir().unwrap();
    tools::write(folder.path(), &module);
    tools::write(folder.path(), std::slice::from_ref(&top));
    tools::lint(folder.path(), "xy_stage");
}

#[test]
fn compose_refuses_what_does_not_fit() {
    let port = |name: &str, direction, width| Port {
        name: name.into(),
        direction,
        width,
        signed: false,
    };
    let module = |ports: Vec<Port>| Module {
        name: "part".into(),
        text: String::new(),
        ports,
        clocked: true,
        notes: Vec::new(),
    };
    let wide = module(vec![port("rst", Direction::Input, 2), port("b", Direction::Output, 1)]);
    let narrow = module(vec![
        port("rst", Direction::Input, 1),
        port("y_b", Direction::Output, 1),
    ]);
    let refused = |top: &str, shared: &[&str], instances: &[(&str, &Module)]| {
        let instances: Vec<_> = instances
            .iter()
            .map(|&(name, module)| ModuleInstance { name, module })
            .collect();
        *compose(top, &Header::default(), shared, &instances).unwrap_err().cause
    };
    let both = [("x", &wide), ("y", &narrow)];
    assert!(matches!(refused("top", &["rst"], &both), EmitCause::SharedType { .. }));
    assert_eq!(
        refused("top", &["strobe"], &both),
        EmitCause::NoSuchInput("strobe".into())
    );
    assert_eq!(refused("top", &["b"], &both), EmitCause::SharedOutput("b".into()));
    assert_eq!(refused("end", &[], &both), EmitCause::ReservedWord("end".into()));
    assert_eq!(refused("top", &[], &[("X", &wide)]), EmitCause::BadName("X".into()));
    assert!(matches!(refused("part", &[], &both), EmitCause::NameCollision { .. }));
    assert!(matches!(
        refused("top", &[], &[("x", &wide), ("x", &wide)]),
        EmitCause::NameCollision { .. }
    ));
    // `x_y` with the port `b` and `x` with the port `y_b` would both become `x_y_b`.
    assert!(matches!(
        refused("top", &[], &[("x_y", &wide), ("x", &narrow)]),
        EmitCause::NameCollision { .. }
    ));
}
