//! The standard function blocks of IEC 61131-3, exact to the call.

pub mod r_trig;
