//! Times the function `run` without a browser: a request on standard input, the number of runs as the
//! argument; a line with milliseconds for each. `crates/playground/browser/measure.mjs` compares the
//! times of the page with these.

use std::io::Read;
use std::time::Instant;

fn main() {
    let turns = std::env::args()
        .nth(1)
        .and_then(|turns| turns.parse().ok())
        .unwrap_or(15);
    let mut request = String::new();
    std::io::stdin()
        .lock()
        .read_to_string(&mut request)
        .expect("a request in UTF-8");
    for _ in 0..turns {
        let begin = Instant::now();
        let ran = standstill_playground::run(&request, |_, _| true);
        let took = begin.elapsed().as_secs_f64() * 1e3;
        assert!(ran.about.contains("\"verdict\""), "{}", ran.about);
        println!("{took}");
    }
}
