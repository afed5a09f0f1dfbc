//! Blocks that move one axis.

pub mod mc_acceleration_profile;
pub mod mc_halt;
pub mod mc_halt_superimposed;
pub mod mc_jog;
pub mod mc_move_absolute;
pub mod mc_move_additive;
pub mod mc_move_continuous_absolute;
pub mod mc_move_continuous_relative;
pub mod mc_move_relative;
pub mod mc_move_superimposed;
pub mod mc_move_velocity;
pub mod mc_position_profile;
pub mod mc_stop;
pub mod mc_torque_control;
pub mod mc_velocity_profile;
mod profile;
