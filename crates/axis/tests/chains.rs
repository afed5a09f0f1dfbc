//! Chains of blended moves in the same direction within the same limits: one motion (B2, B14, B15).
//!
//! The rules: no chain takes more scans than the one move over the same distance, and at most one less. Each end is
//! handed over in the scan that passes it, with the velocity that all ask for if the one move has that velocity
//! there. No limit of the axis is exceeded, for any command, change or withdrawal at any time. Nothing is later than
//! with buffered moves. Set-points are checked independently, by their backward differences. The numbers are seeded;
//! a failing case prints its own.
//!
//! `cargo test -p standstill-tests --test axis chains:: -- --nocapture` prints the tables of `docs/buffering.md`.

use crate::differences::Watch;
use standstill_axis::{
    Axis, AxisConfig, AxisId, AxisState, BufferMode, Command, CommandId, Direction, Dynamics, ErrorId,
    Factors, Fate, Limits, Log, QUEUE_MAX, Request, Scope, Standard, StartState,
};
use standstill_testkit::{Random, cases};

pub const CYCLE: f64 = 0.001;

/// Longest chain that is followed (scans).
pub const LONGEST: u64 = 200_000;

pub const BLENDING: [BufferMode; 4] = [
    BufferMode::BlendingLow,
    BufferMode::BlendingPrevious,
    BufferMode::BlendingNext,
    BufferMode::BlendingHigh,
];

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

/// Limits of order 2, 3 or 4 that each take a few scans to reach. In half of the cases acceleration and deceleration
/// differ.
pub fn drawn_limits(random: &mut Random) -> Limits {
    let order = 2 + random.below(3);
    let velocity = random.between(1.0, 100.0);
    let times = [(); 3].map(|()| CYCLE * random.between(2.0, 60.0));
    let acceleration = velocity / times[0];
    let jerk = acceleration / times[1];
    let apart = if random.below(2) == 0 {
        1.0
    } else {
        random.between(0.3, 3.0)
    };
    Limits {
        velocity,
        acceleration,
        deceleration: acceleration * apart,
        jerk: if order >= 3 { jerk } else { f64::INFINITY },
        snap: if order >= 4 {
            jerk / times[2]
        } else {
            f64::INFINITY
        },
    }
}

/// An axis that began at rest at 0, its clock and its moves.
pub struct Rig {
    pub axis: Axis,
    pub log: Log,
    pub scan: u64,
    pub watch: Watch,
    /// For each move its number, its target, and the scan in which it was done.
    pub moves: Vec<(CommandId, f64, Option<u64>)>,
    /// The velocity of the last set-point of each move.
    pub speeds: Vec<f64>,
    /// Moves on a modulo axis, with their ends in the first turn.
    pub turning: Vec<(CommandId, f64)>,
}

impl Rig {
    pub fn new(limits: Limits) -> Self {
        Self::of(AxisConfig::new(limits))
    }

    pub fn of(config: AxisConfig) -> Self {
        let config = AxisConfig {
            start: StartState::Standstill,
            queue: QUEUE_MAX,
            ..config
        };
        Self {
            axis: Axis::new(AxisId::new(0), config, Standard::new(CYCLE)).expect("a good configuration"),
            log: Log::default(),
            scan: 0,
            watch: Watch::new(CYCLE, config.limits),
            moves: Vec::new(),
            speeds: Vec::new(),
            turning: Vec::new(),
        }
    }

    pub fn command(&mut self, command: Command, mode: BufferMode) -> CommandId {
        let request = Request {
            command,
            buffer_mode: mode.into(),
            replaces: None,
        };
        let before = self.axis.setpoint();
        let scope = &mut Scope::new(self.scan, &mut self.log);
        let id = self.axis.command(&request, scope).expect("a good command");
        assert_eq!(
            before,
            self.axis.setpoint(),
            "a set-point already published changed"
        );
        id
    }

    /// A move within the limits of the axis.
    pub fn move_to(&mut self, position: f64, mode: BufferMode) -> CommandId {
        self.move_with(position, mode, Dynamics::default())
    }

    pub fn move_with(&mut self, position: f64, mode: BufferMode, dynamics: Dynamics) -> CommandId {
        let velocity = if dynamics.velocity == 0.0 {
            self.axis.config().limits.velocity
        } else {
            dynamics.velocity
        };
        let command = Command::MoveAbsolute {
            position,
            dynamics: Dynamics { velocity, ..dynamics },
            direction: Direction::Unset.into(),
        };
        let id = self.command(command, mode);
        self.moves.push((id, position, None));
        id
    }

    /// One scan within the limits of the axis; returns the position after it.
    pub fn advance(&mut self) -> f64 {
        let scope = &mut Scope::new(self.scan, &mut self.log);
        self.axis.step_alone(scope);
        self.scan += 1;
        let position = self.axis.setpoint().position;
        self.watch.see(position).unwrap();
        position
    }

    /// The same, with a check that each end is handed over in the scan that passes it.
    pub fn step(&mut self) {
        let before = self.axis.setpoint().position;
        self.advance();
        let point = self.axis.setpoint();
        let scan = self.scan;
        let mut from = 0.0;
        for (id, end, done) in &mut self.moves {
            if done.is_none() && self.axis.fate(*id) == Fate::Done {
                *done = Some(scan);
                self.speeds.push(point.velocity.abs());
                let small = 1e-10 * self.watch.largest;
                let passed = |at: f64| (at - *end) * (*end - from).signum();
                assert!(
                    passed(point.position) >= -small,
                    "scan {scan}: {end} is not passed at {}",
                    point.position
                );
                assert!(
                    passed(before) < small,
                    "scan {scan}: {end} was passed before, at {before}"
                );
            }
            from = *end;
        }
    }

    /// Sets the velocity factor of the override to `velocity`.
    pub fn set_override(&mut self, velocity: f64) {
        let factors = Factors {
            velocity,
            ..Factors::ONE
        };
        let scope = &mut Scope::new(self.scan, &mut self.log);
        self.axis.set_override(factors, scope).expect("good factors");
    }

    /// Scans until the axis is at rest.
    pub fn run(&mut self) -> u64 {
        while self.axis.state() != AxisState::Standstill {
            assert!(self.scan < LONGEST, "does not end");
            self.step();
        }
        let last = self.moves.last().expect("a move");
        assert_eq!(self.axis.setpoint().position, last.1, "rests elsewhere");
        assert!(
            self.moves.iter().all(|(_, _, done)| done.is_some()),
            "not all are done"
        );
        self.scan
    }
}

/// Scans of moves to these positions, all commanded at once.
fn chain(limits: Limits, ends: &[f64], mode: BufferMode) -> u64 {
    let mut rig = Rig::new(limits);
    for end in ends {
        rig.move_to(*end, mode);
    }
    rig.run()
}

/// Covers: B2, B14
#[test]
fn a_chain_takes_the_scans_of_one_move() {
    println!("order | way (mm) | eight moves | one move");
    for order in 2..=4 {
        for way in [0.2, 0.5, 1.0] {
            let ends: Vec<f64> = (1..=8).map(|number| f64::from(number) * way).collect();
            let one = chain(limits(order), &ends[7..], BufferMode::Aborting);
            for mode in BLENDING {
                let eight = chain(limits(order), &ends, mode);
                println!("{order} | {way} | {eight} | {one}");
                assert!(
                    eight.abs_diff(one) <= 1,
                    "order {order}, {way} mm: {eight} beside {one} scans"
                );
            }
        }
    }
}

/// Distances of some scans up to some hundred, all forwards or all back.
fn drawn_ends(random: &mut Random, limits: &Limits) -> Vec<f64> {
    let scan = limits.velocity * CYCLE;
    let side = if random.below(2) == 0 { 1.0 } else { -1.0 };
    let mut end = 0.0;
    (0..2 + random.below(7))
        .map(|_| {
            let scans = match random.below(3) {
                0 => random.between(1.1, 5.0),
                1 => random.between(5.0, 40.0),
                _ => random.between(40.0, 300.0),
            };
            end += side * scans * scan;
            end
        })
        .collect()
}

/// Covers: B2, B14
#[test]
fn random_chains_take_the_scans_of_one_move() {
    for seed in 0..cases(2_000) {
        let mut random = Random(seed);
        let limits = drawn_limits(&mut random);
        let ends = drawn_ends(&mut random, &limits);
        let last = ends.len() - 1;
        let one = chain(limits, &ends[last..], BufferMode::Aborting);
        let mode = BLENDING[random.below(4) as usize];
        let all = chain(limits, &ends, mode);
        assert!(all <= one + 1, "seed {seed}: {all} beside {one} scans");
    }
}

/// The distance of the axis until it has its full velocity, and from there to rest.
fn ways_of_ramps(limits: Limits) -> (f64, f64) {
    let mut rig = Rig::new(limits);
    let dynamics = Dynamics::at(limits.velocity);
    let direction = Direction::Positive.into();
    let id = rig.command(
        Command::MoveVelocity { dynamics, direction },
        BufferMode::Aborting,
    );
    while rig.axis.fate(id) != (Fate::Active { reached: true }) {
        rig.step();
    }
    let up = rig.axis.setpoint().position;
    rig.command(
        Command::Halt {
            dynamics: Dynamics::default(),
        },
        BufferMode::Aborting,
    );
    while rig.axis.state() != AxisState::Standstill {
        rig.step();
    }
    (up, rig.axis.setpoint().position - up)
}

/// Covers: B2
#[test]
fn ends_are_passed_at_full_speed_where_there_is_room_for_it() {
    let mut at_full_speed = 0;
    for seed in 0..cases(1_000) {
        let mut random = Random(seed);
        let limits = drawn_limits(&mut random);
        let ends = drawn_ends(&mut random, &limits);
        let (up, down) = ways_of_ramps(limits);
        let mut rig = Rig::new(limits);
        for end in &ends {
            rig.move_to(*end, BLENDING[random.below(4) as usize]);
        }
        rig.run();
        let last = ends[ends.len() - 1].abs();
        for (end, speed) in ends.iter().zip(&rig.speeds) {
            // The set-point is up to a scan past the end.
            if end.abs() >= up && last - end.abs() >= down + limits.velocity * CYCLE {
                at_full_speed += 1;
                let full = limits.velocity * (1.0 - 1e-9);
                assert!(*speed >= full, "seed {seed}: {end} is passed with {speed}");
            }
        }
    }
    assert!(at_full_speed > cases(500), "only {at_full_speed}");
}

/// The scans in which the moves are commanded.
type Arrivals = Vec<u64>;

/// A chain whose moves are commanded one after the other, with a disturbance in each scan.
fn chain_in_time(
    limits: Limits,
    moves: &[(f64, BufferMode)],
    arrivals: &Arrivals,
    mut disturb: impl FnMut(&mut Rig),
) -> Rig {
    let mut rig = Rig::new(limits);
    let mut next = 0;
    while next < moves.len() || rig.axis.state() != AxisState::Standstill {
        assert!(rig.scan < LONGEST, "does not end");
        while next < moves.len() && arrivals[next] <= rig.scan {
            rig.move_to(moves[next].0, moves[next].1);
            next += 1;
        }
        disturb(&mut rig);
        rig.step();
    }
    rig.run();
    rig
}

/// Covers: B15
#[test]
fn commanded_when_ever_a_chain_is_no_later_than_buffered() {
    for seed in 0..cases(3_000) {
        let mut random = Random(seed);
        let limits = drawn_limits(&mut random);
        let ends = drawn_ends(&mut random, &limits);
        let mut at = 0;
        let longest = [10, 100, 400][random.below(3) as usize];
        let arrivals: Arrivals = ends
            .iter()
            .map(|_| {
                let now = at;
                at += random.below(longest);
                now
            })
            .collect();
        let with = |mode: BufferMode| -> Vec<_> { ends.iter().map(|end| (*end, mode)).collect() };
        let blended = chain_in_time(limits, &with(BufferMode::BlendingHigh), &arrivals, |_| {}).scan;
        let buffered = chain_in_time(limits, &with(BufferMode::Buffered), &arrivals, |_| {}).scan;
        assert!(
            blended <= buffered,
            "seed {seed}: {blended} blended, {buffered} buffered"
        );
    }
}

/// Covers: B17
#[test]
fn an_override_on_the_way_keeps_order_and_limits() {
    for seed in 0..cases(2_000) {
        let mut random = Random(seed);
        let limits = drawn_limits(&mut random);
        let ends = drawn_ends(&mut random, &limits);
        let mut changes = Random(seed ^ 0x5a5a);
        let moves: Vec<_> = ends.iter().map(|end| (*end, BufferMode::BlendingNext)).collect();
        let arrivals = vec![0; ends.len()];
        chain_in_time(limits, &moves, &arrivals, |rig| {
            if changes.below(40) == 0 {
                rig.set_override(changes.between(0.2, 1.0));
            }
        });
    }
}

/// Halted by the override anywhere, a chain continues from there, not back to an end that the halt has passed. Only
/// after a halt that begins on the last ramp down is nothing left to move.
///
/// Covers: B17
#[test]
fn a_halt_on_the_way_is_no_reason_to_go_back() {
    for seed in 0..cases(2_000) {
        let mut random = Random(seed);
        let limits = drawn_limits(&mut random);
        let ends = drawn_ends(&mut random, &limits);
        let mut rig = Rig::new(limits);
        for end in &ends {
            rig.move_to(*end, BufferMode::BlendingPrevious);
        }
        let halt = random.below(300);
        let on = halt + 1 + random.below(200);
        let side = ends[0].signum();
        let mut ended_at_last = false;
        while rig.axis.state() != AxisState::Standstill {
            assert!(rig.scan < LONGEST, "seed {seed}: does not end");
            if rig.scan == halt || rig.scan == on {
                rig.set_override(if rig.scan == on { 1.0 } else { 0.0 });
            }
            let before = rig.axis.setpoint().position;
            let now = rig.advance();
            let left = (ends[ends.len() - 1] - before).abs();
            ended_at_last |= rig.scan > halt && rig.scan <= on && left <= 0.02 * limits.velocity * CYCLE;
            let back = side * (before - now);
            assert!(
                ended_at_last || back <= 1e-9 * rig.watch.largest,
                "seed {seed}: back by {back}"
            );
        }
        assert_eq!(rig.axis.setpoint().position, ends[ends.len() - 1], "seed {seed}");
        let done = |(id, ..): &(CommandId, f64, Option<u64>)| rig.axis.fate(*id) == Fate::Done;
        assert!(rig.moves.iter().all(done), "seed {seed}: not all are done");
    }
}

#[test]
fn ends_closer_than_a_scan_are_passed_one_by_one() {
    for seed in 0..cases(500) {
        let mut random = Random(seed);
        let limits = drawn_limits(&mut random);
        let way = limits.velocity * CYCLE;
        let mut end = 0.0;
        let ends: Vec<f64> = (0..8)
            .map(|_| {
                let part = if random.below(3) == 0 {
                    random.between(0.01, 1.0)
                } else {
                    random.between(1.0, 200.0)
                };
                end += part * way;
                end
            })
            .collect();
        let blended = chain(limits, &ends, BufferMode::BlendingHigh);
        let buffered = chain(limits, &ends, BufferMode::Buffered);
        assert!(
            blended <= buffered,
            "seed {seed}: {blended} blended, {buffered} buffered"
        );
    }
}

/// An axis with a chain of these distances, relative or absolute, on a modulo axis of this length.
fn round(limits: Limits, length: f64, ways: &[f64], relative: bool, mode: BufferMode) -> Rig {
    let mut rig = Rig::of(AxisConfig {
        modulo: Some(length),
        ..AxisConfig::new(limits)
    });
    let direction = if ways[0] > 0.0 {
        Direction::Positive
    } else {
        Direction::Negative
    };
    let dynamics = Dynamics::at(limits.velocity);
    let mut end = 0.0_f64;
    for way in ways {
        end = (end + way).rem_euclid(length);
        let command = if relative {
            Command::MoveRelative {
                distance: *way,
                dynamics,
            }
        } else {
            Command::MoveAbsolute {
                position: end,
                dynamics,
                direction: direction.into(),
            }
        };
        let id = rig.command(command, mode);
        rig.turning.push((id, end));
    }
    rig
}

/// Covers: B8, B10
#[test]
fn a_modulo_axis_goes_round_as_one_motion() {
    for seed in 0..cases(1_000) {
        let mut random = Random(seed);
        let limits = drawn_limits(&mut random);
        let ends = drawn_ends(&mut random, &limits);
        let longest = ends.iter().zip([0.0].iter().chain(&ends));
        let ways: Vec<f64> = longest.map(|(end, from)| end - from).collect();
        // A whole turn is longer than any of the distances.
        let most = ways.iter().fold(0.0_f64, |most, way| most.max(way.abs()));
        let length = most * random.between(1.1, 3.0);
        let relative = random.below(2) == 0;
        let one = chain(limits, &ends[ends.len() - 1..], BufferMode::Aborting);
        let mut rig = round(
            limits,
            length,
            &ways,
            relative,
            BLENDING[random.below(4) as usize],
        );
        let side = ways[0].signum();
        let mut done = 0;
        while rig.axis.state() != AxisState::Standstill {
            assert!(rig.scan < LONGEST, "seed {seed}: does not end");
            let scope = &mut Scope::new(rig.scan, &mut rig.log);
            rig.axis.step_alone(scope);
            rig.scan += 1;
            let velocity = side * rig.axis.setpoint().velocity;
            assert!(velocity >= -1e-9 * limits.velocity, "seed {seed}: turns");
            let ended = rig
                .turning
                .iter()
                .filter(|(id, _)| rig.axis.fate(*id) == Fate::Done);
            done = ended.count();
        }
        assert_eq!(done, ways.len(), "seed {seed}: not all are done");
        let last = rig.turning[ways.len() - 1].1;
        let off = (rig.axis.setpoint().position - last).abs();
        if relative {
            assert!(
                off.min(length - off) <= 1e-12 * length,
                "seed {seed}: {off} beside {last}"
            );
        } else {
            assert_eq!(rig.axis.setpoint().position, last, "seed {seed}");
        }
        assert!(
            rig.scan <= one + 1,
            "seed {seed}: {} beside {one} scans",
            rig.scan
        );
    }
}

#[test]
fn a_successor_taken_away_leaves_no_limit() {
    for seed in 0..cases(2_000) {
        let mut random = Random(seed);
        let limits = drawn_limits(&mut random);
        let ends = drawn_ends(&mut random, &limits);
        let mut rig = Rig::new(limits);
        for end in &ends {
            rig.move_to(*end, BufferMode::BlendingHigh);
        }
        let at = random.below(300);
        let taken = 1 + random.below(ends.len() as u64 - 1) as usize;
        for _ in 0..at {
            if rig.axis.state() != AxisState::Standstill {
                rig.step();
            }
        }
        let (id, ..) = rig.moves[taken];
        if rig.axis.fate(id) == Fate::Waiting {
            assert!(rig.axis.withdraw(id));
            let scope = &mut Scope::new(rig.scan, &mut rig.log);
            rig.axis.replaced(id, true, None, scope);
            rig.moves.remove(taken);
            // An end that the axis passes too fast is passed twice.
            let mut watch = rig.watch;
            let (mut axis, mut log) = (rig.axis, rig.log);
            let mut scan = rig.scan;
            while axis.state() != AxisState::Standstill {
                assert!(scan < LONGEST, "seed {seed}: does not end");
                axis.step_alone(&mut Scope::new(scan, &mut log));
                watch.see(axis.setpoint().position).unwrap();
                scan += 1;
            }
            let last = rig.moves[rig.moves.len() - 1].1;
            assert_eq!(axis.setpoint().position, last, "seed {seed}");
        } else {
            rig.run();
        }
    }
}

#[test]
fn what_interrupts_a_chain_takes_over_within_the_limits() {
    for seed in 0..cases(2_000) {
        let mut random = Random(seed);
        let limits = drawn_limits(&mut random);
        let ends = drawn_ends(&mut random, &limits);
        let mut rig = Rig::new(limits);
        for end in &ends {
            rig.move_to(*end, BufferMode::BlendingLow);
        }
        for _ in 0..random.below(300) {
            if rig.axis.state() != AxisState::Standstill {
                rig.step();
            }
        }
        rig.moves.clear();
        let dynamics = Dynamics::at(limits.velocity);
        let command = match random.below(3) {
            0 => Command::Halt { dynamics },
            1 => Command::MoveVelocity {
                dynamics,
                direction: Direction::Negative.into(),
            },
            _ => Command::MoveRelative {
                distance: random.between(-100.0, 100.0),
                dynamics,
            },
        };
        rig.command(command, BufferMode::Aborting);
        for _ in 0..1_000 {
            rig.step();
        }
    }
}

/// Covers: B10, B18
#[test]
fn a_distance_behind_a_software_limit_ends_the_motion_before_it() {
    for order in 2..=4 {
        let mut rig = Rig::of(AxisConfig {
            software_limits: Some((-100.0, 7.5)),
            ..AxisConfig::new(limits(order))
        });
        let dynamics = Dynamics::at(50.0);
        let command = Command::MoveRelative {
            distance: 2.0,
            dynamics,
        };
        let moves: Vec<CommandId> = (0..5)
            .map(|_| rig.command(command, BufferMode::BlendingHigh))
            .collect();
        let mut most = 0.0_f64;
        while rig.axis.state() != AxisState::Standstill {
            rig.step();
            most = most.max(rig.axis.setpoint().position);
        }
        assert_eq!((most, rig.axis.setpoint().position), (6.0, 6.0));
        let fates: Vec<Fate> = moves.iter().map(|id| rig.axis.fate(*id)).collect();
        let failed = Fate::Failed(ErrorId::TargetOutsideSoftwareLimits);
        assert_eq!(fates, [Fate::Done, Fate::Done, Fate::Done, failed, failed]);
        assert_eq!(
            rig.scan,
            chain(limits(order), &[6.0], BufferMode::Aborting),
            "order {order}"
        );
    }
}

#[test]
fn other_dynamics_or_another_way_end_one_motion() {
    for seed in 0..cases(2_000) {
        let mut random = Random(seed);
        let limits = drawn_limits(&mut random);
        let mut ends = drawn_ends(&mut random, &limits);
        let more = drawn_ends(&mut random, &limits);
        let from = ends[ends.len() - 1];
        let first = ends.len();
        ends.extend(more.iter().map(|end| from + end));
        let slower = Dynamics {
            velocity: limits.velocity * random.between(0.2, 1.0),
            acceleration: limits.acceleration * random.between(0.5, 1.0),
            ..Dynamics::default()
        };
        let told = |mode: BufferMode| {
            let mut rig = Rig::new(limits);
            for (number, end) in ends.iter().enumerate() {
                let dynamics = if number < first {
                    Dynamics::default()
                } else {
                    slower
                };
                rig.move_with(*end, mode, dynamics);
            }
            rig.run()
        };
        let (blended, buffered) = (told(BufferMode::BlendingPrevious), told(BufferMode::Buffered));
        assert!(
            blended <= buffered,
            "seed {seed}: {blended} blended, {buffered} buffered"
        );
    }
}

/// Dynamics of a command within these limits: all of them, or a part.
pub fn drawn_dynamics(random: &mut Random, limits: &Limits) -> Dynamics {
    let part = |random: &mut Random, limit: f64| {
        if limit.is_finite() {
            limit * random.between(0.3, 1.0)
        } else {
            0.0
        }
    };
    Dynamics {
        velocity: limits.velocity * random.between(0.1, 1.0),
        acceleration: part(random, limits.acceleration),
        deceleration: part(random, limits.deceleration),
        jerk: part(random, limits.jerk),
        snap: part(random, limits.snap),
    }
}

/// Buffered moves are passed at rest. So is an end that is blended too late to be passed in motion. Nothing is ever
/// later.
#[test]
fn with_other_dynamics_a_chain_is_no_later_than_buffered() {
    let mut ratios = Vec::new();
    let mut later = Vec::new();
    for seed in 0..cases(4_000) {
        let mut random = Random(seed);
        let limits = drawn_limits(&mut random);
        let ends = drawn_ends(&mut random, &limits);
        let longest = [1, 10, 100, 400][random.below(4) as usize];
        let mut at = 0;
        let moves: Vec<_> = ends
            .iter()
            .map(|end| {
                let mode = BLENDING[random.below(4) as usize];
                let now = at;
                at += random.below(longest);
                (*end, drawn_dynamics(&mut random, &limits), mode, now)
            })
            .collect();
        let told = |buffered: bool| {
            let mut rig = Rig::new(limits);
            for (end, dynamics, mode, at) in &moves {
                while rig.scan < *at {
                    rig.step();
                }
                let mode = if buffered { BufferMode::Buffered } else { *mode };
                rig.move_with(*end, mode, *dynamics);
            }
            rig.run()
        };
        let (blended, buffered) = (told(false), told(true));
        if blended > buffered {
            later.push((seed, blended, buffered));
        }
        ratios.push(blended as f64 / buffered as f64);
    }
    ratios.sort_by(f64::total_cmp);
    println!(
        "median {:.3}, worst {:.3}",
        ratios[ratios.len() / 2],
        ratios[ratios.len() - 1]
    );
    assert_eq!(later, [], "seed, blended, buffered");
}
