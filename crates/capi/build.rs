//! Checks the prefix of all symbols, and hands it to the compiler.

fn main() {
    println!("cargo::rerun-if-env-changed=STANDSTILL_PREFIX");
    println!("cargo::rerun-if-changed=build.rs");
    let prefix = std::env::var("STANDSTILL_PREFIX").unwrap_or_else(|_| "standstill".to_owned());
    let mut letters = prefix.chars();
    let first = letters
        .next()
        .is_some_and(|letter| letter.is_ascii_lowercase() || letter == '_');
    let rest = letters.all(|letter| letter.is_ascii_lowercase() || letter.is_ascii_digit() || letter == '_');
    assert!(
        first && rest && prefix.len() <= 32,
        "STANDSTILL_PREFIX is `{prefix}`: give a C identifier of at most 32 lower-case letters, digits and underscores"
    );
    println!("cargo::rustc-env=STANDSTILL_SYMBOLS={prefix}");
}
