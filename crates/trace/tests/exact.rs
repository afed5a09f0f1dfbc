//! The companion of a golden must hold every bit, be the same for the same trace, be small, and detect
//! damage.

use crate::common;

use standstill_trace::exact::{ExactError, decode, decode_within, digest_of, encode};
use standstill_trace::{Trace, digest, subjects};

#[test]
fn every_bit_comes_back_and_the_file_is_small() {
    let trace = common::run(2000, None);
    let file = encode(&trace);
    println!(
        "{} columns, {} scans: {} bytes",
        trace.columns().len(),
        trace.scans(),
        file.len()
    );
    assert!(file.len() < 40_000, "{} bytes", file.len());
    let together = subjects::together(&subjects::subjects(&trace));
    assert_eq!(digest_of(&file), Ok(together));
    let back = decode(&file).expect("our own file");
    assert_eq!(digest::whole(&back), digest::whole(&trace));
    assert_eq!(back.columns(), trace.columns());
    assert_eq!(back.header().cycle_ns, trace.header().cycle_ns);
    assert_eq!(encode(&back), file, "the file depends on the rows alone");
}

/// Goldens of version 1 are judged by what is in their companions.
#[test]
fn a_companion_of_version_1_is_read_and_its_digest_is_that_of_all_rows() {
    let trace = common::run(300, None);
    let file = |digest: u64| {
        let mut file = b"standstill exact 1\n".to_vec();
        file.extend(digest.to_le_bytes());
        file.extend(&encode(&trace)[file.len()..]);
        file
    };
    let digest = digest::whole(&trace);
    let back = decode(&file(digest)).expect("version 1");
    assert_eq!((back.columns(), digest::whole(&back)), (trace.columns(), digest));
    assert_eq!(decode(&file(digest ^ 1)).err(), Some(ExactError::Damaged));
    let together = subjects::together(&subjects::subjects(&trace));
    assert_eq!(decode(&file(together)).err(), Some(ExactError::Damaged));
}

#[test]
fn damage_is_noticed_wherever_it_is() {
    let file = encode(&common::run(30, None));
    for at in 0..file.len() {
        let mut bad = file.clone();
        bad[at] ^= 0x10;
        // Deflate leaves a few bits unused before its check sum; those may be anything.
        assert!(
            decode(&bad).map_or(true, |trace| encode(&trace) == file),
            "byte {at}"
        );
        assert!(decode(&file[..at]).is_err(), "cut at {at}");
    }
    assert_eq!(decode(b"PK").err(), Some(ExactError::Foreign));
    assert_eq!(decode(&file[..24]).err(), Some(ExactError::Damaged));
}

#[test]
fn an_empty_trace_and_a_hard_one_come_back() {
    let empty = Trace::new(common::header());
    assert_eq!(decode(&encode(&empty)).map(|trace| trace.scans()), Ok(0));
    let hard = common::hard_values();
    let back = decode(&encode(&hard)).expect("our own file");
    assert_eq!(digest::whole(&back), digest::whole(&hard));
    for scan in 0..hard.scans() {
        let texts = |trace: &Trace| {
            trace
                .row(scan)
                .map(|cell| format!("{cell:?}"))
                .collect::<Vec<_>>()
        };
        assert_eq!(texts(&back), texts(&hard), "scan {scan}");
    }
}

/// A companion of one column of BOOL and `rows` rows, with these bytes for its cells.
fn made(rows: u64, cells: &[u8]) -> Vec<u8> {
    let mut body = Vec::new();
    let mut put = |mut number: u64| {
        while number >= 0x80 {
            body.push((number & 0x7f) as u8 | 0x80);
            number >>= 7;
        }
        body.push(number as u8);
    };
    for number in [1_000_000, rows, 1, 1] {
        put(number);
    }
    // `a`, an input variable; no names.
    body.extend(*b"a\x00\x02\x00\x00");
    body.extend(cells);
    let mut file = b"standstill exact 1\n".to_vec();
    file.extend(0_u64.to_le_bytes());
    file.extend(miniz_oxide::deflate::compress_to_vec_zlib(&body, 9));
    file
}

#[test]
fn what_a_file_says_takes_no_memory_and_what_it_unpacks_to_is_bounded() {
    let too_large = |file: &[u8]| matches!(decode(file), Err(ExactError::TooLarge { .. }));
    // It states this number of rows, whatever it contains.
    assert!(too_large(&made(50_000_000, &[])));
    assert_eq!(
        decode(&made(u64::MAX, &[])).err(),
        Some(ExactError::TooLarge { most: 1 << 22 })
    );
    assert_eq!(decode(&made(1_000_000, &[])).err(), Some(ExactError::Damaged));
    // It contains them, packed to a thousandth.
    let zeros = vec![0; 20_000_000];
    let file = made(zeros.len() as u64, &zeros);
    assert!(file.len() < 25_000 && too_large(&file), "{} bytes", file.len());
    // It states few and contains many.
    assert!(decode(&made(3, &zeros)).is_err());
    // A golden is bounded by its run.
    let trace = common::run(2000, None);
    let (file, cells) = (encode(&trace), trace.scans() * trace.columns().len());
    assert!(decode_within(&file, cells).is_ok());
    assert_eq!(
        decode_within(&file, cells - 1).err(),
        Some(ExactError::TooLarge { most: cells - 1 })
    );
}
