//! The bare-metal image. On a host it only runs a few scans.
#![cfg_attr(target_os = "none", no_std)]
#![cfg_attr(target_os = "none", no_main)]

#[cfg(target_os = "none")]
mod bare_metal {
    //! The entry and the panic handler: the two symbols the linker needs to know by name.
    #![allow(unsafe_code)]

    use standstill_panic_probe::{Image, plan};

    // SAFETY: nothing else in the image has this name, and no linker script or start-up code calls it
    // with another signature: the image is linked and examined, never run.
    #[unsafe(no_mangle)]
    extern "C" fn _start() -> ! {
        let mut image = Image::new();
        loop {
            plan();
            if let Some(image) = &mut image {
                image.scan();
            }
            #[cfg(feature = "reachable-panic")]
            assert!(core::hint::black_box(true), "on purpose");
        }
    }

    unsafe extern "C" {
        /// It does not exist: the link fails if anything calls it.
        fn a_panic_is_reachable() -> !;
    }

    #[panic_handler]
    fn panic(_: &core::panic::PanicInfo) -> ! {
        // SAFETY: never called; an image in which it could be called is not linked.
        unsafe { a_panic_is_reachable() }
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    let mut image = standstill_panic_probe::Image::new();
    for _ in 0..1000 {
        standstill_panic_probe::plan();
        if let Some(image) = &mut image {
            image.scan();
        }
    }
}
