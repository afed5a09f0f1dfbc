//! Coordinates of axes: turns of modulo axes, and places that change their names.

mod modulo_moves;
mod rig;
mod set_position;
