//! Chains of blended moves beside the one move that leads as far: how many more scans they take.
//!
//! `cargo test -p standstill-axis --test chains -- --nocapture` prints the table of `docs/buffering.md`.

use standstill_axis::{
    Axis, AxisConfig, AxisId, AxisState, BufferMode, Command, CommandId, Direction, Dynamics, Limits, Log,
    Request, Scope, Standard, StartState, steps,
};
use std::slice;

const CYCLE: f64 = 0.001;

/// Longest chain that is followed (scans).
const LONGEST: u64 = 100_000;

/// Limits of this order (mm, s).
fn limits(order: u32) -> Limits {
    Limits {
        velocity: 50.0,
        acceleration: 200.0,
        deceleration: 200.0,
        jerk: if order >= 3 { 2000.0 } else { f64::INFINITY },
        snap: if order >= 4 { 40_000.0 } else { f64::INFINITY },
    }
}

/// An axis at rest at 0, and its clock.
struct Rig {
    axis: Axis,
    log: Log,
    scan: u64,
}

impl Rig {
    fn new(limits: Limits) -> Self {
        let config = AxisConfig {
            start: StartState::Standstill,
            ..AxisConfig::new(limits)
        };
        Self {
            axis: Axis::new(AxisId::new(0), config, Standard::new(CYCLE)).expect("a good configuration"),
            log: Log::default(),
            scan: 0,
        }
    }

    fn move_to(&mut self, position: f64, mode: BufferMode) -> CommandId {
        let request = Request {
            command: Command::MoveAbsolute {
                position,
                dynamics: Dynamics {
                    velocity: 50.0,
                    ..Dynamics::default()
                },
                direction: Direction::Unset.into(),
            },
            buffer_mode: mode.into(),
            replaces: None,
        };
        let scope = &mut Scope::new(self.scan, &mut self.log);
        self.axis.command(&request, scope).expect("a good command")
    }

    fn step(&mut self) {
        let scope = &mut Scope::new(self.scan, &mut self.log);
        steps::advance(slice::from_mut(&mut self.axis), scope);
        self.scan += 1;
    }

    /// Scans until it stands.
    fn run(mut self) -> u64 {
        while self.axis.state() != AxisState::Standstill {
            assert!(self.scan < LONGEST, "does not end");
            self.step();
        }
        self.scan
    }
}

/// Scans of `count` moves of `way`, all commanded at once.
fn chain(limits: Limits, count: u32, way: f64) -> u64 {
    let mut rig = Rig::new(limits);
    for number in 1..=count {
        rig.move_to(f64::from(number) * way, BufferMode::BlendingHigh);
    }
    rig.run()
}

#[test]
fn a_chain_beside_one_move() {
    println!("order | way (mm) | eight moves | one move | ratio");
    for order in 2..=4 {
        for way in [0.2, 0.5, 1.0] {
            let (eight, one) = (chain(limits(order), 8, way), chain(limits(order), 1, 8.0 * way));
            let ratio = eight as f64 / one as f64;
            println!("{order} | {way} | {eight} | {one} | {ratio:.3}");
            assert!(ratio < 1.8, "order {order}, {way} mm: {eight} beside {one} scans");
        }
    }
}
