//! Coordinates of axes: turns of modulo axes, and shifts.

mod modulo_moves;
mod rig;
mod set_position;
