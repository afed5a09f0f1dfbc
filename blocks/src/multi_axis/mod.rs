//! Blocks that couple axes.

pub mod mc_cam_in;
pub mod mc_cam_out;
pub mod mc_cam_table_select;
pub mod mc_combine_axes;
pub mod mc_gear_in;
pub mod mc_gear_in_pos;
pub mod mc_gear_out;
pub mod mc_phasing_absolute;
pub mod mc_phasing_relative;
