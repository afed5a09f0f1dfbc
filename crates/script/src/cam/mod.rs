//! Cams outside of a run: tables from files, the checks of axes, and rows of the usual laws.
//!
//! | file | subject |
//! | --- | --- |
//! | `table` | the rows of a cam, from a CSV file or a script |
//! | `curve` | the cam that the runtime makes of them, and its derivatives anywhere |
//! | `fit` | whether a slave can follow it, and how fast its master may be |
//! | `law` | rows for laws with sines, which the runtime does not compute |

mod curve;
mod fit;
mod law;
mod table;

pub use curve::Curve;
pub use fit::{Asked, Finding, Fit, Limiting, Stretch, fit};
pub use law::{Law, Lift, csv};
pub use standstill_axis::CamBounds;
pub use table::{CamError, CamTable};
