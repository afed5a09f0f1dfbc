//! A gear of 3/7 between two axes with turns of 360, scan after scan: every place of the slave against integers.
//!
//! The master moves 1.8 in a scan, so a turn takes 200 scans. 200,000 scans in a plain run, 10^7 in `.ci/run`, more
//! with `STANDSTILL_SOAK=1000000000`.

use standstill_planner::{Anchor, Gear, Place};

const TURN: f64 = 360.0;
const SCANS_OF_A_TURN: u64 = 200;
const NUMERATOR: u128 = 3;
const DENOMINATOR: u128 = 7;

/// All positions here are whole numbers of 2^-60.
const UNIT: f64 = (1_u64 << 60) as f64;

fn units(position: f64) -> u128 {
    let units = (position * UNIT) as u128;
    assert_eq!(units as f64 / UNIT, position, "a position finer than 2^-60");
    units
}

/// `up` / `down` rounded once, to the nearest number and of two to the even one.
fn rounded(up: u128, down: u128) -> f64 {
    if up == 0 {
        return 0.0;
    }
    let shift = up.leading_zeros();
    let (quotient, rest) = ((up << shift) / down, (up << shift) % down);
    // The quotient has more bits than an f64, and its last bit says whether anything is left.
    assert!(quotient >> 55 > 0);
    (quotient | u128::from(rest > 0)) as f64 / (1_u128 << shift) as f64
}

/// The exact place of the slave: its whole turns, and the rest rounded once.
fn exact(anchor: &Anchor, turns: i64, position: f64) -> (i64, f64) {
    let turn = units(TURN);
    let way = turns as u128 * turn + units(position) - units(anchor.master.position);
    let place = DENOMINATOR * units(anchor.slave.position) + NUMERATOR * way;
    let whole = place / (DENOMINATOR * turn);
    let rest = rounded(place % (DENOMINATOR * turn), DENOMINATOR) / UNIT;
    if rest == TURN {
        (whole as i64 + 1, 0.0)
    } else {
        (whole as i64, rest)
    }
}

/// Covers: G31, GS16
#[test]
fn every_scan_at_three_sevenths_is_the_exact_place_rounded_once() {
    let scans = standstill_testkit::soak(standstill_testkit::cases(10_000_000));
    let gear = Gear::new(3, 7, Some(TURN), Some(TURN)).unwrap();
    let at = |position| Place {
        position,
        ..Place::default()
    };
    let (mut anchors, mut masters) = (Vec::new(), Vec::new());
    for (master, slave) in [(0.0, 0.0), (0.1, 0.2)] {
        anchors.push(Anchor {
            master: at(master),
            slave: at(slave),
            ..Anchor::default()
        });
        // The places of the master in the scans of a turn: they repeat in every turn.
        masters.push(
            (0..SCANS_OF_A_TURN)
                .map(|scan| (master + 1.8 * scan as f64) % TURN)
                .collect::<Vec<f64>>(),
        );
    }
    for scan in 0..scans {
        // The two anchors alternate from one cycle of 7 turns to the next.
        let which = (scan / (7 * SCANS_OF_A_TURN) % 2) as usize;
        let (anchor, master) = (&anchors[which], &masters[which]);
        let position = master[(scan % SCANS_OF_A_TURN) as usize];
        let turns = (scan / SCANS_OF_A_TURN) as i64;
        let found = gear.slave(
            anchor,
            Place {
                turns,
                ..at(position)
            },
        );
        let expected = exact(anchor, turns, position);
        assert_eq!(
            (found.turns, found.position.to_bits()),
            (expected.0, expected.1.to_bits()),
            "scan {scan}: {found:?}, exact {expected:?}"
        );
        if scan % (7 * SCANS_OF_A_TURN) == 0 {
            assert_eq!(
                found.position.to_bits(),
                anchor.slave.position.to_bits(),
                "scan {scan}"
            );
        }
    }
    println!("{scans} scans at 3/7");
}
