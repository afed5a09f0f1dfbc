//! Cams: the laws between two rows, their joints, their bounds, and their anchor between two axes.

use crate::grid_support::Digest;
use standstill_planner::cam::CAM_ROWS;
use standstill_planner::{
    Anchor, Cam, CamAt, CamBounds, CamBuild, CamCause, CamFault, CamHead, CamLaw, CamPiece, CamRow, CamShape,
    Limits, Place, Setpoint,
};
use standstill_testkit::Random;

struct Made {
    head: CamHead,
    pieces: Vec<CamPiece>,
}

impl Made {
    fn cam(&self) -> Cam<'_> {
        Cam {
            head: &self.head,
            pieces: &self.pieces,
        }
    }

    /// Where the slave is for a master at `x` that moves with 1 u/s: position and derivatives by x.
    fn at(&self, x: f64) -> [f64; 5] {
        let at = law().at(&self.cam(), &Anchor::default(), place(0, x), &moving(1.0), 0);
        at.state.numbers()
    }
}

/// The bounds of the four derivatives.
fn four(bounds: &CamBounds) -> [f64; 4] {
    [bounds.first, bounds.second, bounds.third, bounds.fourth]
}

fn made(rows: &[CamRow], periodic: bool) -> Result<Made, CamFault> {
    let mut pieces = vec![CamPiece::default(); rows.len().saturating_sub(1)];
    let mut build = CamBuild::new(rows.len(), periodic)?;
    let row = |index: usize| rows.get(index).copied();
    for _ in 0..=CAM_ROWS {
        if let Some(head) = build.go_on(&row, &mut pieces, 32)? {
            return Ok(Made { head, pieces });
        }
    }
    panic!("never complete");
}

fn law() -> CamLaw {
    CamLaw {
        master_scaling: 1.0,
        slave_scaling: 1.0,
        origin: 0.0,
        master_turn: None,
        slave_turn: None,
    }
}

fn row(master: f64, slave: f64, shape: CamShape) -> CamRow {
    CamRow {
        master,
        slave,
        shape,
        ..CamRow::default()
    }
}

fn place(turns: i64, position: f64) -> Place {
    Place {
        turns,
        position,
        ..Place::default()
    }
}

fn moving(velocity: f64) -> Setpoint {
    Setpoint {
        velocity,
        ..Setpoint::default()
    }
}

/// Table GS15: up 100 over 180 and back.
fn up_and_back() -> Made {
    let rows = [
        row(0.0, 0.0, CamShape::Rest7),
        row(180.0, 100.0, CamShape::Rest7),
        row(360.0, 0.0, CamShape::Through),
    ];
    made(&rows, true).unwrap()
}

/// The largest magnitudes of the four derivatives, sampled.
fn peaks(made: &Made, from: f64, to: f64, samples: u32) -> [f64; 4] {
    let mut most = [0.0_f64; 4];
    for sample in 0..samples {
        let x = from + (to - from) * f64::from(sample) / f64::from(samples);
        for (most, value) in most.iter_mut().zip(&made.at(x)[1..]) {
            *most = most.max(value.abs());
        }
    }
    most
}

/// Published peaks of the laws, lift 1 over width 1 (VDI 2143).
#[test]
fn the_laws_have_their_published_peaks() {
    for (shape, published) in [
        (CamShape::Rest5, [1.875, 5.7735, 60.0, 360.0]),
        (CamShape::Rest7, [2.1875, 7.5132, 52.5, 840.0]),
        (CamShape::Line, [1.0, 0.0, 0.0, 0.0]),
    ] {
        let rows = [row(0.0, 0.0, shape), row(1.0, 1.0, CamShape::Line)];
        let made = made(&rows, false).unwrap();
        let found = peaks(&made, 0.0, 1.0, 20_000);
        let bounds = four(made.pieces[0].bounds());
        for ((found, published), bound) in found.into_iter().zip(published).zip(bounds) {
            assert!(
                (found - published).abs() <= 6e-5 * published + 1e-9,
                "{shape:?} {found}"
            );
            assert!(
                bound >= found - 1e-9 && bound <= 1.011 * found + 1e-9,
                "{shape:?} {bound}"
            );
        }
    }
}

/// The curve of given derivatives has them at both rows, and is the polynomial that they make.
#[test]
fn given_derivatives_are_met() {
    let end = |master, slave, slope, curvature, third, shape| CamRow {
        master,
        slave,
        slope,
        curvature,
        third,
        shape,
    };
    // x^5 from 1 to 2, and x^7.
    let fifth = [
        end(1.0, 1.0, 5.0, 20.0, 0.0, CamShape::Poly5),
        end(2.0, 32.0, 80.0, 160.0, 0.0, CamShape::Line),
        end(3.0, 33.0, 0.0, 0.0, 0.0, CamShape::Line),
    ];
    let seventh = [
        end(1.0, 1.0, 7.0, 42.0, 210.0, CamShape::Poly7),
        end(2.0, 128.0, 448.0, 1344.0, 3360.0, CamShape::Line),
        end(3.0, 33.0, 0.0, 0.0, 0.0, CamShape::Line),
    ];
    for (rows, degree) in [(fifth, 5), (seventh, 7)] {
        let made = made(&rows, false).unwrap();
        for step in 0..100 {
            let x = 1.0 + f64::from(step) / 100.0;
            let mut factor = 1.0;
            for (order, found) in made.at(x).into_iter().enumerate() {
                let power = (order as i32..degree).fold(1.0, |power, _| power * x);
                let exact = factor * power;
                assert!(
                    (found - exact).abs() <= 1e-11 * exact.abs(),
                    "{degree} {order} {x} {found}"
                );
                factor *= f64::from(degree - order as i32);
            }
        }
    }
}

#[test]
fn points_of_a_polynomial_give_it_back() {
    // Of degree 4, which five points tell; the ends are level by themselves.
    let value = |x: f64| 16.0 * x * x * (1.0 - x) * (1.0 - x);
    let rows: Vec<_> = (0..=20)
        .map(|index| f64::from(index) / 20.0)
        .map(|x| row(x, value(x), CamShape::Through))
        .collect();
    let made = made(&rows, true).unwrap();
    for step in 300..700 {
        let x = f64::from(step) / 1000.0;
        assert!((made.at(x)[0] - value(x)).abs() < 1e-13, "{x}");
    }
    assert_eq!(made.head.smooth.continuity, 3);
}

/// Points take the derivatives that another law, or the end of a cam without periods, has at their row.
#[test]
fn estimated_points_join_their_neighbours() {
    let rows = [
        row(0.0, 0.0, CamShape::Line),
        row(10.0, 20.0, CamShape::Through),
        row(20.0, 35.0, CamShape::Through),
        row(30.0, 38.0, CamShape::Rest7),
        row(50.0, 0.0, CamShape::Through),
        row(55.0, 3.0, CamShape::Through),
        row(60.0, 1.0, CamShape::Through),
    ];
    let made = made(&rows, false).unwrap();
    // Only the straight line begins with a corner.
    assert_eq!(
        (made.head.smooth.continuity, made.head.smooth.jump),
        (0, (1, 2.0))
    );
    let near = |x: f64| made.at(x);
    for (join, expected) in [(10.0, 2.0), (30.0, 0.0), (50.0, 0.0), (60.0, 0.0)] {
        let [_, slope, curvature, ..] = near(join - 1e-9);
        assert!(
            (slope - expected).abs() < 1e-7 && curvature.abs() < 1e-6,
            "{join} {slope}"
        );
    }
}

/// Covers: G71
#[test]
fn continuity_is_told_with_the_row_and_the_jump() {
    let triple = |first, second, third| {
        made(
            &[row(0.0, 0.0, first), row(1.0, 1.0, second), row(3.0, 0.0, third)],
            true,
        )
        .unwrap()
        .head
    };
    let rest = CamShape::Rest7;
    assert_eq!(triple(rest, rest, rest).smooth.continuity, 3);
    let fives = triple(CamShape::Rest5, CamShape::Rest5, rest);
    assert_eq!(fives.smooth.continuity, 2);
    // -60/8 after 60: at row 2 by 67.5, at row 1 by as much.
    assert_eq!(fives.smooth.jump, (2, 67.5));
    let lines = triple(CamShape::Line, CamShape::Line, rest);
    assert_eq!((lines.smooth.continuity, lines.smooth.jump), (0, (2, 1.5)));
    let mixed = triple(rest, CamShape::Line, rest);
    assert_eq!((mixed.smooth.continuity, mixed.smooth.jump), (0, (2, 0.5)));
    // One straight line around the period has no corner; without periods it has two.
    let line = [row(0.1, 0.0, CamShape::Line), row(0.8, 2.1, CamShape::Line)];
    assert_eq!(made(&line, true).unwrap().head.smooth.continuity, 3);
    let slope = 2.1 / (0.8 - 0.1);
    assert_eq!(made(&line, false).unwrap().head.smooth.jump, (1, slope));
}

/// Lines from 0 over 10 and 20 (one straight line) to 30 and 40, then a dwell to 50.
fn zigzag(periodic: bool) -> Made {
    let line = CamShape::Line;
    let rows = [
        row(0.0, 0.0, line),
        row(10.0, 7.0, line),
        row(20.0, 14.0, line),
        row(30.0, 4.0, line),
        row(40.0, 0.0, CamShape::Rest5),
        row(50.0, 0.0, line),
    ];
    made(&rows, periodic).unwrap()
}

/// Covers: G71
#[test]
fn the_next_corner_is_found_both_ways_through_periods_and_not_where_it_is_stood_on() {
    let cam = zigzag(true);
    let next = |x: f64, forwards: bool| cam.cam().next_corner(x, forwards, 1e9, 3);
    for (x, forwards, found) in [
        (0.0, true, 20.0),
        (5.0, true, 20.0),
        (10.0, true, 20.0),
        (20.0, true, 30.0),
        (20.0 - 1e-13, true, 30.0),
        (41.0, true, 50.0),
        (50.0, true, 70.0),
        (-1.0, true, 0.0),
        (-50.0, true, -30.0),
        (1e6, true, 1e6 + 20.0),
        (0.0, false, -10.0),
        (5.0, false, 0.0),
        (19.0, false, 0.0),
        (20.0, false, 0.0),
        (41.0, false, 40.0),
        (40.0, false, 30.0),
        (-41.0, false, -50.0),
    ] {
        let (place, derivative) = next(x, forwards).unwrap();
        assert!(
            (place - found).abs() < 1e-9 && derivative == 0,
            "{x} {forwards}: {place}"
        );
    }
    // The corner is found within its distance, and not within less.
    let cam = cam.cam();
    assert!(cam.next_corner(15.0, true, 4.9, 3).is_none());
    assert!(cam.next_corner(15.0, true, 5.1, 3).is_some());
    assert!(cam.next_corner(15.0, false, 14.9, 3).is_none());
    let level = up_and_back();
    assert!(level.cam().next_corner(0.0, true, 1e9, 3).is_none());
}

/// Covers: G71
#[test]
fn without_periods_the_ends_are_corners_and_there_is_none_outside() {
    let cam = zigzag(false);
    assert_eq!(cam.head.smooth_inside.jump, (3, 1.7));
    let next = |x: f64, forwards: bool| cam.cam().next_corner(x, forwards, 1e9, 3).map(|(place, _)| place);
    assert_eq!(next(-5.0, true), Some(0.0));
    assert_eq!(next(-5.0, false), None);
    assert_eq!(next(5.0, false), Some(0.0));
    assert_eq!(next(0.0, false), None);
    // The dwell does not move the slave, so it ends without a jump.
    assert_eq!(next(45.0, true), None);
    assert_eq!(next(60.0, false), Some(40.0));
    let line = made(
        &[row(0.0, 0.0, CamShape::Line), row(1.0, 2.0, CamShape::Line)],
        false,
    )
    .unwrap();
    assert_eq!(line.head.smooth_inside.continuity, 3);
    assert_eq!(
        (line.head.smooth.continuity, line.head.smooth.jump),
        (0, (1, 2.0))
    );
    let corners = |order: usize| {
        let rise = made(
            &[row(0.0, 0.0, CamShape::Rest5), row(1.0, 2.0, CamShape::Rest5)],
            false,
        )
        .unwrap();
        (0..2)
            .map(|row| rise.cam().jumps_at(row, order))
            .collect::<Vec<_>>()
    };
    assert_eq!(corners(2), [None, None]);
    assert_eq!(corners(3), [Some(2), Some(2)]);
}

/// Covers: G80
#[test]
fn rows_that_make_no_cam_are_told_by_number() {
    let good = row(0.0, 0.0, CamShape::Rest7);
    let cause = |rows: &[CamRow]| made(rows, false).err().map(|fault| (fault.cause, fault.row));
    assert_eq!(cause(&[]), Some((CamCause::Count, 0)));
    assert_eq!(cause(&[good]), Some((CamCause::Count, 1)));
    let long: Vec<_> = (0..=CAM_ROWS)
        .map(|index| row(index as f64, 0.0, CamShape::Rest7))
        .collect();
    assert_eq!(cause(&long), Some((CamCause::Count, CAM_ROWS + 1)));
    assert_eq!(cause(&long[..CAM_ROWS]), None);
    for (index, wrong) in [(70, f64::NAN), (511, f64::INFINITY), (0, f64::NAN)] {
        let mut rows = long[..CAM_ROWS].to_vec();
        rows[index].slave = wrong;
        assert_eq!(cause(&rows), Some((CamCause::NotFinite, index + 1)));
        rows[index].slave = 0.0;
        rows[index].third = wrong;
        assert_eq!(cause(&rows), Some((CamCause::NotFinite, index + 1)));
    }
    let second = |master| [good, row(master, 1.0, CamShape::Rest7)];
    assert_eq!(cause(&second(0.0)), Some((CamCause::Order, 2)));
    assert_eq!(cause(&second(-1.0)), Some((CamCause::Order, 2)));
    // So short that its derivatives are not finite.
    assert_eq!(cause(&second(1e-200)), Some((CamCause::NotFinite, 2)));
}

/// Covers: G73
#[test]
fn the_chain_rule_is_what_differences_of_fine_samples_are() {
    let made = up_and_back();
    let law = CamLaw {
        master_scaling: -1.5,
        slave_scaling: 0.7,
        ..law()
    };
    // A master with all derivatives, as a polynomial of time.
    let at = |t: f64| Setpoint {
        position: 40.0 + t * (200.0 + t * (500.0 + t * (-3000.0 + t * 20_000.0))),
        velocity: 200.0 + t * (1000.0 + t * (-9000.0 + t * 80_000.0)),
        acceleration: 1000.0 + t * (-18_000.0 + t * 240_000.0),
        jerk: -18_000.0 + t * 480_000.0,
        snap: 480_000.0,
    };
    let slave = |t: f64| {
        let master = at(t);
        let found = law.at(
            &made.cam(),
            &Anchor::default(),
            place(0, master.position),
            &master,
            0,
        );
        found.state.numbers()
    };
    for step in 1..100 {
        let (t, h) = (f64::from(step) * 1e-3, 1e-5);
        let (before, here, after) = (slave(t - h), slave(t), slave(t + h));
        for order in 1..5 {
            let found = here[order];
            let difference = (after[order - 1] - before[order - 1]) / (2.0 * h);
            let size = [200.0, 2000.0, 3e4, 1e6][order - 1];
            assert!(
                (found - difference).abs() <= 2e-5 * size,
                "{order} {t} {found} {difference}"
            );
        }
    }
}

/// Covers: GS15, G72
#[test]
fn the_example_has_its_values_and_its_highest_velocity() {
    let made = up_and_back();
    for (master, slave) in [
        (2.233_333, 0.000_081),
        (27.0, 1.210_317),
        (90.0, 50.0),
        (173.0, 99.992_718),
        (180.0, 100.0),
        (270.0, 50.0),
    ] {
        assert!((made.at(master)[0] - slave).abs() < 6e-7, "{master}");
    }
    assert_eq!((made.at(180.0)[0], made.at(360.0)[0]), (100.0, 0.0));
    let limits = Limits {
        velocity: 400.0,
        acceleration: 5000.0,
        deceleration: 5000.0,
        jerk: 1e5,
        snap: 5e6,
    };
    let highest = made.head.bounds.highest_velocity(&limits);
    assert!((0.99 * 329.143..=329.143).contains(&highest), "{highest}");
    let no_velocity = Limits {
        velocity: 1e9,
        ..limits
    };
    let jerk_and_snap = Limits {
        acceleration: 1e9,
        deceleration: 1e9,
        ..no_velocity
    };
    let snap_alone = Limits {
        jerk: 1e9,
        ..jerk_and_snap
    };
    for (limits, exact) in [(no_velocity, 464.4), (jerk_and_snap, 480.7), (snap_alone, 500.0)] {
        let highest = made.head.bounds.highest_velocity(&limits);
        assert!(
            highest <= exact + 0.1 && highest >= 0.99 * exact,
            "{highest} {exact}"
        );
    }
    assert_eq!(made.head.range, (0.0, 100.0));
}

/// The bound is above every value on the cam, and close to the largest.
#[test]
fn bounds_hold_and_are_close() {
    let mut random = Random(11);
    for _ in 0..200 {
        let mut master = random.between(-50.0, 50.0);
        let count = 2 + random.below(6);
        let rows: Vec<_> = (0..count)
            .map(|_| {
                master += random.between(0.1, 100.0);
                CamRow {
                    master,
                    slave: random.between(-100.0, 100.0),
                    slope: random.between(-3.0, 3.0),
                    curvature: random.between(-0.2, 0.2),
                    third: random.between(-0.01, 0.01),
                    shape: [CamShape::Poly7, CamShape::Poly5, CamShape::Through][random.below(3) as usize],
                }
            })
            .collect();
        let made = made(&rows, random.below(2) == 0).unwrap();
        for (piece, ends) in made.pieces.iter().zip(rows.windows(2)) {
            let found = peaks(&made, ends[0].master, ends[1].master, 2000);
            for (found, bound) in found.into_iter().zip(four(piece.bounds())) {
                assert!(bound >= found * (1.0 - 1e-9) - 1e-12, "{bound} {found}");
                // A narrow peak may lie between samples.
                assert!(bound <= 1.02 * found + 1e-12, "{bound} {found}");
            }
        }
    }
}

/// The bounds of a part of a cam are at most those of the whole, and at least the values in the part.
#[test]
fn parts_of_a_cam_have_bounds_of_their_own() {
    let made = up_and_back();
    let mut random = Random(12);
    for _ in 0..2000 {
        let low = random.between(-2000.0, 2000.0);
        let high = low + random.between(0.0, 1.0) * random.one_of(&[1.0, 100.0, 500.0]);
        let bounds = four(&law().bounds_between(&made.cam(), low, high));
        let found = peaks(&made, low, high, 50);
        for ((found, bound), all) in found.into_iter().zip(bounds).zip(four(&made.head.bounds)) {
            assert!(
                found <= bound * (1.0 + 1e-9) + 1e-15,
                "{low} {high} {found} {bound}"
            );
            assert!(bound <= all, "{low} {high} {bound} {all}");
        }
    }
    // Near the end of a rise, the curvature of its middle is no longer in the part.
    let near = law().bounds_between(&made.cam(), 175.0, 180.0);
    assert!(near.second < 0.2 * made.head.bounds.second, "{near:?}");
}

/// Covers: G69, G31
#[test]
fn periods_are_exact_however_many() {
    let made = up_and_back();
    // The master has turns of 1000, which is no multiple of 360. The cam is scaled to three quarters of its length.
    let law = CamLaw {
        master_scaling: 0.75,
        master_turn: Some(1000.0),
        ..law()
    };
    let period = 270_i128;
    for whole in [0_i64, 1, 3, 1_000_000, -1, -999_999, 1 << 40] {
        for position in [0.0, 0.25, 125.5, 999.75] {
            let found = law.at(
                &made.cam(),
                &Anchor::default(),
                place(whole, position),
                &moving(0.0),
                0,
            );
            // In quarters of a unit, exact.
            let quarters = i128::from(whole) * 4000 + (position * 4.0) as i128;
            let rest = quarters.rem_euclid(4 * period) as f64 / 4.0;
            let expected = made.at(rest / 0.75)[0];
            let off = (found.state.position - expected).abs();
            assert!(off <= 1e-12, "{whole} {position} {off}");
            assert_eq!(
                i128::from(found.periods),
                quarters.div_euclid(4 * period),
                "{whole}"
            );
        }
    }
}

/// A cam that rises with each period, on a slave with turns and on one without.
#[test]
fn a_rise_is_counted_in_whole_periods() {
    let rows = [row(0.0, 5.0, CamShape::Rest7), row(10.0, 12.0, CamShape::Rest7)];
    let made = made(&rows, true).unwrap();
    for (periods, x) in [(0_i64, 0.0), (3, 5.0), (1_000_000_000, 5.0), (-7, 2.5)] {
        let master = place(0, periods as f64 * 10.0 + x);
        let straight = law().at(&made.cam(), &Anchor::default(), master, &moving(0.0), 0);
        let expected = periods as f64 * 7.0 + made.at(x)[0];
        assert_eq!((straight.state.position, straight.periods), (expected, periods));
        let round = CamLaw {
            slave_turn: Some(7.0),
            ..law()
        };
        let turned = round.at(&made.cam(), &Anchor::default(), master, &moving(0.0), 0);
        assert_eq!(turned.place.turns, periods + i64::from(made.at(x)[0] >= 7.0));
        assert_eq!(turned.place.position, made.at(x)[0] % 7.0);
    }
}

/// Covers: G34, G67
#[test]
fn backwards_it_is_the_same_curve_to_the_bit() {
    let made = up_and_back();
    let mut there = Vec::new();
    let mut near = 0;
    let at = |x: f64, near| law().at(&made.cam(), &Anchor::default(), place(0, x), &moving(1.0), near);
    for step in 0..2000 {
        let found: CamAt = at(f64::from(step) * 0.37, near);
        near = found.piece;
        there.push(found);
    }
    for step in (0..2000).rev() {
        let found = at(f64::from(step) * 0.37, near);
        near = found.piece;
        assert_eq!(found, there[step as usize]);
    }
}

/// Covers: G76
#[test]
fn scalings_stretch_and_mirror() {
    let made = up_and_back();
    let at = |law: &CamLaw, x: f64| law.at(&made.cam(), &Anchor::default(), place(0, x), &moving(1.0), 0);
    for x in [1.0, 45.0, 90.0, 200.0] {
        let plain = at(&law(), x).state.numbers();
        let wide = CamLaw {
            master_scaling: 2.0,
            slave_scaling: -2.0,
            ..law()
        };
        let found = at(&wide, 2.0 * x).state.numbers();
        let expected = [-2.0, -1.0, -0.5, -0.25, -0.125];
        for ((found, plain), factor) in found.into_iter().zip(plain).zip(expected) {
            assert_eq!(found, plain * factor + 0.0, "{x}");
        }
        let back = CamLaw {
            master_scaling: -1.0,
            ..law()
        };
        assert_eq!(at(&back, -x).state.position, plain[0]);
        assert_eq!(at(&back, -x).state.velocity, -plain[1] + 0.0);
    }
}

/// Before its first row and after its last one a cam without periods holds the slave.
#[test]
fn without_periods_the_ends_hold() {
    let rows = [row(10.0, 5.0, CamShape::Rest7), row(20.0, 12.0, CamShape::Rest7)];
    let made = made(&rows, false).unwrap();
    for (x, slave, periods) in [
        (9.0, 5.0, -1),
        (10.0, 5.0, 0),
        (15.0, 8.5, 0),
        (20.0, 12.0, 1),
        (1e9, 12.0, 1),
    ] {
        let found = law().at(&made.cam(), &Anchor::default(), place(0, x), &moving(3.0), 0);
        assert_eq!((found.state.position, found.periods), (slave, periods), "{x}");
        assert_eq!(found.state.is_at_rest(), x != 15.0, "{x}");
    }
}

#[test]
fn every_piece_is_found_from_anywhere() {
    let rows: Vec<_> = (0..CAM_ROWS)
        .map(|index| row(index as f64 * 0.1, f64::from(index as u32 % 7), CamShape::Rest7))
        .collect();
    let made = made(&rows, false).unwrap();
    for index in 0..CAM_ROWS - 1 {
        for near in [0_usize, index, index + 1, index.saturating_sub(1), 510, 9999] {
            let found = made.cam().find(index as f64 * 0.1, near as u16);
            assert_eq!(usize::from(found), index, "{near}");
        }
    }
    assert_eq!(made.cam().find(-1.0, 300), 0);
    assert_eq!(made.cam().find(1e9, 300), 510);
}

/// A shadow within its limits leaves the slave within its own, wherever it is.
///
/// Covers: G78
#[test]
fn limits_of_a_shadow_leave_the_slave_within_its_own() {
    let made = up_and_back();
    let bounds = &made.head.bounds;
    for (acceleration, jerk, snap) in [(5000.0, 1e5, 5e6), (2000.0, 3e4, 1e6), (1200.0, 1e4, 3e5)] {
        let limits = Limits {
            velocity: 400.0,
            acceleration,
            deceleration: acceleration,
            jerk,
            snap,
        };
        for speed in [1e-6, 100.0, 200.0, 1e6] {
            let shadow = bounds.shadow(&limits, speed, 0.0).unwrap();
            let most = bounds.most(&Setpoint {
                position: 0.0,
                velocity: shadow.velocity,
                acceleration: shadow.acceleration,
                jerk: shadow.jerk,
                snap: shadow.snap,
            });
            assert_eq!(CamBounds::beyond(&most, &limits), None);
            assert!(shadow.velocity <= 0.98 * bounds.highest_velocity(&limits));
        }
    }
}

/// The bits of a cam are the same on every processor: a digest of all results.
#[test]
fn the_bits_are_these() {
    let mut rows = vec![
        row(0.0, 0.0, CamShape::Rest5),
        row(17.3, 11.1, CamShape::Line),
        row(40.1, 13.7, CamShape::Through),
        row(55.0, -3.3, CamShape::Through),
        row(61.7, 4.4, CamShape::Poly7),
        row(80.2, 4.9, CamShape::Poly5),
        row(91.0, 1.0, CamShape::Rest7),
        row(100.0, 0.3, CamShape::Rest7),
    ];
    rows[4].slope = 0.31;
    rows[5].curvature = -0.02;
    let made = made(&rows, true).unwrap();
    let mut digest = Digest::new();
    let law = CamLaw {
        master_scaling: 1.3,
        slave_scaling: -0.9,
        ..law()
    };
    let mut near = 0;
    for step in -5000..5000 {
        let master = Setpoint {
            position: 0.0,
            velocity: 3.1,
            acceleration: -2.0,
            jerk: 0.7,
            snap: 9.0,
        };
        let found = law.at(
            &made.cam(),
            &Anchor::default(),
            place(0, f64::from(step) * 0.1),
            &master,
            near,
        );
        near = found.piece;
        digest.add_setpoint(&found.state);
    }
    for piece in &made.pieces {
        for bound in four(piece.bounds()) {
            digest.add(bound.to_bits());
        }
    }
    assert_eq!(format!("{:016x}", digest.0), "73b50c72e8d9a81f");
}
