//! The tests of this crate, in one program: linking one costs more than running most of them.

mod arithmetic;
mod common;
mod damage;
mod dialects;
mod editor;
mod foreign;
mod layout;
mod lints;
mod methods;
mod mistakes;
mod programs;
mod random;
mod strings;
mod supported;
