//! The CiA 402 drive profile: words, sequencer, adapter, and a simulated node.

mod adapter;
mod homing;
mod motor;
mod node;
mod probe;
mod sequencer;
mod simulated;
mod state;
mod torque;
mod words;

pub use adapter::Adapter;
pub use homing::NodeHoming;
pub use motor::MotorLoad;
pub use node::{Inputs, MODE_CSP, MODE_CST, MODE_CSV, MODE_HM, Node, Outputs};
pub use probe::{ProbeFunction, ProbeStatus};
pub use sequencer::{Memory, controlword};
pub use simulated::{Cia402Drive, Reaction, Settings, SimulatedNode};
pub use state::{TRANSITIONS, Transition, command_transition};
pub use torque::TorqueScale;
pub use words::{Command, HomingStatus, State, Statusword};
