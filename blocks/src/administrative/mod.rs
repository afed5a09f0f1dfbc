//! Blocks that switch, reset and read; they move nothing.

mod cams;
pub mod mc_abort_trigger;
pub mod mc_digital_cam_switch;
pub mod mc_power;
pub mod mc_read_actual_position;
pub mod mc_read_actual_torque;
pub mod mc_read_actual_velocity;
pub mod mc_read_axis_error;
pub mod mc_read_axis_info;
pub mod mc_read_bool_parameter;
pub mod mc_read_digital_input;
pub mod mc_read_digital_output;
pub mod mc_read_motion_state;
pub mod mc_read_parameter;
pub mod mc_read_status;
pub mod mc_reset;
pub mod mc_set_override;
pub mod mc_set_position;
pub mod mc_touch_probe;
pub mod mc_write_bool_parameter;
pub mod mc_write_digital_output;
pub mod mc_write_parameter;
