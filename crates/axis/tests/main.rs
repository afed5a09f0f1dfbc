//! The tests of this crate, in one program: linking one costs more than running most of them.

mod blending;
mod chains;
mod chains_least;
mod changing;
mod coordinates;
mod coupled;
mod differences;
mod directions;
mod double;
mod draw;
mod followed;
mod guard;
mod least_scans;
mod measured;
mod on_cam;
mod outlook;
mod shaped;
mod slow_master;
mod standing;
mod superimposed;
mod superimposed_behind;
mod superimposed_least;
mod take_over;
mod turns;
mod values;
