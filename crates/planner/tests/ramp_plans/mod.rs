//! Ramps of every order, from every kind of start state, judged from outside.

mod apart;
mod chains;
mod changes;
mod excess;
mod shape;
pub mod support;
mod turns;
