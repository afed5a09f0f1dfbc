//! Slaves in gear, through the real axes in the real order: how soon a slave is on its law, and random programs
//! checked by independent arithmetic.

mod alone;
mod exact;
mod judge;
mod lock_times;
mod random;
mod rig;
