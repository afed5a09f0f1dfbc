//! The CiA 402 drive profile: words, sequencer, adapter, and a simulated node.

mod adapter;
mod motor;
mod node;
mod sequencer;
mod simulated;
mod state;
mod words;

pub use adapter::Adapter;
pub use node::{Inputs, MODE_CSP, Node, Outputs};
pub use sequencer::{Memory, controlword};
pub use simulated::{Cia402Drive, Reaction, Settings, SimulatedNode};
pub use state::{TRANSITIONS, Transition, command_transition};
pub use words::{Command, State, Statusword};
