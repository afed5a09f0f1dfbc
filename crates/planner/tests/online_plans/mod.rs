//! Plans from any moving state to a position: fewest scans, limits kept, targets reached.

mod blend;
mod chains;
mod directions;
mod ends;
mod last;
mod scans;
mod shape;
mod turn;
use crate::ramp_plans::support;
