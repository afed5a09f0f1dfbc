//! Programs in Structured Text, compiled, checked by an independent validator if it is there, and run.
use standstill_axis::{IdealDrive, Standard};
use standstill_fb::Value;
use standstill_guest::{Fault, Guest, Program, Settings, SymbolType};
use standstill_scan::{Machine, RUNTIME, ScanTime};
use standstill_st::{Compiled, Elementary, FAULT_SITE, FAULT_VALUE, Options, Place, Report, Source, Symbol};

/// Compiles a text; a mistake fails the test with its message.
pub fn compiled(text: &str) -> Compiled {
    let compiled = compile(text).unwrap_or_else(|report| panic!("{}", report.render()));
    valid(&compiled);
    compiled
}

/// Checks a module with a validator that is not the interpreter's.
pub fn valid(compiled: &Compiled) {
    standstill_testkit::peers::module(&compiled.wasm).unwrap();
}

pub const fn source<'a>(name: &'a str, text: &'a str) -> Source<'a> {
    Source {
        name,
        bytes: text.as_bytes(),
    }
}

pub fn compile(text: &str) -> Result<Compiled, Box<Report>> {
    compile_with(text, &Options::default())
}

pub fn compile_with(text: &str, options: &Options) -> Result<Compiled, Box<Report>> {
    standstill_st::compile(&[source("prog.st", text)], options)
}

/// The report of a text that need not have a program.
pub fn checked(text: &str) -> Report {
    let options = Options {
        library: true,
        ..Options::default()
    };
    standstill_st::check(&[source("prog.st", text)], &options)
}

/// The faults of a text: codes and messages.
pub fn wrong(text: &str) -> Vec<(&'static str, String)> {
    let report = checked(text);
    // Rendering must not fail, for any fault.
    let _shown = report.render();
    told(&report)
}

/// Codes and messages.
pub fn told(report: &Report) -> Vec<(&'static str, String)> {
    let told = report.diagnostics().iter();
    told.map(|it| (it.code.name(), it.message.clone())).collect()
}

/// A program between two scans.
pub struct Running {
    guest: Guest,
    machine: Machine<Standard, IdealDrive>,
    pub compiled: Compiled,
    scan: u64,
}

impl Running {
    pub fn new(text: &str) -> Self {
        Self::of(compiled(text))
    }

    pub fn of(compiled: Compiled) -> Self {
        Self::with(compiled, Settings::default())
    }

    pub fn with(compiled: Compiled, settings: Settings) -> Self {
        let program = Program::compile(&compiled.wasm, settings).unwrap();
        Self {
            guest: program.start().unwrap(),
            machine: Machine::new(),
            compiled,
            scan: 0,
        }
    }

    /// One scan of 1 ms.
    pub fn scan(&mut self) -> Result<(), Fault> {
        let now_ns = self.scan as i64 * 1_000_000;
        let time = ScanTime {
            scan: self.scan,
            now_ns,
        };
        self.scan += 1;
        let mut context = self.machine.context(time, RUNTIME);
        self.guest.scan(&mut context).map(|_fuel| ())
    }

    fn symbol(&self, path: &str) -> Symbol {
        let found = self.compiled.symbols.find(path);
        found.unwrap_or_else(|| panic!("no {path}"))
    }

    /// The whole number in a variable.
    pub fn whole(&self, path: &str) -> i128 {
        let symbol = self.symbol(path);
        let bits = self.bits(symbol.address, symbol.ty.size());
        let width = symbol.ty.size() * 8;
        let signed = matches!(
            symbol.ty,
            Elementary::Sint
                | Elementary::Int
                | Elementary::Dint
                | Elementary::Lint
                | Elementary::Time
                | Elementary::Ltime
        );
        let number = i128::from(bits);
        if signed && number >> (width - 1) != 0 {
            number - (1 << width)
        } else {
            number
        }
    }

    /// The number in a REAL or LREAL.
    pub fn real(&self, path: &str) -> f64 {
        let symbol = self.symbol(path);
        let bits = self.bits(symbol.address, symbol.ty.size());
        match symbol.ty {
            Elementary::Real => f32::from_bits(bits as u32).into(),
            Elementary::Lreal => f64::from_bits(bits),
            other => panic!("{path}: {other:?}"),
        }
    }

    fn bits(&self, address: u32, size: u32) -> u64 {
        (0..size).fold(0, |bits, place| {
            let symbol = standstill_guest::Symbol {
                ty: SymbolType::Byte,
                address: address + place,
            };
            let Value::Word(byte) = self.guest.read(&symbol).unwrap() else {
                panic!()
            };
            bits | u64::from(byte) << (8 * place)
        })
    }

    pub fn set(&mut self, path: &str, value: u64) {
        let symbol = self.symbol(path);
        for place in 0..symbol.ty.size() {
            let byte = standstill_guest::Symbol {
                ty: SymbolType::Byte,
                address: symbol.address + place,
            };
            self.guest
                .write(&byte, Value::Word((value >> (8 * place)) as u16 & 0xFF))
                .unwrap();
        }
    }

    /// The number of the place of the loop that ran last.
    pub fn loop_site(&self) -> u32 {
        self.bits(standstill_st::LOOP_SITE, 4) as u32
    }

    /// The place of the fault, and the value that caused it.
    pub fn fault(&self) -> (Place, i64) {
        let place = self.compiled.symbols.place(self.bits(FAULT_SITE, 4) as u32);
        let place = place.expect("no place was noted").clone();
        (place, self.bits(FAULT_VALUE, 8).cast_signed())
    }
}

/// A program of these variables and statements after one scan.
pub fn ran(variables: &str, statements: &str) -> Running {
    let text = format!("PROGRAM Main\nVAR\n{variables}\nEND_VAR\n{statements}\nEND_PROGRAM\n");
    let mut running = Running::new(&text);
    running
        .scan()
        .unwrap_or_else(|fault| panic!("{fault}\n{statements}"));
    running
}

/// The whole number that an expression gives, in a variable of type `ty`.
pub fn worth(ty: &str, expression: &str) -> i128 {
    ran(&format!("x : {ty};"), &format!("x := {expression};")).whole("x")
}

/// The number that an expression gives, in a variable of type `ty`.
pub fn real(ty: &str, expression: &str) -> f64 {
    ran(&format!("x : {ty};"), &format!("x := {expression};")).real("x")
}
