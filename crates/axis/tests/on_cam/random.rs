//! Random cams, masters and limits, checked by independent arithmetic. The limits of the slave hold in every scan, a
//! slave on the curve is on it, and in sync it is at its master's place. A slave that can get in step does.
//!
//! `CAM_EPISODES=100000 cargo test -p standstill-tests --test axis --release on_cam::random` plays this number of
//! episodes, from `CAM_FIRST` on. With `CAM_LOOK` set it prints cam, limits and events of each, and stops at the
//! first snap above its limit.

use super::rig::{L1, MASTER, RELATIVE, Rig, WIDE, config, row};
use standstill_axis::{AxisState, BufferMode, CamRow, CamSelection, Command, Dynamics, Limits, Raw};
use standstill_planner::CamShape;
use standstill_planner::turns::split;
use standstill_testkit::{Random, cases, given, whole_or};
use std::ops::Range;

/// The results of all episodes.
#[derive(Debug, Default)]
struct Tally {
    episodes: u32,
    in_sync: u64,
    lagging: u64,
    off_curve: u64,
    ends: u64,
    refused: u32,
    settled: u32,
    waited: u32,
    shifted: u64,
    moved_on: u64,
    /// The largest excess of a difference over its limit, relative to it, for each order.
    over: [f64; 4],
}

/// The cam by independent arithmetic: the polynomial through both rows of a stretch, by divided differences.
struct Judge {
    rows: Vec<CamRow>,
    periodic: bool,
}

impl Judge {
    fn at(&self, x: f64) -> f64 {
        let (first, last) = (self.rows[0], self.rows[self.rows.len() - 1]);
        let length = last.master - first.master;
        let (x, rise) = if self.periodic {
            let periods = ((x - first.master) / length).floor();
            (x - periods * length, periods * (last.slave - first.slave))
        } else {
            (x.clamp(first.master, last.master), 0.0)
        };
        let pair = self.rows.windows(2).find(|pair| x < pair[1].master);
        let pair = pair.unwrap_or(&self.rows[self.rows.len() - 2..]);
        let (from, to) = (pair[0], pair[1]);
        let (width, lift) = (to.master - from.master, to.slave - from.slave);
        let u = (x - from.master) / width;
        let (u2, u4) = (u * u, u * u * u * u);
        let shape = match from.shape {
            CamShape::Line => u,
            CamShape::Rest7 => u4 * (35.0 + u * (-84.0 + u * (70.0 - 20.0 * u))),
            CamShape::Rest5 => u2 * u * (10.0 + u * (-15.0 + 6.0 * u)),
            shape => panic!("{shape:?} is not drawn"),
        };
        from.slave + lift * shape + rise
    }
}

fn limits(random: &mut Random, velocity: f64, order: u64) -> Limits {
    let acceleration = velocity * random.log(2.0, 40.0);
    let jerk = acceleration * random.log(5.0, 60.0);
    let snap = jerk * random.log(20.0, 200.0);
    Limits {
        velocity,
        acceleration,
        deceleration: acceleration,
        jerk: if order == 2 { f64::INFINITY } else { jerk },
        snap: if order < 4 { f64::INFINITY } else { snap },
    }
}

/// Like [`rows`], with straight pieces and jerks that step.
fn rows_with_corners(random: &mut Random, order: u64) -> Vec<CamRow> {
    let mut rows = rows(random, order);
    for row in &mut rows {
        row.shape = random.one_of(&[CamShape::Line, CamShape::Line, CamShape::Rest5, CamShape::Rest7]);
    }
    rows
}

fn rows(random: &mut Random, order: u64) -> Vec<CamRow> {
    let count = 2 + random.below(5);
    let shape = if order == 3 && random.below(2) == 0 {
        CamShape::Rest5
    } else {
        CamShape::Rest7
    };
    let mut master = random.between(-100.0, 100.0);
    let first = random.between(-50.0, 50.0);
    let mut rows = vec![row(master, first, shape)];
    for _ in 1..count {
        master += random.between(20.0, 200.0);
        rows.push(row(master, random.between(-50.0, 50.0), shape));
    }
    if random.below(3) > 0 {
        // Most cams return to their beginning.
        let last = rows.len() - 1;
        rows[last].slave = first;
    }
    rows
}

struct Episode {
    rig: Rig,
    judge: Judge,
    /// The place of the cam: positions of the master and of the slave at the cam's 0.
    offsets: Option<(f64, f64)>,
    scalings: (f64, f64),
    /// Lengths of turns, if both are modulo axes, and the turn of the shadow.
    turns: Option<(f64, f64)>,
    turn: f64,
    seed: u64,
}

impl Episode {
    /// The position of the cam for a master at `place`.
    fn curve(&self, place: f64) -> Option<f64> {
        let (master, slave) = self.offsets?;
        let x = (place - master) / self.scalings.0;
        Some(slave + self.scalings.1 * self.judge.at(x))
    }

    /// The distance of a slave that is `at` this place from the curve for a master at `shadow`, in the turn of the
    /// shadow. Whole periods may be dropped, so it may be in any turn by now.
    fn off_curve(&mut self, at: f64, shadow: f64) -> f64 {
        let off = |turn: f64| {
            let master = self.turns.map_or(0.0, |(length, _)| turn * length);
            let off = at - self.curve(shadow + master).expect("absolute");
            match self.turns {
                Some((_, length)) => off - (off / length).round() * length,
                None => off,
            }
        };
        let known = self.turn;
        let near = (0..200).flat_map(|further| [known + f64::from(further), known - f64::from(further)]);
        let found = near.into_iter().take(if self.turns.is_some() { 400 } else { 1 });
        let found = found.into_iter().find(|turn| off(*turn).abs() < 1e-8);
        let off = off(found.unwrap_or(known)).abs();
        self.turn = found.unwrap_or(known);
        off
    }

    fn judge(&mut self, tally: &mut Tally) {
        let seed = self.seed;
        let slave = self.rig.slave();
        let at = slave.setpoint().position;
        if slave.state() == AxisState::ErrorStop {
            panic!("seed {seed}: {:?} in scan {}", slave.error_id(), self.rig.scan);
        }
        let coupled = slave.coupled();
        let coupled = coupled.unwrap_or_else(|| panic!("seed {seed}: not coupled in scan {}", self.rig.scan));
        let Some(shadow) = coupled.shadow else {
            tally.off_curve += 1;
            return;
        };
        let ends = slave.cam_ends();
        tally.shifted += u64::from(coupled.phase != 0.0);
        tally.moved_on += u64::from(coupled.superimposed != 0.0);
        let is_over = !self.judge.periodic && ends > 0;
        let is_in_sync = slave.is_in_gear();
        if !is_over {
            let off = self.off_curve(at - coupled.superimposed, shadow);
            assert!(
                off < 1e-8,
                "seed {seed}: {off} off the curve in scan {}",
                self.rig.scan
            );
        }
        if is_in_sync {
            tally.in_sync += 1;
            let master = self.rig.master() + coupled.phase;
            let master = match self.turns {
                Some((length, _)) => split(master, length).1,
                None => master,
            };
            assert!(
                shadow == master,
                "seed {seed}: in sync at {shadow}, master at {master}"
            );
        } else {
            tally.lagging += 1;
        }
    }
}

/// A random shift between master and slave, or a random superimposed motion.
fn adds(rig: &mut Rig, random: &mut Random, velocity: f64) {
    let scope = &mut standstill_axis::Scope::new(rig.scan, &mut rig.log);
    let dynamics = Dynamics::at(velocity * random.log(0.01, 2.0));
    let master = rig.axes[MASTER].id();
    let slave = &mut rig.axes[super::rig::SLAVE];
    // A refused command changes nothing.
    match random.below(3) {
        0 => {
            let request = standstill_axis::PhaseShift {
                master,
                shift: random.between(-100.0, 100.0),
                is_relative: random.below(2) == 0,
                dynamics,
                buffer_mode: BufferMode::Aborting.into(),
            };
            let _refused = slave.shift_phase(&request, scope);
        }
        _ => {
            let request = standstill_axis::Superimpose {
                distance: random.between(-20.0, 20.0),
                dynamics,
            };
            let _refused = slave.superimpose(&request, scope);
        }
    }
}

/// An episode. With `more` a distance is added, the start waits or the master is slowed down. If drives do not
/// report, every motion step is a full one. Returns the digest of all that the slave published.
fn play(seed: u64, master_order: u64, more: bool, drives_tell: bool, tally: &mut Tally) -> u64 {
    let kind = Kind {
        more,
        drives_tell,
        ..Kind::default()
    };
    play_on(seed, master_order, kind, tally)
}

#[derive(Clone, Copy, Default)]
struct Kind {
    more: bool,
    drives_tell: bool,
    /// The cams stop their slaves.
    corners: bool,
    /// Both are modulo axes.
    round: bool,
}

/// The same for other kinds.
fn play_on(seed: u64, master_order: u64, kind: Kind, tally: &mut Tally) -> u64 {
    let Kind {
        more,
        drives_tell,
        corners,
        round,
    } = kind;
    let of_turns = &mut Random(seed ^ 0x7043);
    let turns = round.then(|| (of_turns.log(20.0, 500.0), of_turns.log(5.0, 200.0)));
    let random = &mut Random(seed);
    let other = &mut Random(seed ^ 0x5EED);
    let order = random.one_of(if corners { &[2, 3, 4] } else { &[3, 4, 4] });
    let velocity = random.log(20.0, 500.0);
    let master = limits(random, velocity, 4);
    let master = Limits {
        jerk: if master_order < 3 {
            f64::INFINITY
        } else {
            master.jerk
        },
        snap: if master_order < 4 {
            f64::INFINITY
        } else {
            master.snap
        },
        ..master
    };
    let rows = if corners {
        rows_with_corners(random, order)
    } else {
        rows(random, order)
    };
    let periodic = random.below(4) > 0;
    let steepest = rows.windows(2).map(|pair| {
        let [from, to] = pair else { unreachable!("a pair") };
        2.2 * ((to.slave - from.slave) / (to.master - from.master)).abs()
    });
    let steepest = steepest.fold(0.05, f64::max);
    let speed = velocity * steepest * random.log(0.6, 12.0);
    let slave = limits(random, speed, order);
    let start = random.between(-300.0, 300.0);
    let at = random.between(-60.0, 60.0);
    let in_turn = |place: f64, length: Option<f64>| length.map_or(place, |length| split(place, length).1);
    let (turn, slave_turn) = (turns.map(|turns| turns.0), turns.map(|turns| turns.1));
    let mut slave_config = config(slave, in_turn(at, slave_turn), slave_turn);
    if more && other.below(4) == 0 {
        slave_config.following.on_limit = standstill_axis::OnLimit::SlowMaster;
    }
    if corners {
        slave_config.following.cam_continuity = Some(0);
    }
    let mut rig = Rig::new(config(master, in_turn(start, turn), turn), slave_config);
    rig.drives_tell = drives_tell;
    let cam = rig.select(
        &rows,
        CamSelection {
            periodic,
            master_absolute: true,
            slave_absolute: true,
            ..RELATIVE
        },
    );
    let scalings = (
        random.one_of(&[1.0, 1.0, 2.0, -1.0, 0.75]),
        random.one_of(&[1.0, 1.0, -1.0, 0.5]),
    );
    let offsets = (random.between(-50.0, 50.0), random.between(-20.0, 20.0));
    let cam_in = standstill_axis::CamIn {
        master_scaling: scalings.0,
        slave_scaling: scalings.1,
        master_offset: offsets.0,
        slave_offset: offsets.1,
        ..rig.cam_in(cam)
    };
    let waits = more && other.below(4) == 0;
    let (begin, end) = (rows[0].master, rows[rows.len() - 1].master);
    let cam_in = if waits {
        standstill_axis::CamIn {
            sync_position: other.between(begin, end),
            start_distance: other.between(-0.9, 0.9) * (end - begin),
            ..cam_in
        }
    } else {
        cam_in
    };
    let mut episode = Episode {
        rig,
        judge: Judge { rows, periodic },
        offsets: Some(offsets),
        scalings,
        turns,
        turn: 0.0,
        seed,
    };
    let moves = |episode: &mut Episode, random: &mut Random| {
        let command = match random.below(4) {
            0 => Command::MoveRelative {
                distance: random.between(-400.0, 400.0),
                dynamics: Dynamics::at(velocity * random.between(0.1, 1.0)),
            },
            1 => Command::Halt {
                dynamics: Dynamics::default(),
            },
            _ => Command::MoveVelocity {
                dynamics: Dynamics::at(velocity * random.between(-1.0, 1.0)),
                direction: Raw::default(),
            },
        };
        episode.rig.command(MASTER, command);
    };
    if random.below(2) == 0 {
        moves(&mut episode, random);
        for _ in 0..random.below(1500) {
            episode.rig.step();
        }
    }
    if episode.rig.engage(cam_in, BufferMode::Aborting).is_err() {
        tally.refused += 1;
        return episode.rig.digest;
    }
    tally.episodes += 1;
    if std::env::var("CAM_LOOK").is_ok() {
        println!(
            "{:?} periodic {periodic} {scalings:?} {offsets:?} {slave:?}",
            episode.judge.rows
        );
    }
    let mut gave_up = false;
    for scan in 0..3000 {
        if scan % 500 == 499 || (scan == 0 && random.below(3) == 0) {
            moves(&mut episode, random);
        }
        if more && other.below(200) == 0 {
            adds(&mut episode.rig, other, speed);
        }
        episode.rig.step();
        if std::env::var("CAM_LOOK").is_ok() {
            let rig = &mut episode.rig;
            let over = rig.peaks[3] > slave.snap * (1.0 + 1e-6);
            let events = rig.events();
            if !events.is_empty() {
                println!(
                    "{} {events:?} {:?} {:?}",
                    rig.scan,
                    rig.axes[MASTER].setpoint(),
                    rig.state()
                );
            }
            assert!(!over, "{:?} {:?}", rig.slave().coupled(), rig.slave().outlook());
        }
        if episode.rig.slave().awaited_command().is_some() {
            tally.waited += 1;
            continue;
        }
        if !episode.rig.slave().is_on_a_cam() {
            // Error 219: without periods there is not always a way.
            gave_up = true;
            break;
        }
        episode.judge(tally);
    }
    if !gave_up && episode.rig.slave().is_on_a_cam() {
        tally.ends += u64::from(episode.rig.slave().cam_ends());
        // The slave gets in step with a master at rest, except on cams that leave hardly any acceleration.
        episode.rig.command(
            MASTER,
            Command::Halt {
                dynamics: Dynamics::default(),
            },
        );
        for _ in 0..10_000 {
            episode.rig.step();
            if std::env::var("CAM_LOOK").is_ok() {
                let rig = &mut episode.rig;
                let events = rig.events();
                if !events.is_empty() {
                    println!(
                        "{} {events:?} {:?} {:?}",
                        rig.scan,
                        rig.state(),
                        rig.slave().coupled()
                    );
                }
            }
            if !episode.rig.slave().is_on_a_cam() {
                gave_up = true;
                break;
            }
            episode.judge(tally);
            if episode.rig.slave().is_in_gear() && episode.rig.axes[MASTER].setpoint().is_at_rest() {
                tally.settled += 1;
                break;
            }
        }
    }
    if gave_up {
        let slave = episode.rig.slave();
        assert!(
            slave.state() != AxisState::ErrorStop,
            "seed {seed}: {:?} in scan {}",
            slave.error_id(),
            episode.rig.scan
        );
        assert!(!periodic || waits, "seed {seed}: {:?}", episode.rig.events());
        tally.refused += 1;
    }
    let rig = &episode.rig;
    let bounds = [slave.velocity, slave.acceleration, slave.jerk, slave.snap];
    let largest = rig.largest.max(turn.unwrap_or(0.0)).max(100.0);
    let mut per = 1.0;
    for (order, (peak, bound)) in rig.peaks.into_iter().zip(bounds).enumerate() {
        per *= 2e3;
        let over = (peak - 16.0 * largest * f64::EPSILON * per) / bound - 1.0;
        tally.over[order] = tally.over[order].max(over);
        assert!(
            over <= 1e-9,
            "seed {seed}, more {more}, master {master_order}: d{} is {over:e} over its limit: {:?}",
            order + 1,
            rig.peaks
        );
    }
    rig.digest
}

/// If nothing is new for a slave in sync its step is a short one. Each bit is that of the full step.
#[test]
fn the_short_way_shows_the_bits_of_the_long_one() {
    let mut tally = Tally::default();
    for seed in 5000..5000 + whole_or(60, 4) {
        let digests = [true, false].map(|drives_tell| play(seed, 4, seed % 2 == 0, drives_tell, &mut tally));
        assert_eq!(digests[0], digests[1], "seed {seed}");
    }
    assert!(tally.in_sync > 0 && tally.ends > 0);
}

/// The same on modulo axes, in both directions.
#[test]
fn the_short_way_round_shows_the_bits_of_the_long_one() {
    let digests = [true, false].map(|drives_tell| {
        let mut rig = Rig::new(config(L1, 0.0, Some(360.0)), config(WIDE, 30.0, Some(70.0)));
        rig.drives_tell = drives_tell;
        let rows = [row(0.0, 0.0, CamShape::Rest7), row(250.0, 100.0, CamShape::Rest7)];
        rig.follow(&rows, RELATIVE);
        for velocity in [150.0, -80.0, 20.0] {
            rig.run(velocity);
            rig.steps(5000);
        }
        assert!(rig.slave().is_in_gear() && rig.slave().cam_ends() > 2);
        rig.digest
    });
    assert_eq!(digests[0], digests[1]);
}

/// The seeds from `CAM_FIRST` on, as many as `CAM_EPISODES` asks for.
fn episodes(usual: u64) -> Range<u64> {
    let first = given("CAM_FIRST", 0);
    first..first + given("CAM_EPISODES", usual)
}

/// Covers: G45, G46, G51, G60, G62, G66, G78
#[test]
fn random_episodes_keep_limits_and_curve() {
    let mut tally = Tally::default();
    for seed in episodes(whole_or(250, 13)) {
        play(seed, 4, false, true, &mut tally);
        play(seed, 4, true, true, &mut tally);
        if seed % 4 == 0 {
            // With masters that change derivatives at once which the slave may not.
            play(seed, 2 + (seed / 4) % 2, seed % 8 == 0, true, &mut tally);
        }
    }
    println!("{tally:?}");
    assert!(tally.waited > 0 && tally.shifted > 0 && tally.moved_on > 0);
    assert!(tally.in_sync > 0 && tally.lagging > 0 && tally.off_curve > 0 && tally.ends > 0);
}

/// Limits and curve hold on cams with corners, too. A slave that may not jump there comes to rest at each of them.
///
/// Covers: G71
#[test]
fn random_cams_with_corners_keep_limits_and_curve() {
    let mut tally = Tally::default();
    let kind = |more| Kind {
        more,
        drives_tell: true,
        corners: true,
        round: false,
    };
    for seed in episodes(cases(120)) {
        play_on(seed, 4, kind(false), &mut tally);
        play_on(seed, 4, kind(true), &mut tally);
        if seed % 4 == 0 {
            play_on(seed, 2 + (seed / 4) % 2, kind(seed % 8 == 0), &mut tally);
        }
    }
    println!("{tally:?}");
    assert!(tally.in_sync > 0 && tally.lagging > 0 && tally.ends > 0);
}

/// The same on modulo axes.
///
/// Covers: G45, G69, G78
#[test]
fn random_axes_that_come_round_keep_limits_and_curve() {
    let mut tally = Tally::default();
    for seed in episodes(cases(240)) {
        let kind = Kind {
            more: seed % 2 == 0,
            drives_tell: true,
            corners: seed % 8 == 0,
            round: true,
        };
        play_on(seed, 4, kind, &mut tally);
    }
    println!("{tally:?}");
    assert!(tally.in_sync > 0 && tally.lagging > 0 && tally.ends > 0);
}

/// Found among 60,000 seeds: sync lost in states that must be checked in full, and cams that begin on an end.
#[test]
fn episodes_that_went_wrong_once() {
    let mut tally = Tally::default();
    // A pulse of snap that begins and ends within one scan, with a superimposed motion.
    play(301_480, 4, true, true, &mut tally);
    for seed in [
        // A shadow that passed the end on its way back.
        320_030, 2070, 4966, 9145, 13_434, 19_179, 19_182, 21_168, 24_170, 28_268, 33_511, 38_094, 39_547,
        42_775, 46_225, 57_411, 68_487,
    ] {
        play(seed, 4, false, true, &mut tally);
    }
    // An end that is a corner: the slave was there, except for rounding, before it was at rest.
    let corners = Kind {
        more: true,
        drives_tell: true,
        corners: true,
        round: false,
    };
    play_on(1695, 4, corners, &mut tally);
}
