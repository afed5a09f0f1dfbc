//! The memory of the image: that of qemu's machine `mps2-an386`.

use std::path::Path;
use std::{env, fs};

const MEMORY: &str = "MEMORY {
  FLASH : ORIGIN = 0x00000000, LENGTH = 4M
  RAM : ORIGIN = 0x20000000, LENGTH = 4M
}
";

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if env::var("CARGO_CFG_TARGET_OS").is_ok_and(|os| os == "none") {
        let out = env::var("OUT_DIR").expect("Cargo names a folder");
        fs::write(Path::new(&out).join("memory.x"), MEMORY).expect("the folder can be written to");
        println!("cargo::rustc-link-search={out}");
        // The linker script of cortex-m-rt, which reads memory.x.
        println!("cargo::rustc-link-arg-examples=-Tlink.x");
    }
}
