//! Random bytes as hostile guests: a bounded run of the target in `crates/soak/fuzz`.

use crate::hostile;

use standstill_testkit::Random;

#[test]
fn no_guest_reaches_beyond_its_memory_or_leaves_an_axis_moving() {
    let (mut faults, mut moving, mut done) = (0, 0, 0);
    for case in 0..1_200_u64 {
        let mut random = Random(case);
        let bytes: Vec<u8> = (0..500).flat_map(|_| random.bits().to_le_bytes()).collect();
        let played = hostile::play(&bytes);
        faults += u32::from(played.fault);
        moving += u32::from(played.moving);
        done += played.done;
    }
    println!("{faults} faults, {moving} of them in motion, {done} calls");
    assert!((300..800).contains(&faults), "{faults}");
    assert!(moving > 50, "{moving}");
    assert!(done > 100_000, "{done}");
}
