//! A gear of 3/7 through executor, axes and drives. Every position of the slave is compared with integers in
//! every scan.
//!
//! Both axes have turns of 360, and the master makes 1.8 a scan. 10^6 scans in a plain run, more with
//! `STANDSTILL_SOAK=100000000`.

use standstill_axis::{
    AxisConfig, AxisId, Command, Direction, DrivePosition, Dynamics, Followed, IdealDrive, Limits, Master,
    Raw, Request, Standard, StartState, ValueSource, couple,
};
use standstill_fb::Context;
use standstill_scan::{Executor, Machine, ProgramConfig, ProgramFault, ProgramId, Programs};

const MASTER: AxisId = AxisId::new(0);
const SLAVE: AxisId = AxisId::new(1);
const LIMITS: Limits = Limits {
    velocity: 3600.0,
    acceleration: 36_000.0,
    deceleration: 36_000.0,
    jerk: 720_000.0,
    snap: 36e6,
};
const CYCLE: f64 = 0.001;
const TURN: u128 = 360;
const NUMERATOR: u128 = 3;
const DENOMINATOR: u128 = 7;
/// All positions here are whole numbers of 2^-80.
const BITS: u32 = 80;

/// In the first call the slave is coupled and the master starts.
struct Program {
    is_new: bool,
}

impl Programs<Standard, IdealDrive> for Program {
    fn run(&mut self, _: ProgramId, context: &mut Context<'_>) -> Result<u64, ProgramFault> {
        if !std::mem::take(&mut self.is_new) {
            return Ok(0);
        }
        let gear = Command::GearIn {
            followed: Followed {
                master: Master {
                    axis: MASTER,
                    turn: Some(TURN as f64),
                },
                numerator: 3,
                denominator: 7,
                source: Raw::from(ValueSource::Set),
            },
            sync: None,
            dynamics: Dynamics::default(),
        };
        let coupled = couple(context.axes, SLAVE, &Request::aborting(gear), &mut context.scope);
        assert!(coupled.is_ok(), "{coupled:?}");
        let run = Command::MoveVelocity {
            dynamics: Dynamics::at(1800.0),
            direction: Direction::Unset.into(),
        };
        let moves = context.axes[MASTER.index()].command(&Request::aborting(run), &mut context.scope);
        assert!(moves.is_ok(), "{moves:?}");
        Ok(0)
    }
}

/// A position in the first turn as a whole number of 2^-80.
fn units(position: f64) -> u128 {
    let bits = position.to_bits();
    if bits == 0 {
        return 0;
    }
    let power = (bits >> 52) as u32 + BITS - 1075;
    let significand = u128::from((bits & ((1 << 52) - 1)) | 1 << 52);
    assert!(
        power < 128,
        "{position:e} is outside the first turn or finer than 2^-80"
    );
    significand << power
}

/// `up` / `down` units rounded once, to the nearest number and of two to the even one.
fn rounded(up: u128, down: u128) -> f64 {
    if up == 0 {
        return 0.0;
    }
    let shift = up.leading_zeros();
    let (quotient, rest) = ((up << shift) / down, (up << shift) % down);
    let unit = 1.0 / (1_u128 << BITS) as f64;
    (quotient | u128::from(rest > 0)) as f64 / (1_u128 << shift) as f64 * unit
}

/// Covers: G1, G11, G31
#[test]
fn every_scan_of_the_runtime_at_three_sevenths_is_the_exact_place_rounded_once() {
    let usual = standstill_testkit::whole_or(1_000_000_i64, 200_000);
    let scans = standstill_testkit::given("STANDSTILL_SOAK", usual);
    let mut machine = Machine::new();
    for _ in [MASTER, SLAVE] {
        let config = AxisConfig {
            start: StartState::Standstill,
            modulo: Some(TURN as f64),
            ..AxisConfig::new(LIMITS)
        };
        let drive = IdealDrive::new(DrivePosition::Units(0.0), 0, Some(0), true);
        machine
            .add_axis(config, Standard::new(CYCLE), drive)
            .expect("valid");
    }
    let mut executor = Executor::new(1_000_000, &[], &[ProgramConfig::free("main")]).expect("valid");
    let mut program = Program { is_new: true };
    let turn = TURN << BITS;
    let (mut turns, mut was) = (0_u128, 0);
    // The scan, turns and position at which the master first had its velocity.
    let mut cruise = None;
    let mut farthest = 0;
    for scan in 0..scans {
        let done = executor.scan(scan * 1_000_000, &mut program, &mut machine);
        assert!(done.is_ok());
        let [master, slave] = machine.axes() else {
            panic!("two axes")
        };
        assert!(slave.is_in_gear(), "scan {scan}");
        let now = units(master.setpoint().position);
        turns += u128::from(now < was);
        was = now;
        // The law goes through 0 and 0. 7 turns of the master add 3 whole turns.
        let place = NUMERATOR * (turns % DENOMINATOR * turn + now) % (DENOMINATOR * turn);
        let exact = rounded(place, DENOMINATOR);
        let exact = if exact == TURN as f64 { 0.0 } else { exact };
        let found = slave.setpoint().position;
        assert_eq!(
            found.to_bits(),
            exact.to_bits(),
            "scan {scan}: {found:?}, exact {exact:?}"
        );
        // The master itself moves 1800 times the cycle in a scan; a cycle is the f64 next to 1 ms.
        if master.setpoint().velocity != 1800.0 {
            continue;
        }
        let here = turns * turn + now;
        let (since, from) = *cruise.get_or_insert((scan, here));
        let expected = (scan - since) as u128 * 1800 * units(CYCLE);
        farthest = farthest.max((here - from).abs_diff(expected));
    }
    // Two units in the last place of a position below two turns.
    assert!(farthest <= 2 << (BITS - 43), "{farthest} of 2^-80");
    println!(
        "{scans} scans, {turns} turns, the master within {:e}",
        farthest as f64 / (1_u128 << BITS) as f64
    );
}
