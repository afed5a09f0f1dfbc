//! Calls of functions and of instances of blocks.

use super::path::Named;
use super::{Checker, UnitKind};
use crate::error::{Code, Diagnostic, quoted};
use crate::library::{Function, blocks, conversion};
use crate::source::Span;
use crate::syntax::{self, Call, Expression, ExpressionKind, Path, Selector, Way};
use crate::typed::{Argument, Base, BlockCall, Expr, FunctionCall, Kind, Place, StmtKind};
use crate::types::{Constant, Elementary, Member, MemberKind, Start, Type, TypeId, UnitId, WRONG};

/// Largest number of pins that a message lists.
const PINS_SHOWN: usize = 10;

impl<'a> Checker<'a> {
    /// A call that is an expression.
    pub(super) fn call_value(&mut self, call: &'a Call, expected: Option<TypeId>) -> Expr {
        let wrong = Expr::wrong(call.span);
        if let Some((method, instance)) = self.method_of(&call.callee) {
            return self.function(method, Some(instance), call);
        }
        let name = &call.callee.root;
        let key = name.key();
        let local = self.local(&key).is_some();
        let own_name = self
            .scope
            .is_some_and(|unit| self.unit(unit).kind == UnitKind::Function);
        let shadowed = (local && !own_name) || self.global_names.contains_key(&key);
        if !call.callee.selectors.is_empty() || shadowed || call.callee.this {
            let (message, help) = match self.named(&call.callee, None) {
                Named::Nothing => return wrong,
                Named::Value(_) => (
                    "a constant cannot be called".to_owned(),
                    "the values of an array are repeated by a number: [3(0)]",
                ),
                Named::Place(place, _) => (
                    match self.types.get(place.ty) {
                        Type::Block(_) => "a block has no value".to_owned(),
                        _ => format!("{} cannot be called", self.type_name(place.ty)),
                    },
                    "call a block in a statement, and read its outputs",
                ),
            };
            self.error(Code::WrongType, call.span, message, help);
            return wrong;
        }
        if let Some(unit) = self.unit_names.get(&key).copied() {
            self.look_at_unit(name.span, unit);
            if self.unit(unit).kind == UnitKind::Function {
                return self.function(unit, None, call);
            }
            let message = format!("`{}` is no function", name.text);
            let help = format!(
                "declare an instance, call it in a statement, and read its outputs: `My{0} : {0};`",
                name.text
            );
            self.error(Code::WrongType, name.span, message, &help);
            return wrong;
        }
        if let Some(value) = self.library_call(&key, call, expected) {
            self.look_at_function(name.span, &key);
            return value;
        }
        if let Some(instead) = of_pointers(&key) {
            let message = format!("{key} is not supported");
            self.error(Code::Unsupported, name.span, message, instead);
            return wrong;
        }
        if self.may_be_lost(&key) || !self.is_news(None, &key) {
            return wrong;
        }
        let names = self.declared_units();
        let guess = self.guess(&key, names.chain(Function::ALL.iter().map(|it| it.name())));
        let block = blocks::find(&key).map(|_| {
            format!(
                "it is a function block: declare an instance, `My{0} : {0};`",
                name.text
            )
        });
        let message = format!("there is no function {}", quoted(&name.text));
        let message = match key.rsplit_once("_TO_") {
            Some((from, to)) if conversion(&key).is_none() => {
                format!("there is no conversion from {from} to {to}")
            }
            _ => message,
        };
        let text = key.ends_with("_TO_STRING") || key.starts_with("STRING_TO_");
        let guess = guess.filter(|_| !text);
        let block = if text {
            Some(super::library_call::TO_TEXT.to_owned())
        } else {
            block
        };
        let wrong_name = Diagnostic::error(Code::UnknownName, name.span, message);
        self.tell(wrong_name.maybe_help(guess).maybe_help(block));
        wrong
    }

    /// The member each argument is for, in the order of the text.
    fn matched(
        &mut self,
        unit: UnitId,
        arguments: &'a [syntax::Argument],
    ) -> Vec<(usize, &'a syntax::Argument)> {
        let mut matched: Vec<(usize, &'a syntax::Argument)> = Vec::new();
        let members = self.unit(unit).members.list.iter().enumerate();
        let given = members.filter(|(_, member)| member.kind.is_given());
        let positions: Vec<usize> = given.map(|(place, _)| place).collect();
        let mut positions = positions.into_iter();
        for argument in arguments {
            let info = self.unit(unit);
            let place = match &argument.name {
                None => positions.next(),
                Some(name) => {
                    let key = self.member_key(unit, name);
                    info.members.find(&key).map(|(place, _)| place)
                }
            };
            let Some(place) = place else {
                self.no_such_argument(unit, argument);
                continue;
            };
            let member = info.members.list[place].clone();
            let shown = member.name.clone();
            if let Some(name) = &argument.name {
                self.look_at_member(name.span, unit, place);
            }
            let info = self.unit(unit);
            let good = match argument.way {
                Way::In => member.kind.is_given(),
                Way::Out | Way::OutInverted => member.kind == MemberKind::Output,
            };
            if !good {
                let (message, help) = match (argument.way, member.kind) {
                    (Way::In, MemberKind::Output) => (
                        format!("`{shown}` is an output"),
                        format!("write {shown} => variable"),
                    ),
                    (Way::In, _) => (
                        format!("`{shown}` is no input of {}", info.name),
                        "make it VAR_INPUT".to_owned(),
                    ),
                    (_, MemberKind::Input | MemberKind::InOut) => (
                        format!("`{shown}` is an input"),
                        format!("write {shown} := value"),
                    ),
                    _ => (
                        format!("`{shown}` is no output of {}", info.name),
                        "make it VAR_OUTPUT".to_owned(),
                    ),
                };
                self.error(Code::BadArgument, argument.span, message, &help);
                continue;
            }
            // One output may go to several variables; an input has one value.
            if argument.way == Way::In
                && matched
                    .iter()
                    .any(|(other, it)| *other == place && it.way == Way::In)
            {
                self.error(
                    Code::BadArgument,
                    argument.span,
                    format!("`{shown}` is given twice"),
                    "",
                );
                continue;
            }
            // `In :=` leaves the input out.
            if argument.way == Way::Out || argument.way == Way::OutInverted || argument.value.is_some() {
                matched.push((place, argument));
            }
        }
        matched
    }

    /// A call by place gives a function all of its inputs; a call by name may leave out what is no in_out. Whether the
    /// call is reported.
    fn lacks_inputs(
        &mut self,
        unit: UnitId,
        arguments: &[syntax::Argument],
        matched: &[(usize, &syntax::Argument)],
        span: Span,
    ) -> bool {
        let by_place = arguments.iter().any(|argument| argument.name.is_none());
        let info = self.unit(unit);
        let (mut count, mut missing) = (0, Vec::new());
        for (place, member) in info.members.list.iter().enumerate() {
            let input = member.kind == MemberKind::Input;
            if !member.kind.is_given() {
                continue;
            }
            count += 1;
            let given = matched.iter().any(|(it, _)| *it == place);
            if !given && (by_place || input && matches!(member.start, Start::Default)) {
                missing.push(quoted(&member.name));
            }
        }
        // What is matched to nothing has been reported.
        if missing.is_empty() || matched.len() < arguments.len() {
            return false;
        }
        let are = if missing.len() == 1 { "is" } else { "are" };
        let missing = missing.join(", ");
        if by_place {
            let message = format!(
                "{} takes {}, and {missing} {are} missing",
                info.name,
                inputs(count)
            );
            let help =
                "a call by place gives all inputs; a call by their names, `a := 1`, may leave some out";
            self.error(Code::MissingArgument, span, message, help);
        } else {
            let message = format!("the call of {} does not give {missing}", info.name);
            let doubt = Diagnostic::warning(Code::Portability, span, message);
            self.tell(
                doubt.help("CODESYS and TwinCAT want all inputs that are declared without a first value"),
            );
        }
        by_place
    }

    fn no_such_argument(&mut self, unit: UnitId, argument: &syntax::Argument) {
        if self.is_damaged(unit) {
            return;
        }
        let info = self.unit(unit);
        match &argument.name {
            None => {
                let members = info.members.list.iter();
                let count = members.filter(|member| member.kind.is_given()).count();
                let message = format!("{} takes {}", info.name, inputs(count));
                self.error(Code::BadArgument, argument.span, message, "");
            }
            Some(name) => {
                let names = info.members.list.iter().map(|member| member.name.as_str());
                let guess = self.guess(&name.text, names);
                let elsewhere = self.options.dialect.pin_elsewhere(&info.name, &name.text);
                let guess = elsewhere.or(guess).or_else(|| self.pins_for(unit, argument.way));
                let message = format!("{} has no pin `{}`", info.name, name.text);
                self.tell(Diagnostic::error(Code::BadArgument, name.span, message).maybe_help(guess));
            }
        }
    }

    /// The pins that can be given in this direction, for a message.
    fn pins_for(&self, unit: UnitId, way: Way) -> Option<String> {
        let pins = self.unit(unit).members.list.iter().filter(|member| match way {
            Way::In => member.kind.is_given(),
            Way::Out | Way::OutInverted => member.kind == MemberKind::Output,
        });
        let names: Vec<&str> = pins.map(|member| member.name.as_str()).collect();
        let shown = names.get(..PINS_SHOWN).unwrap_or(&names).join(", ");
        let more = if names.len() > PINS_SHOWN { ", .." } else { "" };
        (!names.is_empty()).then(|| format!("it has {shown}{more}"))
    }

    /// The variable that is bound to an in_out.
    fn bound(&mut self, member: &Member, value: &'a Expression) -> Option<Place> {
        let ExpressionKind::Path(path) = &value.kind else {
            let message = format!("`{}` is VAR_IN_OUT and takes a variable", member.name);
            self.error(
                Code::WrongType,
                value.span,
                message,
                "put the value into a variable first",
            );
            return None;
        };
        match self.named(path, None) {
            Named::Nothing => None,
            Named::Value(_) => {
                let message = format!(
                    "`{}` is VAR_IN_OUT and takes a variable, no constant",
                    member.name
                );
                self.error(
                    Code::NotWritable,
                    value.span,
                    message,
                    "put the value into a variable first",
                );
                None
            }
            Named::Place(place, fixed) => {
                if let Some(why) = fixed {
                    let message = format!("{why}, and VAR_IN_OUT may write it");
                    self.error(
                        Code::NotWritable,
                        value.span,
                        message,
                        "put the value into a variable first",
                    );
                    return None;
                }
                if place.bit.is_some() {
                    self.error(
                        Code::WrongType,
                        value.span,
                        "a bit has no address",
                        "put it into a BOOL first",
                    );
                    return None;
                }
                if place.ty != member.ty && member.ty != WRONG {
                    let (wanted, found) = (self.type_name(member.ty), self.type_name(place.ty));
                    let message = format!("`{}` takes a variable of type {wanted}, not {found}", member.name);
                    self.error(
                        Code::WrongType,
                        value.span,
                        message,
                        "VAR_IN_OUT converts nothing",
                    );
                    return None;
                }
                self.note_write_to(path);
                Some(place)
            }
        }
    }

    /// The target of an output, and the converted value.
    fn output(&mut self, member: Place, argument: &'a syntax::Argument) -> Option<(Place, Expr)> {
        let value = argument.value.as_ref()?;
        let ExpressionKind::Path(path) = &value.kind else {
            self.error(Code::WrongType, value.span, "an output goes to a variable", "");
            return None;
        };
        let target = self.target(path)?;
        let ty = self.types.value_type(member.ty);
        let mut loaded = Expr::new(Kind::Load(member), ty, argument.span);
        if argument.way == Way::OutInverted {
            if self.types.elementary(ty) == Some(Elementary::Bool) {
                loaded.kind = Kind::Not(Elementary::Bool, Box::new(loaded.clone()));
            } else {
                let message = "NOT goes with outputs that are BOOL";
                self.error(Code::WrongType, argument.span, message, "");
            }
        }
        let wanted = if target.bit.is_some() {
            crate::types::BOOL
        } else {
            target.ty
        };
        let converted = self.convert(loaded, wanted);
        (!converted.is_wrong()).then_some((target, converted))
    }

    /// The method of this name, and the instance it is called for; `None` if it is not a method.
    fn method_of(&mut self, callee: &'a Path) -> Option<(UnitId, Place)> {
        let Some((Selector::Member(name), before)) = callee.selectors.split_last() else {
            let block = self.this_block()?;
            let method = self.methods.get(&(block, callee.root.key())).copied()?;
            let ty = self.block_type(block);
            self.look_at_unit(callee.root.span, method);
            return Some((method, Place::plain(Base::This, 0, ty)));
        };
        let key = name.key();
        if !self.methods.keys().any(|(_, method)| *method == key) {
            return None;
        }
        let Named::Place(instance, _) = self.named_part(callee, before, None) else {
            return None;
        };
        let Type::Block(block) = *self.types.get(instance.ty) else {
            return None;
        };
        let method = self.methods.get(&(block, key)).copied()?;
        self.look_at_unit(name.span, method);
        let private = self.unit(method).syntax.is_some_and(|syntax| syntax.private);
        if private && self.this_block() != Some(block) {
            let message = format!(
                "the method `{}` of {} is private",
                name.text,
                self.unit(block).name
            );
            self.error(Code::UnknownMember, name.span, message, "make it PUBLIC");
        }
        Some((method, instance))
    }

    /// A call of a FUNCTION, or of a METHOD for an instance.
    pub(super) fn function(&mut self, unit: UnitId, instance: Option<Place>, call: &'a Call) -> Expr {
        self.resolve_unit(unit, call.span);
        self.note_call(unit, call.span);
        let matched = self.matched(unit, &call.arguments);
        let reported = self.lacks_inputs(unit, &call.arguments, &matched, call.span);
        let info = self.unit(unit);
        let (name, frame) = (info.name.clone(), info.frame);
        let result = info
            .result
            .and_then(|place| info.members.list.get(place))
            .map(|member| member.ty);
        let members = info.members.list.clone();
        let mut arguments = Vec::new();
        let mut outputs = Vec::new();
        let mut wrong = false;
        for (place, member) in members.iter().enumerate() {
            let given = matched
                .iter()
                .find(|(it, argument)| *it == place && argument.way == Way::In);
            let value = given.and_then(|(_, argument)| argument.value.as_ref());
            match member.kind {
                MemberKind::Input => {
                    let value = match value {
                        Some(value) => self.function_input(unit, value, member.ty),
                        None => match self.default_value(member, call.span) {
                            Some(value) => value,
                            None => {
                                self.missing(&member.name, &name, call.span);
                                Expr::wrong(call.span)
                            }
                        },
                    };
                    wrong |= value.is_wrong();
                    arguments.push(Argument::Value(value));
                }
                MemberKind::InOut => match value {
                    Some(value) => match self.bound(member, value) {
                        Some(place) => arguments.push(Argument::Reference(place)),
                        None => wrong = true,
                    },
                    None => {
                        if !reported {
                            self.missing(&member.name, &name, call.span);
                        }
                        wrong = true;
                    }
                },
                MemberKind::Output => {
                    for (_, argument) in matched.iter().filter(|(it, _)| *it == place) {
                        let from = Place::plain(Base::Memory, frame.saturating_add(member.offset), member.ty);
                        outputs.extend(self.output(from, argument));
                    }
                }
                _ => {}
            }
        }
        let mut called = FunctionCall {
            unit,
            instance,
            arguments,
            outputs,
            buffer: None,
        };
        let Some(result) = result.filter(|ty| *ty != WRONG && !wrong) else {
            if wrong || self.unit(unit).result.is_some() {
                return Expr::wrong(call.span);
            }
            // A function without a type is called in statements only.
            return Expr::new(Kind::Call(Box::new(called)), WRONG, call.span);
        };
        if self.types.elementary(result).is_none() {
            let (bytes, _) = self.size(result);
            called.buffer = Some((self.layout.take(bytes), bytes));
        }
        self.check_memory(call.span);
        let ty = self.types.value_type(result);
        Expr::new(Kind::Call(Box::new(called)), ty, call.span)
    }

    /// The value of an input of a function.
    fn function_input(&mut self, unit: UnitId, value: &'a Expression, ty: TypeId) -> Expr {
        let found = self.expression(value, Some(ty));
        let info = self.unit(unit);
        if let Some(from) = info.name.strip_suffix("_TO_STRING")
            && self.sources.in_library(info.span)
            && let Some(given) = self.types.computed(found.ty)
            && !Elementary::find(from).is_some_and(|from| given.widens_to(from))
        {
            let given = given.name();
            let message = format!("{} takes {from}, not {given}", info.name);
            let other = format!("{given}_TO_STRING");
            let help = if self.unit_names.contains_key(&other) {
                format!("write {other}(..)")
            } else {
                super::library_call::TO_TEXT.to_owned()
            };
            self.error(Code::Conversion, found.span, message, &help);
            return Expr::wrong(found.span);
        }
        self.convert(found, ty)
    }

    /// The default of an input of a function that a call leaves out.
    fn default_value(&mut self, member: &Member, span: Span) -> Option<Expr> {
        if self.is_text(member.ty) {
            let bytes = match &member.start {
                Start::Text(bytes) => bytes.clone(),
                _ => Vec::new(),
            };
            let (kind, ty) = (Kind::Text(bytes), member.ty);
            return Some(Expr::new(kind, ty, span));
        }
        let elementary = self.types.elementary(member.ty)?;
        let kind = match &member.start {
            Start::Value(Constant::Integer(number)) => Kind::Integer(*number),
            Start::Value(Constant::Real(number)) => Kind::Real(*number),
            Start::Default => match crate::start::first(&self.types, member.ty) {
                number if elementary.is_real() => Kind::Real(number as f64),
                number => Kind::Integer(number),
            },
            _ => return None,
        };
        Some(Expr::new(kind, self.types.value_type(member.ty), span))
    }

    fn missing(&mut self, pin: &str, of: &str, span: Span) {
        let message = format!("the call of {of} does not give `{pin}`");
        self.error(
            Code::MissingArgument,
            span,
            message,
            &format!("write {pin} := .."),
        );
    }

    /// A call that is a statement.
    pub(super) fn call_statement(&mut self, call: &'a Call) -> Option<StmtKind> {
        if self.method_of(&call.callee).is_some() {
            let value = self.call_value(call, None);
            return (!matches!(value.kind, Kind::Wrong)).then_some(StmtKind::Evaluate(value));
        }
        let key = call.callee.root.key();
        let variable = self.variable_exists(&key)
            || self.program_named(&key).is_some()
            || !call.callee.selectors.is_empty()
            || call.callee.this;
        if !variable {
            let block = self
                .unit_names
                .get(&key)
                .copied()
                .or_else(|| self.library_block(&key));
            if let Some(unit) = block.filter(|unit| self.unit(*unit).kind != UnitKind::Function) {
                let name = self.unit(unit).name.clone();
                let message = format!("`{name}` is a function block, not an instance");
                let help = format!("declare one in VAR, `My{name} : {name};`, and call that");
                self.error(Code::WrongType, call.callee.root.span, message, &help);
                return None;
            }
            let value = self.call_value(call, None);
            return match &value.kind {
                Kind::Wrong => None,
                _ => Some(StmtKind::Evaluate(value)),
            };
        }
        let Named::Place(instance, _) = self.named(&call.callee, None) else {
            return None;
        };
        let Type::Block(unit) = *self.types.get(instance.ty) else {
            let message = format!("{} cannot be called", self.type_name(instance.ty));
            self.error(
                Code::WrongType,
                call.callee.span,
                message,
                "only functions and instances of blocks are called",
            );
            return None;
        };
        self.block_call(instance, unit, &call.arguments, call.span, call.callee.span)
    }

    /// A call of an instance of a block or program.
    pub(super) fn block_call(
        &mut self,
        instance: Place,
        unit: UnitId,
        arguments: &'a [syntax::Argument],
        span: Span,
        callee: Span,
    ) -> Option<StmtKind> {
        self.note_call(unit, span);
        let matched = self.matched(unit, arguments);
        let members = self.unit(unit).members.list.clone();
        let mut made = BlockCall {
            instance,
            unit,
            inputs: Vec::new(),
            references: Vec::new(),
            kept: Vec::new(),
            outputs: Vec::new(),
        };
        let mut wrong = false;
        for (place, argument) in &matched {
            let member = &members[*place];
            let own = Place::plain(Base::Callee, member.offset, member.ty);
            match (argument.way, &argument.value) {
                (Way::In, Some(value)) if member.kind == MemberKind::InOut => match self.bound(member, value)
                {
                    Some(bound) => made.references.push((*place, bound)),
                    None => wrong = true,
                },
                (Way::In, Some(value)) => {
                    let value = self.value(value, member.ty);
                    wrong |= value.is_wrong();
                    made.inputs.push((own, value));
                }
                _ => made.outputs.extend(self.output(own, argument)),
            }
        }
        for (place, member) in members.iter().enumerate() {
            let given = matched.iter().any(|(it, _)| *it == place);
            if member.kind == MemberKind::InOut && !given {
                made.kept.push(place);
            }
        }
        let text = self.sources.text(callee).to_ascii_uppercase();
        self.note_bound(
            &text,
            matched.iter().map(|(place, _)| *place),
            &made.kept,
            span,
            unit,
        );
        (!wrong).then(|| StmtKind::Block(Box::new(made)))
    }
}

/// How many inputs something takes, in a message.
pub(super) fn inputs(count: usize) -> String {
    match count {
        0 => "no inputs".to_owned(),
        1 => "1 input".to_owned(),
        _ => format!("{count} inputs"),
    }
}

/// The replacement for a function that works with addresses.
fn of_pointers(key: &str) -> Option<&'static str> {
    Some(match key {
        "ADR" | "REF" | "ADRINST" | "__ISVALIDREF" => {
            "there are no pointers: hand variables over as VAR_IN_OUT"
        }
        "SIZEOF" | "XSIZEOF" => "there are no pointers, so nobody needs the size of a variable",
        "MEMCPY" | "MEMMOVE" | "MEMSET" => {
            "there are no pointers: arrays and structures are assigned whole, `a := b;`"
        }
        "LOWER_BOUND" | "UPPER_BOUND" => "arrays have constant bounds: name them in VAR CONSTANT",
        _ => return None,
    })
}
