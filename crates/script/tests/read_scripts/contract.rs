//! The example of the script format, read and compared value by value.

use standstill_axis::{AxisState, Limits, StartState};
use standstill_fb::Value;
use standstill_script::model::{Action, ClaimKind, Comparison, DriveSetup, Point, Signal, Test, When, Wire};
use standstill_script::read;

const EXAMPLE: &str = include_str!("contract_example.scan.json");

#[test]
fn every_value_of_the_example_arrives_in_the_model() {
    let script = read(EXAMPLE, "example.scan.json", &[]).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(script.title, "A second MC_MoveAbsolute aborts the first");
    assert_eq!(script.covers, ["T8", "R69", "B6"]);
    assert_eq!((script.cycle_ns, script.scans), (1_000_000, 1600));

    let [axis] = &script.axes[..] else {
        panic!("one axis")
    };
    assert_eq!((axis.name.as_str(), axis.unit.as_str()), ("X", "mm"));
    let limits = Limits {
        velocity: 50.0,
        acceleration: 200.0,
        deceleration: 200.0,
        jerk: 2000.0,
        snap: 40000.0,
    };
    assert_eq!(axis.config.limits, limits);
    assert_eq!(axis.config.start, StartState::Standstill);
    assert_eq!(axis.drive, DriveSetup::default());

    let names: Vec<_> = script
        .inputs
        .iter()
        .map(|input| (input.name.as_str(), input.initial))
        .collect();
    assert_eq!(names, [("GO", Value::Bool(false)), ("Test", Value::Bool(false))]);

    let [first, second] = &script.blocks[..] else {
        panic!("two blocks")
    };
    let pin = |name| first.block.pin(name).unwrap().0;
    assert_eq!(first.block.name, "MC_MoveAbsolute");
    assert_eq!(first.wires, [(pin("Execute"), Wire::From(Point::Input(0)))]);
    assert_eq!(
        first.constants[1..],
        [
            (pin("Position"), Value::Lreal(100.0)),
            (pin("Velocity"), Value::Lreal(50.0))
        ]
    );
    let any = Wire::Any(vec![Point::Pin(0, pin("Done")), Point::Input(1)]);
    assert_eq!(second.wires, [(pin("Execute"), any)]);
    assert_eq!(script.tasks.len(), 1);
    assert_eq!(
        (script.tasks[0].name.as_str(), script.tasks[0].interval),
        ("main", Some(1))
    );

    let [one, two, three] = &script.steps[..] else {
        panic!("three steps")
    };
    assert!(matches!(one.when, When::At(1)));
    assert_eq!(one.actions, [Action::Set(Point::Input(0), Value::Bool(true))]);
    assert!(matches!(two.when, When::At(501)));
    let When::Holds {
        conditions,
        after: 5,
        every: false,
    } = &three.when
    else {
        panic!("{three:?}")
    };
    assert_eq!(conditions[0].signal, Signal::Point(Point::Pin(1, pin("Done"))));
    assert_eq!(three.actions.len(), 2);

    let kinds: Vec<_> = script.claims.iter().map(|claim| &claim.kind).collect();
    assert_eq!(script.claims[4].path, "expect[4]");
    let range = |claim: usize| (script.claims[claim].range.from, script.claims[claim].range.to);
    assert!(matches!(kinds[0], ClaimKind::At(that) if that.len() == 3));
    assert_eq!(range(0), (502, Some(502)));
    let ClaimKind::By(that) = kinds[1] else {
        panic!("{:?}", kinds[1])
    };
    assert_eq!((range(1), &that[1].test), ((0, Some(1590)), &Test::Exactly(20.0)));
    assert!(matches!(kinds[2], ClaimKind::Never(_)) && range(2) == (0, None));
    assert!(matches!(kinds[3], ClaimKind::Always(that)
        if that[1].signal == Signal::Difference(0, 3)
        && that[1].test == Test::Compare(vec![Comparison::AbsLe(2000.1)])));
    assert!(matches!(kinds[4], ClaimKind::Always(that)
        if that[0].test == Test::State(AxisState::DiscreteMotion)));
    assert_eq!(range(4), (600, Some(700)));
    let span = that[1].span;
    assert_eq!(&EXAMPLE[span.start..span.end], "\"X.Position\": 20");
}

#[test]
fn a_byte_order_mark_and_crlf_make_no_difference_but_in_the_hash() {
    let plain = read(EXAMPLE, "example.scan.json", &[]).unwrap();
    let windows = format!("\u{feff}{}", EXAMPLE.replace('\n', "\r\n"));
    let read = read(&windows, "example.scan.json", &[]).unwrap();
    assert_eq!(read.steps.len(), plain.steps.len());
    assert_eq!(read.title, plain.title);
    assert_ne!(read.hash, plain.hash);
}
