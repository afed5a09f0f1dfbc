//! A build without an interpreter: no program can be made, so none runs.

use crate::{Fault, LoadError, Settings, Symbol, SymbolError, Told};
use standstill_axis::Planner;
use standstill_fb::{Context, Value};
use std::convert::Infallible;

/// The program type of this build, without values.
#[derive(Clone, Debug)]
pub struct Program(Infallible);

/// The guest type of this build, without values.
#[derive(Debug)]
pub struct Guest(Infallible);

/// A function of a guest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry(());

impl Entry {
    /// `plc_scan`.
    pub const SCAN: Self = Self(());
}

impl Program {
    /// Refuses every module.
    ///
    /// # Errors
    /// [`LoadError::NotBuilt`].
    pub fn compile(_: &[u8], _: Settings) -> Result<Self, LoadError> {
        Err(LoadError::NotBuilt)
    }

    /// Never called.
    #[must_use]
    pub const fn settings(&self) -> &Settings {
        match self.0 {}
    }

    /// Never called.
    ///
    /// # Errors
    /// None.
    pub fn start(&self) -> Result<Guest, LoadError> {
        match self.0 {}
    }
}

#[allow(clippy::missing_errors_doc)]
impl Guest {
    /// Never called, and neither are the functions below.
    pub fn scan<P: Planner>(&mut self, _: &mut Context<'_, P>) -> Result<u64, Fault> {
        match self.0 {}
    }

    /// No function.
    pub fn entry(&mut self, _: &str) -> Option<Entry> {
        match self.0 {}
    }

    /// Never called.
    pub fn scan_entry<P: Planner>(&mut self, _: Entry, _: &mut Context<'_, P>) -> Result<u64, Fault> {
        match self.0 {}
    }

    /// Never called.
    pub fn evaluate(&mut self, _: Entry, _: u64, _: i64) -> Result<(), Fault> {
        match self.0 {}
    }

    /// No number.
    #[must_use]
    pub fn bits(&self, _: u32, _: usize) -> Option<u64> {
        match self.0 {}
    }

    /// No text.
    pub fn take_told(&mut self) -> Vec<Told> {
        match self.0 {}
    }

    /// No address.
    pub fn address_of(&self, _: &str) -> Result<u32, SymbolError> {
        match self.0 {}
    }

    /// No value.
    pub fn read(&self, _: &Symbol) -> Result<Value, SymbolError> {
        match self.0 {}
    }

    /// Nothing is written.
    pub fn write(&mut self, _: &Symbol, _: Value) -> Result<(), SymbolError> {
        match self.0 {}
    }
}
