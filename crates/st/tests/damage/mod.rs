//! Random damage to programs: bytes are changed, lost, doubled and moved. It is the same on every machine.
//! libFuzzer runs the same code ([contributing](../../../../docs/contributing.md#fuzzing)).
//! `STANDSTILL_ST_DAMAGE=10000000` runs that many, `STANDSTILL_ST_SEED` others.

mod play;

use standstill_testkit::{Random, cases, given};
use std::fs;
use std::path::Path;

/// Programs of the repository, in the order of their names.
fn programs() -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scan-tests/structured_text");
    let mut paths = Vec::new();
    for place in [folder.clone(), folder.join("idioms")] {
        let entries = fs::read_dir(place).unwrap().flatten();
        paths.extend(entries.map(|entry| entry.path()));
    }
    paths.retain(|path| path.extension().is_some_and(|it| it == "st"));
    paths.sort();
    paths.iter().map(|path| fs::read(path).unwrap()).collect()
}

fn is_valid(module: &[u8]) {
    standstill_testkit::peers::module(module).expect("a valid module");
}

fn damaged(random: &mut Random, programs: &[Vec<u8>]) -> Vec<u8> {
    let mut text = programs[random.place(programs.len())].clone();
    for _ in 0..=random.place(5) {
        let at = random.place(text.len());
        let to = (at + random.place(40)).min(text.len());
        match random.place(6) {
            0 if at < text.len() => text[at] = random.place(256) as u8,
            1 => drop(text.drain(at..to)),
            2 => {
                let piece = text[at..to].to_vec();
                let place = random.place(text.len());
                text.splice(place..place, piece);
            }
            3 => {
                let other = &programs[random.place(programs.len())];
                let from = random.place(other.len());
                let piece = other[from..(from + random.place(200)).min(other.len())].to_vec();
                text.splice(at..at, piece);
            }
            4 => text.truncate(at),
            _ => {
                let signs = b"()[]{};:='$#.,*/-%\n\"\xc3\xbc\0";
                text.insert(at, signs[random.place(signs.len())]);
            }
        }
    }
    text
}

/// Covers: ST5
#[test]
fn no_damage_to_a_program_leads_to_a_panic() {
    let programs = programs();
    assert!(programs.len() > 10);
    programs.iter().for_each(|program| play::play(program, is_valid));
    let first = given("STANDSTILL_ST_SEED", 0);
    for seed in first..first + given("STANDSTILL_ST_DAMAGE", cases(3000)) {
        // In a longer run this line shows the progress.
        if seed % 100_000 == 99_999 {
            eprintln!("{} done", seed + 1 - first);
        }
        let text = damaged(&mut Random(seed), &programs);
        let shown = String::from_utf8_lossy(&text).into_owned();
        let result = std::panic::catch_unwind(|| play::play(&text, is_valid));
        assert!(result.is_ok(), "seed {seed}\n{shown}");
    }
}
