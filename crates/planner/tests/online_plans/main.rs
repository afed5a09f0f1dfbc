//! Plans from any moving state to a position: fewest scans, limits kept, targets met.

mod scans;
