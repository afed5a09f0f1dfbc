//! A guest, from its bytes to its scans.

use crate::engine::{Globals, Machine, Module};
use crate::host::Host;
use crate::symbol::SymbolError;
use crate::{Fault, LoadError, Settings, Symbol, Told, tick};
use standstill_axis::Planner;
use standstill_fb::{Context, Value};

/// A module that has been checked and compiled.
#[derive(Clone, Debug)]
pub struct Program {
    pub(crate) module: Module,
    pub(crate) settings: Settings,
}

/// A function of one guest that executes a scan, see [`Guest::entry`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry(usize);

impl Entry {
    /// `plc_scan`.
    pub const SCAN: Self = Self(0);
}

/// A guest between two scans.
#[derive(Debug)]
pub struct Guest {
    program: Program,
    machine: Machine,
    fuel_used: u64,
    faulted: bool,
}

/// The state of a guest between two scans: its memory, its block instances, and its exported variables.
///
/// WebAssembly variables (globals) that are not exported are not included. Compilers keep the stack
/// pointer there, which between scans has its initial value.
#[derive(Clone, Debug)]
pub struct Snapshot {
    memory: Vec<u8>,
    globals: Globals,
    host: Host,
    fuel_used: u64,
    faulted: bool,
}

impl Program {
    /// Checks and compiles a module, in its binary form or as text. Cost: proportional to the bytes.
    ///
    /// # Errors
    /// [`LoadError`]: the fault.
    pub fn compile(bytes: &[u8], settings: Settings) -> Result<Self, LoadError> {
        Ok(Self {
            module: Module::compile(bytes, &settings)?,
            settings,
        })
    }

    /// The limits of its guests.
    #[must_use]
    pub const fn settings(&self) -> &Settings {
        &self.settings
    }

    /// A guest before its first scan: its `_initialize` and then its `plc_init` have run, in which blocks answer
    /// [`Code::NotInTick`](crate::Code::NotInTick).
    ///
    /// # Errors
    /// [`LoadError`]: not enough memory, or a fault in these two.
    pub fn start(&self) -> Result<Guest, LoadError> {
        let mut guest = self.raw()?;
        for name in ["_initialize", "plc_init"] {
            guest
                .machine
                .start(name, self.settings.fuel)
                .map_err(|fault| LoadError::Init { name, fault })?;
        }
        Ok(guest)
    }

    /// A guest of this program in the state of a snapshot; it continues from there.
    ///
    /// # Errors
    /// [`LoadError`]: there is not enough memory.
    pub fn restore(&self, snapshot: &Snapshot) -> Result<Guest, LoadError> {
        let mut guest = self.raw()?;
        guest.machine.grow_to(snapshot.memory.len());
        let memory = guest.machine.memory_mut();
        if memory.len() != snapshot.memory.len() {
            return Err(LoadError::Memory {
                bytes: snapshot.memory.len() as u64,
                most: self.settings.memory,
            });
        }
        memory.copy_from_slice(&snapshot.memory);
        guest.machine.set_globals(&snapshot.globals);
        guest.machine.host_mut().clone_from(&snapshot.host);
        guest.fuel_used = snapshot.fuel_used;
        guest.faulted = snapshot.faulted;
        Ok(guest)
    }

    fn raw(&self) -> Result<Guest, LoadError> {
        Ok(Guest {
            machine: Machine::new(self)?,
            program: self.clone(),
            fuel_used: 0,
            faulted: false,
        })
    }
}

impl Guest {
    /// One execution: `plc_scan` with the number and the instant of the scan. Cost: at most the fuel.
    ///
    /// # Errors
    /// [`Fault`]. Commands that it gave to axes before remain; the caller stops the resource.
    pub fn scan<P: Planner>(&mut self, context: &mut Context<'_, P>) -> Result<u64, Fault> {
        self.scan_entry(Entry::SCAN, context)
    }

    /// A function that the guest exports beside `plc_scan`, of the same type; `None` if there is none.
    pub fn entry(&mut self, name: &str) -> Option<Entry> {
        self.machine.entry(name).map(Entry)
    }

    /// The same as [`Guest::scan`], by another function.
    ///
    /// # Errors
    /// Those of [`Guest::scan`].
    pub fn scan_entry<P: Planner>(
        &mut self,
        entry: Entry,
        context: &mut Context<'_, P>,
    ) -> Result<u64, Fault> {
        if self.faulted {
            return Err(Fault::Over);
        }
        let fuel = self.program.settings.fuel;
        match tick::scan(&mut self.machine, entry.0, context, fuel) {
            Ok(used) => {
                self.fuel_used = used;
                Ok(used)
            }
            Err(fault) => {
                self.faulted = true;
                Err(*fault)
            }
        }
    }

    /// One execution outside a scan, in which blocks answer [`Code::NotInTick`](crate::Code::NotInTick): for a function that only
    /// computes. Cost: at most the fuel.
    ///
    /// # Errors
    /// [`Fault`]. It may be called again.
    pub fn evaluate(&mut self, entry: Entry, scan: u64, now_ns: i64) -> Result<(), Fault> {
        let (machine, fuel) = (&mut self.machine, self.program.settings.fuel);
        // A tick is the number of the scan, in 32 bits.
        let outcome = tick::before(|| machine.scan(entry.0, scan as i32, now_ns, fuel));
        outcome.map(|_fuel| ()).map_err(|fault| *fault)
    }

    /// The number in this many bytes, 8 at most, at an address, least significant first; `None` outside
    /// the memory.
    #[must_use]
    pub fn bits(&self, address: u32, bytes: usize) -> Option<u64> {
        let place = self.machine.memory().get(address as usize..)?.get(..bytes)?;
        let fold = |bits: u64, byte: &u8| bits << 8 | u64::from(*byte);
        Some(place.iter().rev().fold(0, fold))
    }

    /// The fuel that the last scan used.
    #[must_use]
    pub const fn fuel_used(&self) -> u64 {
        self.fuel_used
    }

    /// Its texts and events since the last call of this function.
    pub fn take_told(&mut self) -> Vec<Told> {
        self.machine.host_mut().take_told()
    }

    /// The address of a variable that the guest exports.
    ///
    /// # Errors
    /// [`SymbolError::Unknown`].
    pub fn address_of(&self, name: &str) -> Result<u32, SymbolError> {
        let address = self.machine.address_of(name);
        address.ok_or_else(|| SymbolError::Unknown(name.to_owned()))
    }

    /// The value of a variable.
    ///
    /// # Errors
    /// [`SymbolError::Outside`].
    pub fn read(&self, symbol: &Symbol) -> Result<Value, SymbolError> {
        symbol.read(self.machine.memory())
    }

    /// Writes a variable; `value` is of the type of its signal
    /// ([`SymbolType::signal`](crate::SymbolType::signal)). A value that the variable cannot have becomes
    /// the nearest one.
    ///
    /// # Errors
    /// [`SymbolError::Outside`], [`SymbolError::Type`].
    pub fn write(&mut self, symbol: &Symbol, value: Value) -> Result<(), SymbolError> {
        symbol.write(self.machine.memory_mut(), value)
    }

    /// The present state of the guest, for [`Program::restore`].
    #[must_use]
    pub fn snapshot(&self) -> Snapshot {
        Snapshot {
            memory: self.machine.memory().to_vec(),
            globals: self.machine.globals(),
            host: self.machine.host().clone(),
            fuel_used: self.fuel_used,
            faulted: self.faulted,
        }
    }
}
