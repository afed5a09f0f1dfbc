//! Random bytes as hostile guests: a bounded run of what `crates/soak/fuzz` does for as long as one likes.

mod hostile;

/// splitmix64 (Steele, Lea, Flood 2014).
fn random(seed: &mut u64) -> u64 {
    *seed = seed.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let mixed = (*seed ^ (*seed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    mixed ^ (mixed >> 31)
}

#[test]
fn no_guest_reaches_beyond_its_memory_or_leaves_an_axis_moving() {
    let (mut faults, mut moving, mut done) = (0, 0, 0);
    for case in 0..1_000_u64 {
        let mut seed = case;
        let bytes: Vec<u8> = (0..500).flat_map(|_| random(&mut seed).to_le_bytes()).collect();
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
