//! The interpreter. No code outside this module names it.
//!
//! A host function needs the context of a block, which is borrowed for one scan only, but the
//! interpreter's data live longer. So the scan lends the context to [`crate::tick`], where the functions
//! find it.

use crate::host::{FUNCTIONS, FUNCTIONS_OF_TWO, Host, Import};
use crate::tick::TICK;
use crate::{Fault, LoadError, MODULE_MOST, PAGE, Program, Settings, tick};
use std::fmt;
use wasmi::errors::LinkerError;
use wasmi::{
    Caller, CompilationMode, Config, EnforcedLimits, Engine, Error, ExternType, FuncType, Linker, Memory,
    Store, StoreLimits, StoreLimitsBuilder, TrapCode, TypedFunc, Val, ValType,
};

const SCAN: &str = "a function (i32, i64), called in every execution of the task";
const MEMORY: &str = "the memory in which pins and variables lie";
const NOTHING: &str = "a function without parameters and results";

/// The compiled module.
#[derive(Clone, Debug)]
pub(crate) struct Module(wasmi::Module);

/// A fault that leaves the interpreter.
#[derive(Debug)]
struct Stop(Box<Fault>);

impl fmt::Display for Stop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl wasmi::errors::HostError for Stop {}

#[cold]
fn stop(fault: Box<Fault>) -> Error {
    Error::host(Stop(fault))
}

/// The data that the interpreter keeps for the functions of a guest.
struct Own {
    limits: StoreLimits,
    host: Host,
    /// `None` only while the guest is made, when it cannot call.
    memory: Option<Memory>,
}

/// The guest's memory, and the data of its functions.
#[inline]
fn open<'c>(caller: &'c mut Caller<'_, Own>) -> (&'c mut [u8], &'c mut Host) {
    match caller.data().memory {
        Some(memory) => {
            let (memory, own) = memory.data_and_store_mut(caller);
            (memory, &mut own.host)
        }
        None => (&mut [], &mut caller.data_mut().host),
    }
}

fn signature(import: Import) -> (FuncType, &'static str) {
    match import {
        Import::Log => (
            FuncType::new([ValType::I32; 2], []),
            "a function (i32, i32) without results",
        ),
        Import::LogRead => (
            FuncType::new([ValType::I32; 5], [ValType::I32]),
            "a function (i32, i32, i32, i32, i32) -> i32",
        ),
        Import::Function(_) => (
            FuncType::new([ValType::F64], [ValType::F64]),
            "a function (f64) -> f64",
        ),
        Import::FunctionOfTwo(_) => (
            FuncType::new([ValType::F64; 2], [ValType::F64]),
            "a function (f64, f64) -> f64",
        ),
        Import::Block(_) => (
            FuncType::new([ValType::I32; 3], [ValType::I32]),
            "a function (i32, i32, i32) -> i32",
        ),
    }
}

impl Module {
    /// Checks and compiles a module, in its binary form or as text.
    pub(crate) fn compile(bytes: &[u8], settings: &Settings) -> Result<Self, LoadError> {
        if bytes.len() > MODULE_MOST {
            return Err(LoadError::Large {
                bytes: bytes.len(),
                most: MODULE_MOST,
            });
        }
        if cfg!(not(feature = "wat")) && !bytes.starts_with(b"\0asm") && str::from_utf8(bytes).is_ok() {
            return Err(LoadError::Text);
        }
        let mut config = Config::default();
        config
            // Lazy compilation would use the fuel of the first scan.
            .compilation_mode(CompilationMode::Eager)
            .consume_fuel(true)
            .allow_start_fn(false)
            .ignore_custom_sections(true)
            .wasm_multi_memory(false)
            .wasm_custom_page_sizes(false)
            .enforced_limits(EnforcedLimits::strict());
        let engine = Engine::new(&config);
        let module =
            wasmi::Module::new(&engine, bytes).map_err(|error| LoadError::Module(error.to_string()))?;
        let module = Self(module);
        module.check_imports(settings)?;
        module.check_exports(settings)?;
        Ok(module)
    }

    fn check_imports(&self, settings: &Settings) -> Result<(), LoadError> {
        for wanted in self.0.imports() {
            let known = Import::find(wanted.name()).filter(|_| wanted.module() == settings.module);
            let Some(known) = known else {
                return Err(LoadError::Import {
                    module: wanted.module().to_owned(),
                    name: wanted.name().to_owned(),
                    hint: hint(wanted.module(), settings),
                });
            };
            let (ty, words) = signature(known);
            if !matches!(wanted.ty(), ExternType::Func(found) if *found == ty) {
                return Err(LoadError::Type {
                    name: wanted.name().to_owned(),
                    wanted: words,
                });
            }
        }
        Ok(())
    }

    fn check_exports(&self, settings: &Settings) -> Result<(), LoadError> {
        let scan = FuncType::new([ValType::I32, ValType::I64], []);
        let nothing = FuncType::new([], []);
        for (name, ty, wanted) in [
            ("plc_scan", Some(&scan), SCAN),
            ("plc_init", Some(&nothing), NOTHING),
            ("_initialize", Some(&nothing), NOTHING),
            ("memory", None, MEMORY),
        ] {
            let optional = ["plc_init", "_initialize"].contains(&name);
            match (self.0.get_export(name), ty) {
                (None, _) if optional => {}
                (None, _) => return Err(LoadError::Export { name, wanted }),
                (Some(ExternType::Func(found)), Some(ty)) if found == *ty => {}
                (Some(ExternType::Memory(memory)), None) => {
                    let bytes = memory.minimum().saturating_mul(PAGE);
                    if bytes > settings.memory {
                        return Err(LoadError::Memory {
                            bytes,
                            most: settings.memory,
                        });
                    }
                }
                (Some(_), _) => {
                    return Err(LoadError::Type {
                        name: name.to_owned(),
                        wanted,
                    });
                }
            }
        }
        Ok(())
    }
}

fn hint(module: &str, settings: &Settings) -> String {
    if module.starts_with("wasi") {
        "; a guest has no operating system: build it without a standard library, or without what needs one"
            .to_owned()
    } else if module == settings.module {
        "; `standstill export wasm` lists what does".to_owned()
    } else {
        format!("; imports come from the module `{}`", settings.module)
    }
}

/// An instance of a module.
pub(crate) struct Machine {
    store: Store<Own>,
    instance: wasmi::Instance,
    memory: Memory,
    /// `plc_scan`, then the others that the host requested.
    entries: Vec<TypedFunc<(i32, i64), ()>>,
}

impl fmt::Debug for Machine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Machine").finish_non_exhaustive()
    }
}

/// The values of the exported variables that are not memory.
pub(crate) type Globals = Vec<(String, Number)>;

/// A number of the interpreter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Number {
    I32(i32),
    I64(i64),
    F32(u32),
    F64(u64),
}

impl Machine {
    pub(crate) fn new(program: &Program) -> Result<Self, LoadError> {
        let Module(module) = &program.module;
        let settings = &program.settings;
        let limits = StoreLimitsBuilder::new()
            .memory_size(usize::try_from(settings.memory).unwrap_or(usize::MAX))
            .memories(1)
            .tables(4)
            .table_elements(1 << 16)
            .instances(1)
            .build();
        let wrong = |error: &dyn fmt::Display| LoadError::Module(error.to_string());
        let own = Own {
            limits,
            host: Host::new(settings.first_instance),
            memory: None,
        };
        let mut store = Store::new(module.engine(), own);
        store.limiter(|own| &mut own.limits);
        store.set_fuel(settings.fuel).map_err(|error| wrong(&error))?;
        let instance = link(program)?
            .instantiate_and_start(&mut store, module)
            .map_err(|error| wrong(&error))?;
        let memory = instance.get_memory(&store, "memory").ok_or(LoadError::Export {
            name: "memory",
            wanted: MEMORY,
        })?;
        store.data_mut().memory = Some(memory);
        let scan = instance
            .get_typed_func(&store, "plc_scan")
            .map_err(|error| wrong(&error))?;
        Ok(Self {
            store,
            instance,
            memory,
            entries: vec![scan],
        })
    }

    pub(crate) fn host(&self) -> &Host {
        &self.store.data().host
    }

    pub(crate) fn host_mut(&mut self) -> &mut Host {
        &mut self.store.data_mut().host
    }

    pub(crate) fn memory(&self) -> &[u8] {
        self.memory.data(&self.store)
    }

    pub(crate) fn memory_mut(&mut self) -> &mut [u8] {
        self.memory.data_mut(&mut self.store)
    }

    /// Grows the memory to this size, if it is smaller.
    pub(crate) fn grow_to(&mut self, bytes: usize) {
        let pages = bytes.saturating_sub(self.memory().len()) as u64 / PAGE;
        // If it does not fit, the copy into it is short, which the caller checks.
        let _size = self.memory.grow(&mut self.store, pages);
    }

    /// The value of an exported constant or variable of type i32.
    pub(crate) fn address_of(&self, name: &str) -> Option<u32> {
        let global = self.instance.get_global(&self.store, name)?;
        Some(global.get(&self.store).i32()?.cast_unsigned())
    }

    pub(crate) fn globals(&self) -> Globals {
        let exports = self.instance.exports(&self.store);
        exports
            .filter_map(|export| {
                let name = export.name().to_owned();
                let global = export.into_global()?;
                if !global.ty(&self.store).mutability().is_mut() {
                    return None;
                }
                let number = match global.get(&self.store) {
                    Val::I32(number) => Number::I32(number),
                    Val::I64(number) => Number::I64(number),
                    Val::F32(number) => Number::F32(number.to_bits()),
                    Val::F64(number) => Number::F64(number.to_bits()),
                    _ => return None,
                };
                Some((name, number))
            })
            .collect()
    }

    pub(crate) fn set_globals(&mut self, globals: &Globals) {
        for (name, number) in globals {
            let value = match *number {
                Number::I32(number) => Val::I32(number),
                Number::I64(number) => Val::I64(number),
                Number::F32(bits) => Val::F32(f32::from_bits(bits).into()),
                Number::F64(bits) => Val::F64(f64::from_bits(bits).into()),
            };
            if let Some(global) = self.instance.get_global(&self.store, name) {
                // Of the same module, and so of the same type.
                let _same = global.set(&mut self.store, value);
            }
        }
    }

    /// Calls a function without parameters with a budget of `fuel`, if the guest exports it.
    pub(crate) fn start(&mut self, name: &str, fuel: u64) -> Result<(), Fault> {
        let Some(function) = self.instance.get_func(&self.store, name) else {
            return Ok(());
        };
        let outcome = self.store.set_fuel(fuel);
        outcome
            .and_then(|()| tick::before(|| function.call(&mut self.store, &[], &mut [])))
            .map_err(|error| fault(&error, fuel))
    }

    /// Makes an exported function of the type of `plc_scan` callable; returns its number.
    pub(crate) fn entry(&mut self, name: &str) -> Option<usize> {
        let function = self.instance.get_typed_func(&self.store, name).ok()?;
        self.entries.push(function);
        Some(self.entries.len() - 1)
    }

    /// Calls function number `entry` (`plc_scan` is 0) with a budget of `fuel`. Returns the fuel used.
    #[inline]
    pub(crate) fn scan(
        &mut self,
        entry: usize,
        tick: i32,
        now_ns: i64,
        fuel: u64,
    ) -> Result<u64, Box<Fault>> {
        let Some(function) = self.entries.get(entry) else {
            return Err(Box::new(Fault::Other("there is no such function".to_owned())));
        };
        let mut run = || {
            self.store.set_fuel(fuel)?;
            function.call(&mut self.store, (tick, now_ns))?;
            self.store.get_fuel()
        };
        match run() {
            Ok(left) => Ok(fuel.saturating_sub(left)),
            Err(error) => Err(Box::new(fault(&error, fuel))),
        }
    }
}

macro_rules! blocks {
    ($($group:ident :: $name:ident :: $block:ident)*) => {
        /// Links the functions of the blocks, in the order of the registry: a closure for each, which
        /// calls its block directly.
        const LINK: &[Link] = &[$(|linker, from, name| {
            let function = |mut caller: Caller<'_, Own>, key: u32, inputs: u32, outputs: u32| {
                let (memory, host) = open(&mut caller);
                let answer = TICK.with(|tick| tick.$name(host, memory, key, inputs, outputs));
                answer.map(|code| code as i32).map_err(stop)
            };
            linker.func_wrap(from, name, function)
        }),*];
    };
}

/// All NaNs of a guest are made equal.
fn one_nan(number: f64) -> f64 {
    if number.is_nan() { f64::NAN } else { number }
}

type Link = for<'l> fn(&'l mut Linker<Own>, &str, &str) -> Result<&'l mut Linker<Own>, LinkerError>;

standstill_blocks::for_every_block!(blocks);

/// The functions that a guest may import.
fn link(program: &Program) -> Result<Linker<Own>, LoadError> {
    let Module(module) = &program.module;
    let from = program.settings.module.as_str();
    let mut linker = Linker::new(module.engine());
    let mut linked = Vec::new();
    for wanted in module.imports() {
        let name = wanted.name();
        let Some(import) = Import::find(name).filter(|import| !linked.contains(import)) else {
            continue;
        };
        linked.push(import);
        let outcome = match import {
            Import::Log => linker.func_wrap(
                from,
                name,
                |mut caller: Caller<'_, Own>, text: u32, bytes: u32| -> Result<(), Error> {
                    let (memory, host) = open(&mut caller);
                    host.log(memory, text, bytes)
                        .map_err(|fault| stop(Box::new(fault)))
                },
            ),
            Import::LogRead => linker.func_wrap(
                from,
                name,
                |mut caller: Caller<'_, Own>, next: u32, records: u32, size: u32, room: u32, copied: u32| {
                    let (memory, host) = open(&mut caller);
                    tick::log_read(host, memory, [next, records, size, room, copied])
                        .map(|code| code as i32)
                        .map_err(stop)
                },
            ),
            Import::Function(place) => match FUNCTIONS.get(place) {
                Some((_, function)) => linker.func_wrap(from, name, |x: f64| one_nan(function(x))),
                None => continue,
            },
            Import::FunctionOfTwo(place) => match FUNCTIONS_OF_TWO.get(place) {
                Some((_, function)) => linker.func_wrap(from, name, |x: f64, y: f64| one_nan(function(x, y))),
                None => continue,
            },
            Import::Block(block) => match LINK.get(block) {
                Some(link) => link(&mut linker, from, name),
                None => continue,
            },
        };
        outcome.map_err(|error| LoadError::Module(error.to_string()))?;
    }
    Ok(linker)
}

#[cold]
fn fault(error: &Error, most: u64) -> Fault {
    if let Some(Stop(fault)) = error.downcast_ref() {
        return Fault::clone(fault);
    }
    match error.as_trap_code() {
        Some(TrapCode::OutOfFuel) => Fault::Fuel { most },
        Some(code) => Fault::Trap(code.trap_message()),
        None => Fault::Other(error.to_string()),
    }
}
