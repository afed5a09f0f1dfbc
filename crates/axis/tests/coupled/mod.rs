//! Axes behind masters, through the real axes in the real order: how soon a slave is on its law, and random programs judged by
//! arithmetic of their own.

mod alone;
mod exact;
mod judge;
mod lock_times;
mod random;
mod rig;
