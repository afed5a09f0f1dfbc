//! Axes on cams, through the real axes in the real order.

mod engage;
#[path = "../followed/mod.rs"]
mod followed;
mod random;
mod rig;
mod running;
