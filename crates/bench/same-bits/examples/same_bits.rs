//! Prints the digest of the random programs: the same line on every processor.
#![cfg_attr(target_os = "none", no_std)]
#![cfg_attr(target_os = "none", no_main)]

#[cfg(not(target_os = "none"))]
fn main() {
    println!("{}", standstill_same_bits::play());
}

#[cfg(target_os = "none")]
mod bare_metal {
    #[cortex_m_rt::entry]
    fn main() -> ! {
        semihosting::println!("{}", standstill_same_bits::play());
        semihosting::process::exit(0)
    }

    #[panic_handler]
    fn panic(info: &core::panic::PanicInfo) -> ! {
        semihosting::println!("{info}");
        semihosting::process::exit(1)
    }
}
