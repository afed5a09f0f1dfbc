//! The interpreter. Nothing outside this module names it.
//!
//! A host function needs what a block may touch, which is borrowed for one call only, and what the interpreter holds
//! lives longer. So every import suspends the guest: the call comes out of the interpreter, is done here, and the guest
//! is resumed with its result.

use crate::host::Import;
use crate::{Fault, LoadError, MODULE_MOST, PAGE, Program, Settings};
use std::fmt;
use wasmi::{
    CompilationMode, Config, EnforcedLimits, Engine, Error, ExternType, FuncType, Linker, Memory,
    ResumableCall, Store, StoreLimits, StoreLimitsBuilder, TrapCode, Val, ValType,
};

const SCAN: &str = "a function (i32, i64), called in every execution of the task";
const MEMORY: &str = "the memory in which pins and variables lie";
const NOTHING: &str = "a function without parameters and results";

/// What was compiled.
#[derive(Clone, Debug)]
pub(crate) struct Module(wasmi::Module);

/// A call that came out of the guest.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Call {
    pub(crate) import: Import,
    pub(crate) arguments: [u32; 3],
}

impl fmt::Display for Call {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a block is called, which is possible in plc_init and plc_scan only")
    }
}

impl wasmi::errors::HostError for Call {}

fn signature(import: Import) -> (FuncType, &'static str) {
    match import {
        Import::Log => (
            FuncType::new([ValType::I32; 2], []),
            "a function (i32, i32) without results",
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
        let mut config = Config::default();
        config
            // Lazy compilation would take the fuel of the first scan.
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
    store: Store<StoreLimits>,
    instance: wasmi::Instance,
    memory: Memory,
}

impl fmt::Debug for Machine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Machine").finish_non_exhaustive()
    }
}

/// What stands in the exported variables that are no memory.
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
        let mut store = Store::new(module.engine(), limits);
        store.limiter(|limits| limits);
        store.set_fuel(settings.fuel).map_err(|error| wrong(&error))?;
        let mut linker = Linker::new(module.engine());
        let mut linked = Vec::new();
        for wanted in module.imports() {
            let Some(import) = Import::find(wanted.name()) else {
                continue;
            };
            if linked.contains(&import) {
                continue;
            }
            linked.push(import);
            let suspend = move |_: wasmi::Caller<'_, StoreLimits>, given: &[Val], _: &mut [Val]| {
                let mut call = Call {
                    import,
                    ..Call::default()
                };
                for (place, value) in call.arguments.iter_mut().zip(given) {
                    *place = value.i32().unwrap_or_default().cast_unsigned();
                }
                Err(Error::host(call))
            };
            linker
                .func_new(&settings.module, wanted.name(), signature(import).0, suspend)
                .map_err(|error| wrong(&error))?;
        }
        let instance = linker
            .instantiate_and_start(&mut store, module)
            .map_err(|error| wrong(&error))?;
        let memory = instance.get_memory(&store, "memory").ok_or(LoadError::Export {
            name: "memory",
            wanted: MEMORY,
        })?;
        Ok(Self {
            store,
            instance,
            memory,
        })
    }

    pub(crate) fn memory(&self) -> &[u8] {
        self.memory.data(&self.store)
    }

    pub(crate) fn memory_mut(&mut self) -> &mut [u8] {
        self.memory.data_mut(&mut self.store)
    }

    /// Makes the memory this large, if it is smaller.
    pub(crate) fn grow_to(&mut self, bytes: usize) {
        let pages = bytes.saturating_sub(self.memory().len()) as u64 / PAGE;
        // Where it does not fit the copy into it is short, which the caller looks at.
        let _size = self.memory.grow(&mut self.store, pages);
    }

    /// What an exported constant or variable of type i32 holds.
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
                // Of the same module, so of the same type.
                let _same = global.set(&mut self.store, value);
            }
        }
    }

    /// Calls an export with a budget of `fuel`; every call that comes out goes to `answer` with the guest's memory.
    /// Gives the fuel that was used; nothing if there is no such export.
    pub(crate) fn run(
        &mut self,
        name: &str,
        arguments: Option<(i32, i64)>,
        fuel: u64,
        mut answer: impl FnMut(Call, &mut [u8]) -> Result<i32, Fault>,
    ) -> Result<Option<u64>, Fault> {
        let Some(function) = self.instance.get_func(&self.store, name) else {
            return Ok(None);
        };
        let other = |error: Error| fault(&error, fuel);
        self.store.set_fuel(fuel).map_err(other)?;
        let values = arguments.map(|(tick, now_ns)| [Val::I32(tick), Val::I64(now_ns)]);
        let values = values.as_ref().map_or(&[][..], |values| values);
        let mut state = function
            .call_resumable(&mut self.store, values, &mut [])
            .map_err(other)?;
        loop {
            match state {
                ResumableCall::Finished => {
                    let left = self.store.get_fuel().map_err(other)?;
                    return Ok(Some(fuel.saturating_sub(left)));
                }
                ResumableCall::OutOfFuel(_) => return Err(Fault::Fuel { most: fuel }),
                ResumableCall::HostTrap(suspended) => {
                    let Some(call) = suspended.host_error().downcast_ref::<Call>().copied() else {
                        return Err(fault(suspended.host_error(), fuel));
                    };
                    let result = answer(call, self.memory.data_mut(&mut self.store))?;
                    let result = [Val::I32(result)];
                    let results = match call.import {
                        Import::Log => &[][..],
                        Import::Block(_) => &result[..],
                    };
                    state = suspended
                        .resume(&mut self.store, results, &mut [])
                        .map_err(other)?;
                }
            }
        }
    }
}

fn fault(error: &Error, most: u64) -> Fault {
    match error.as_trap_code() {
        Some(TrapCode::OutOfFuel) => Fault::Fuel { most },
        Some(code) => Fault::Trap(code.trap_message()),
        None => Fault::Other(error.to_string()),
    }
}
