//! Guest programs: their modules, and which of their variables are signals.

use super::json::{Json, Node};
use super::text::fault_symbol;
use super::value::Fields;
use super::{Reader, is_note, shape};
use crate::error::{Code, Diagnostic, quoted};
use crate::model::Point;
use crate::model::{Claim, ClaimKind, Condition, Place, Program, Range, Signal, Span, Symbol, Test, Window};
use standstill_fb::{PinType, Value};
use standstill_guest::{INSTANCES_MOST, LoadError, Settings, SymbolType};

/// Whether programs and expressions are run. If not, none is compiled, so that a build without them does not
/// contain the compiler.
pub(super) const ARE_RUN: bool = cfg!(feature = "guest");

/// Largest number of guest programs of a script. Their instances share numbers of 16 bits with those of the script.
pub(crate) const PROGRAMS_MAX: usize = 16;

/// Largest number of variables of a program that are signals.
const SYMBOLS_MAX: usize = 256;

/// Largest fuel of a call.
pub(crate) const FUEL_MAX: i64 = 1_000_000_000;

/// Largest number of bytes of memory: the range of 32 bits.
pub(crate) const MEMORY_MAX: i64 = 1 << 32;

/// Memory that all guest programs of a script may have together unless the caller allows more (bytes).
pub const GUEST_MEMORY: u64 = 64 << 20;

/// Types of symbols.
pub(crate) const SYMBOL_TYPES: [&str; SymbolType::ALL.len()] = {
    let mut names = [""; SymbolType::ALL.len()];
    let mut index = 0;
    while index < names.len() {
        names[index] = SymbolType::ALL[index].iec_name();
        index += 1;
    }
    names
};

/// The signal of a program that the runtime writes.
pub(crate) const FAULT: &str = "Fault";

/// Returns the bytes of a module, or the reason why not.
pub(super) type LoadGuest<'a> = &'a mut dyn FnMut(&str) -> Result<Vec<u8>, String>;

impl Reader {
    pub(super) fn programs(&mut self, fields: &Fields<'_>, load: LoadGuest<'_>) -> Option<()> {
        let Some(node) = fields.get("programs") else {
            return Some(());
        };
        let members = self.map(node, "`programs`")?;
        if members.iter().count() > PROGRAMS_MAX {
            let message = format!("a script has at most {PROGRAMS_MAX} programs");
            return self.refuse(Diagnostic::new(Code::TooLarge, node.span, message));
        }
        // The numbers of their instances end below the largest one.
        let first = 65_535 - PROGRAMS_MAX * INSTANCES_MOST;
        let instances = match fields.get("blocks").map(|node| &node.json) {
            Some(Json::List(items)) => items.len(),
            _ => 0,
        };
        if instances >= first {
            let message = format!("beside programs a script has less than {first} instances");
            return self.refuse(Diagnostic::new(Code::TooLarge, node.span, message));
        }
        let share = self.memory_share(&members, node)?;
        for (index, (key, node)) in members.iter().enumerate() {
            let first = first + index * INSTANCES_MOST;
            let first = u16::try_from(first).unwrap_or(1);
            let program = self.program(&key.text, node, first, share, load);
            self.programs.push(program);
        }
        self.programs.iter().all(Option::is_some).then_some(())
    }

    /// The memory of a program that does not state its need (bytes): the usual amount, or an equal share of the
    /// rest. All together may have no more than the caller permits.
    fn memory_share(&mut self, members: &Fields<'_>, node: &Node) -> Option<u64> {
        let said = |node: &Node| {
            // An invalid number of bytes is reported where the program is read.
            node.member("memory").map(|node| match node.json {
                Json::Number(bytes) if (0.0..=MEMORY_MAX as f64).contains(&bytes) => bytes as u64,
                _ => 0,
            })
        };
        let all: Vec<_> = members.iter().map(|(_, node)| said(node)).collect();
        let total = all.iter().flatten().copied().fold(0, u64::saturating_add);
        let most = self.terms.guest_memory;
        if total > most {
            let message = format!(
                "the programs may take {total} bytes of memory, more than the {most} of all guests of a script"
            );
            let help = format!("where that is wanted, run it with `--guest-memory {total}`");
            return self.refuse(Diagnostic::new(Code::TooLarge, node.span, message).help(help));
        }
        let silent = all.iter().filter(|said| said.is_none()).count() as u64;
        let left = (most - total).checked_div(silent).unwrap_or_default();
        Some(left.min(Settings::default().memory))
    }

    fn program(
        &mut self,
        name: &str,
        node: &Node,
        first: u16,
        share: u64,
        load: LoadGuest<'_>,
    ) -> Option<Program> {
        let fields = self.fields(node, &shape::PROGRAM)?;
        if !ARE_RUN {
            let message = format!("the program {} cannot run: {}", quoted(name), LoadError::NotBuilt);
            return self.refuse(Diagnostic::new(Code::NotBuilt, node.span, message));
        }
        let defaults = Settings::default();
        let fuel = self.optional(&fields, "fuel", defaults.fuel, |it, node, key| {
            it.whole(node, key, 1..=FUEL_MAX).map(i64::cast_unsigned)
        });
        let memory = self.optional(&fields, "memory", share, |it, node, key| {
            it.whole(node, key, 1..=MEMORY_MAX).map(i64::cast_unsigned)
        });
        self.optional(&fields, "may_fault", false, Self::boolean);
        let place = self.stands_at(node.span, &fields);
        let settings = Settings {
            fuel: fuel?,
            memory: memory?,
            first_instance: first,
            ..defaults
        };
        match (fields.entry("wasm"), fields.entry("st")) {
            (Some((first, _)), Some((second, _))) => {
                let message = "a program comes from `wasm` or from `st`, not from both";
                self.refuse(
                    Diagnostic::new(Code::UnknownKey, second.span, message)
                        .related(first.span, "the other one"),
                )
            }
            (None, None) => {
                let message = "a program needs the key `wasm` or the key `st`";
                self.refuse(Diagnostic::new(Code::MissingKey, fields.brace(), message))
            }
            (Some(_), None) => {
                self.refuse_keys(&fields, &["program", "axes", "trace"], "st");
                self.module(name, &fields, place, settings, load)
            }
            (None, Some(_)) => {
                self.refuse_keys(&fields, &["symbols"], "wasm");
                self.text_program(name, &fields, place, settings, load)
            }
        }
    }

    /// Refuses keys that belong to programs of another kind.
    fn refuse_keys(&mut self, fields: &Fields<'_>, keys: &[&str], other: &str) {
        for (key, _) in keys.iter().filter_map(|key| fields.entry(key)) {
            let message = format!("`{}` belongs to programs with `{other}`", key.text);
            self.report(Diagnostic::new(Code::UnknownKey, key.span, message));
        }
    }

    /// A program that is a module already.
    fn module(
        &mut self,
        name: &str,
        fields: &Fields<'_>,
        place: Place,
        settings: Settings,
        load: LoadGuest<'_>,
    ) -> Option<Program> {
        let symbols = self.symbols(fields);
        let wasm = fields.get("wasm")?;
        let path = self.text(wasm, "`wasm`")?;
        let guest = load(path).and_then(|bytes| {
            standstill_guest::Program::compile(&bytes, settings).map_err(|error| error.to_string())
        });
        match guest {
            Ok(guest) => Some(Program {
                name: name.to_owned(),
                calls: Vec::new(),
                guest,
                symbols: symbols?,
                place,
                text: None,
            }),
            Err(why) => {
                let message = format!("{} cannot be the program {}: {why}", quoted(path), quoted(name));
                self.refuse(Diagnostic::new(Code::BadProgram, wasm.span, message))
            }
        }
    }

    fn symbols(&mut self, fields: &Fields<'_>) -> Option<Vec<Symbol>> {
        let mut symbols = vec![Some(fault_symbol())];
        if let Some(node) = fields.get("symbols") {
            let members = self.map(node, "`symbols`")?;
            if members.iter().count() > SYMBOLS_MAX {
                let message = format!("a program has at most {SYMBOLS_MAX} symbols");
                return self.refuse(Diagnostic::new(Code::TooLarge, node.span, message));
            }
            let mut names = vec![FAULT.to_ascii_uppercase()];
            for (key, node) in members.iter() {
                if is_note(key, node) && node.text().and_then(SymbolType::find).is_none() {
                    continue;
                }
                self.check_name(&key.text, key.span);
                let upper = key.text.to_ascii_uppercase();
                if names.contains(&upper) {
                    let message = format!("the name {} is taken", quoted(&key.text));
                    self.report(Diagnostic::new(Code::DuplicateName, key.span, message).help(
                        "symbols of a program differ without regard to case, and `Fault` is there already",
                    ));
                }
                names.push(upper);
                symbols.push(self.symbol(&key.text, node));
            }
        }
        symbols.into_iter().collect()
    }

    fn symbol(&mut self, name: &str, node: &Node) -> Option<Symbol> {
        let (ty, address, export) = match &node.json {
            Json::Map(_) => {
                let fields = self.fields(node, &shape::SYMBOL)?;
                let address = self.if_given(&fields, "address", |it, node, key| {
                    it.whole(node, key, 0..=i64::from(u32::MAX))
                })?;
                let export = self.if_given(&fields, "export", Self::text)?.map(str::to_owned);
                if let (Some(_), Some(node)) = (address, fields.get("export")) {
                    let message = "a symbol stands at an `address` or where an `export` says, not both";
                    self.report(Diagnostic::new(Code::BadValue, node.span, message));
                }
                (self.require(&fields, "type", "a symbol")?, address, export)
            }
            _ => (node, None, None),
        };
        let text = self.text(ty, "the type of a symbol")?;
        let Some(own) = SymbolType::find(text) else {
            let message = format!("a symbol cannot be of type {}", quoted(text));
            let help = format!("one of {}", SYMBOL_TYPES.join(", "));
            return self.refuse(Diagnostic::new(Code::BadValue, ty.span, message).help(help));
        };
        Some(Symbol {
            name: name.to_owned(),
            ty: own.signal(),
            own,
            address: address.and_then(|address| u32::try_from(address).ok()),
            export,
            variable: None,
        })
    }

    /// Whether the variable at a point can have a value; reports an error if not.
    pub(super) fn symbol_holds(&mut self, point: Point, value: Value, span: Span, what: &str) -> bool {
        let Point::Symbol(program, symbol) = point else {
            return true;
        };
        let program = self.programs.get(program).and_then(Option::as_ref);
        let Some(symbol) = program.and_then(|program| program.symbols.get(symbol)) else {
            return true;
        };
        let (own, Some((least, most))) = (symbol.own, symbol.own.narrow()) else {
            return true;
        };
        if !own.holds(value) {
            let message = format!(
                "{what} must be a whole number from {least} to {most}: its variable is a {}",
                own.iec_name()
            );
            self.report(Diagnostic::new(Code::BadValue, span, message));
        }
        own.holds(value)
    }

    /// For each program that may not fault: a claim that it does not.
    pub(super) fn fault_claims(&self, fields: &Fields<'_>) -> Vec<Claim> {
        let may = |node: &Node| match &node.json {
            Json::Map(_) => matches!(node.member("may_fault"), Some(node) if node.json == Json::Bool(true)),
            _ => true,
        };
        let claim = |index: usize, name: &str, span: Span| Claim {
            path: format!("programs.{name}"),
            span,
            may_be_vacuous: false,
            range: Range { from: 0, to: None },
            window: Window::default(),
            during: Vec::new(),
            kind: ClaimKind::Never(vec![Condition {
                text: format!("{name}.{FAULT}"),
                signal: Signal::Point(Point::Symbol(index, 0)),
                test: Test::Bool(true),
                span,
            }]),
        };
        let programs = fields.members("programs").iter().enumerate();
        programs
            .filter(|(_, (_, node))| !may(node))
            .map(|(index, (key, _))| claim(index, &key.text, key.span))
            .collect()
    }

    /// The variable of a program with this `name`.
    pub(super) fn symbol_point(
        &mut self,
        program: usize,
        name: &str,
        span: Span,
    ) -> Option<(Point, PinType)> {
        // A program that was refused is already reported.
        let program_read = self.programs.get(program)?.as_ref()?;
        let symbols = &program_read.symbols;
        if let Some(text) = program_read.text.clone()
            && !name.eq_ignore_ascii_case(FAULT)
        {
            return self.variable_point(program, &text, name, span);
        }
        let found = symbols
            .iter()
            .position(|symbol| symbol.name.eq_ignore_ascii_case(name));
        if let Some(index) = found {
            return Some((Point::Symbol(program, index), symbols.get(index)?.ty));
        }
        let message = format!("{} has no symbol {}", quoted(&program_read.name), quoted(name));
        let help = super::names::suggestion(name, symbols.iter().map(|symbol| symbol.name.as_str()));
        self.refuse(Diagnostic::new(Code::UnknownSignal, span, message).maybe_help(
            help.or_else(|| Some("`symbols` of the program lists its variables that are signals".to_owned())),
        ))
    }
}
