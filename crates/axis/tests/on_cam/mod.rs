//! Axes on cams, through the real axes in the real order.

mod engage;
mod random;
mod rig;
mod running;
