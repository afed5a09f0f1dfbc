//! Random bytes as hostile guests: a bounded run of the target in `crates/soak/fuzz`.

use crate::hostile;

use standstill_testkit::Random;

#[test]
fn no_guest_reaches_beyond_its_memory_or_leaves_an_axis_moving() {
    let (mut faults, mut moving, mut done) = (0, 0, 0);
    let cases = standstill_testkit::whole_or(1_200, 96);
    for case in 0..cases {
        let mut random = Random(case);
        let bytes: Vec<u8> = (0..500).flat_map(|_| random.bits().to_le_bytes()).collect();
        let played = hostile::play(&bytes);
        faults += u64::from(played.fault);
        moving += u64::from(played.moving);
        done += u64::from(played.done);
    }
    println!("{faults} faults, {moving} of them in motion, {done} calls");
    assert!((cases / 4..cases * 2 / 3).contains(&faults), "{faults}");
    assert!(moving > cases / 24, "{moving}");
    assert!(done > 80 * cases, "{done}");
}
