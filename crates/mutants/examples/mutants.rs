//! `bash .ci/mutants`.

fn main() -> Result<(), Box<dyn std::error::Error>> {
    standstill_mutants::run()
}
