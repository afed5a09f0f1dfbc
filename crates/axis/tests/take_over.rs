//! Commands that take over from random motions, with their own limits: the guarantees of the axis for all
//! of them.
//!
//! Set-points are checked against the limits of the axis by the rules of `standstill-soak`. 10^4
//! take-overs of each kind by default; `STANDSTILL_TAKE_OVERS=1000000` in the environment tries a
//! million. The numbers are seeded and a failing case prints its own.

use crate::standing;
use standstill_axis::{
    Axis, AxisState, BufferMode, Command, CommandId, Direction, Dynamics, Event, Fate, Limits, Log, Plan,
    Request, Scope, Setpoint,
};
use standstill_soak::Random;
use standstill_soak::rules::limits::{Track, check_excess};
use standstill_testkit::given;

const CYCLE: f64 = 0.001;

/// Longest motion that is followed to its end (scans).
const LONGEST: u64 = 100_000;

/// Limits of order 2, 3 or 4 whose parts all take a few scans.
fn limits(random: &mut Random) -> Limits {
    let order = random.below(4);
    let velocity = random.log_between(0.5, 200.0);
    let times = [(); 3].map(|()| CYCLE * random.log_between(2.0, 60.0));
    let acceleration = velocity / times[0];
    let jerk = acceleration / times[1];
    Limits {
        velocity,
        acceleration,
        deceleration: if random.one_in(2) {
            acceleration
        } else {
            acceleration * random.between(0.3, 3.0)
        },
        jerk: if order >= 1 { jerk } else { f64::INFINITY },
        snap: if order >= 2 {
            jerk / times[2]
        } else {
            f64::INFINITY
        },
    }
}

/// An axis in motion, its records, and the checks of its set-points.
struct Rig {
    axis: Axis,
    log: Log,
    scan: u64,
    records: u64,
    track: Track,
    limits: Limits,
    /// The number of the case.
    number: u64,
    /// Stops recorded to turn back since the last command.
    turns_back: bool,
}

impl Rig {
    fn new(limits: Limits) -> Self {
        let axis = standing::axis(limits, CYCLE);
        Self {
            track: Track::new(&axis, CYCLE),
            axis,
            log: Log::default(),
            scan: 0,
            records: 0,
            limits,
            number: 0,
            turns_back: false,
        }
    }

    fn command(&mut self, command: Command) -> CommandId {
        self.turns_back = false;
        let request = Request {
            command,
            buffer_mode: BufferMode::Aborting.into(),
            replaces: None,
        };
        self.axis
            .command(&request, &mut Scope::new(self.scan, &mut self.log))
            .unwrap_or_else(|error| panic!("refused: {error:?} {command:?} {:?}", self.axis.setpoint()))
    }

    fn scan(&mut self) -> Setpoint {
        self.axis.step_alone(&mut Scope::new(self.scan, &mut self.log));
        self.scan += 1;
        for record in self.log.since(self.records) {
            match (record.event, self.axis.plan()) {
                (Event::Unavoidable(excess), _) => {
                    self.turns_back = true;
                    check_excess(&excess, &self.limits).expect("a stop that turns back, and nothing else");
                }
                (Event::Planned { .. }, Some((plan, _))) => {
                    let end = plan.end();
                    self.track.leads(plan.at(0).position, end.position, plan.scans());
                }
                _ => {}
            }
        }
        self.records = self.log.total();
        let setpoint = self.axis.setpoint();
        if let Err(broken) = self.track.check(&setpoint) {
            panic!("case {}: {broken:?}: {setpoint:?} {:?}", self.number, self.limits);
        }
        assert_ne!(self.axis.state(), AxisState::ErrorStop);
        setpoint
    }

    /// Dynamic values of a command, each between a twentieth of the axis limit and all of it.
    fn dynamics(&self, random: &mut Random) -> Dynamics {
        let mut part = |limit: f64| {
            if limit.is_finite() && !random.one_in(4) {
                limit * random.log_between(0.05, 1.0)
            } else {
                0.0
            }
        };
        let [acceleration, deceleration, jerk, snap] = [
            self.limits.acceleration,
            self.limits.deceleration,
            self.limits.jerk,
            self.limits.snap,
        ]
        .map(&mut part);
        Dynamics {
            velocity: self.limits.velocity * random.between(0.05, 1.0),
            acceleration,
            deceleration,
            jerk,
            snap,
        }
    }

    /// A position some scans away.
    fn place(&self, random: &mut Random) -> f64 {
        let way = self.limits.velocity * CYCLE * random.log_between(0.5, 300.0);
        self.axis.setpoint().position + random.signed(way)
    }

    /// A motion with limits of its own, followed for some of its scans.
    fn disturb(&mut self, random: &mut Random) {
        let dynamics = self.dynamics(random);
        if random.one_in(2) {
            self.endless(dynamics, random);
        } else {
            let position = self.place(random);
            self.command(Command::MoveAbsolute {
                position,
                direction: Direction::Unset.into(),
                dynamics,
            });
        }
        for _ in 0..random.log_between(1.0, 120.0) as u64 {
            self.scan();
        }
    }

    fn endless(&mut self, dynamics: Dynamics, random: &mut Random) -> (CommandId, f64) {
        let velocity = random.signed(dynamics.velocity);
        let id = self.command(Command::MoveVelocity {
            dynamics: Dynamics { velocity, ..dynamics },
            direction: Direction::Unset.into(),
        });
        (id, velocity)
    }
}

/// Streams and numbers of cases that failed before.
const HARD: [(u64, u64); 1] = [
    // A root that leaves 4e-10 of the distance: spread evenly over the plan it is a step in the velocity.
    (2, 58_423),
];

/// Calls `one` with rigs in random motion, each for a few take-overs.
fn for_each(stream: u64, mut one: impl FnMut(&mut Rig, &mut Random)) {
    let mut left = given("STANDSTILL_TAKE_OVERS", 10_000_u64);
    let hard = HARD
        .iter()
        .filter(|(of, _)| *of == stream)
        .map(|(_, number)| *number);
    let mut numbers = hard.chain(0..);
    while left > 0 {
        let number = numbers.next().expect("they go on");
        let mut random = Random::new(stream, number);
        let limits = limits(&mut random);
        let mut rig = Rig::new(limits);
        rig.number = number;
        for _ in 0..left.min(10) {
            rig.disturb(&mut random);
            one(&mut rig, &mut random);
            left -= 1;
        }
    }
}

/// MC_Stop and MC_Halt come to rest without turning back; from the middle of a reversal they turn once.
///
/// Covers: S1
#[test]
fn stops_keep_their_direction_and_every_limit() {
    let (mut straight, mut turned) = (0_u64, 0_u64);
    for_each(1, |rig, random| {
        let start = rig.axis.setpoint();
        let dynamics = rig.dynamics(random);
        let stop = random.one_in(2);
        let id = rig.command(if stop {
            Command::Stop { dynamics }
        } else {
            Command::Halt { dynamics }
        });
        let heading = start.velocity.signum();
        let (mut turns, mut side) = (0, heading);
        let mut scans = 0;
        loop {
            let setpoint = rig.scan();
            if setpoint.velocity * side < -1e-9 * rig.limits.velocity {
                (turns, side) = (turns + 1, -side);
            }
            if setpoint.is_at_rest() {
                break;
            }
            scans += 1;
            assert!(scans < LONGEST, "{start:?} {dynamics:?} {:?}", rig.limits);
        }
        if rig.turns_back || start.velocity.abs() <= 1e-9 * rig.limits.velocity {
            assert!(turns <= 1, "{turns} {start:?} {dynamics:?} {:?}", rig.limits);
            turned += 1;
        } else {
            assert!(turns == 0, "{start:?} {dynamics:?} {:?}", rig.limits);
            straight += 1;
        }
        if stop {
            rig.axis.release_stop(id);
        }
        rig.scan();
        assert_eq!(rig.axis.fate(id), Fate::Done);
        assert_eq!(rig.axis.state(), AxisState::Standstill);
    });
    println!("{straight} without turning, {turned} from rest or from the middle of a reversal");
    assert!(straight > 10 * turned);
}

/// For any motion in progress, a move with its own limits is accepted and ends exactly at its target.
///
/// Covers: B6, R25
#[test]
fn every_move_is_taken_and_lands_exactly() {
    let mut raised = 0_u64;
    for_each(2, |rig, random| {
        let start = rig.axis.setpoint();
        let (position, dynamics) = (rig.place(random), rig.dynamics(random));
        let records = rig.log.total();
        let id = rig.command(Command::MoveAbsolute {
            position,
            direction: Direction::Unset.into(),
            dynamics,
        });
        raised += u64::from(
            rig.log
                .since(records)
                .any(|record| matches!(record.event, Event::Raised { .. })),
        );
        let mut scans = 0;
        while rig.axis.fate(id) != Fate::Done {
            rig.scan();
            scans += 1;
            assert!(scans < LONGEST, "{start:?} {dynamics:?} {:?}", rig.limits);
        }
        // The highest derivative is the one in force just before.
        let end = rig.axis.setpoint();
        assert_eq!((end.position, end.velocity), (position, 0.0));
        assert_eq!(rig.axis.state(), AxisState::Standstill);
        assert!(!rig.turns_back, "{start:?} {dynamics:?} {:?}", rig.limits);
    });
    println!("{raised} with more jerk or snap than asked for");
    assert!(raised > 0);
}

/// MC_MoveVelocity reaches its velocity within every limit.
///
/// Covers: R39
#[test]
fn endless_motions_keep_every_limit() {
    for_each(3, |rig, random| {
        let start = rig.axis.setpoint();
        let dynamics = rig.dynamics(random);
        let (id, velocity) = rig.endless(dynamics, random);
        let mut scans = 0;
        while rig.axis.fate(id) != (Fate::Active { reached: true }) {
            rig.scan();
            scans += 1;
            assert!(scans < LONGEST, "{start:?} {dynamics:?} {:?}", rig.limits);
        }
        let setpoint = rig.axis.setpoint();
        assert_eq!((setpoint.velocity, setpoint.acceleration), (velocity, 0.0));
        for _ in 0..3 {
            rig.scan();
        }
        assert!(!rig.turns_back, "{start:?} {dynamics:?} {:?}", rig.limits);
    });
}
