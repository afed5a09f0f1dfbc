//! The functions that a guest imports. They work on its memory and on instances stored here.

use crate::{Fault, INSTANCES_MOST, Told};
use standstill_axis::{InstanceId, Log, Planner};
use standstill_blocks::{BlockInstance, REGISTRY};
use standstill_fb::flat::{Flat, Layout, Pointer, read_record, read_table};
use standstill_fb::ring::{FlatRecord, RECORD_SIZE};
use standstill_fb::{AnyInstance, Block, BlockInfo, Context, Instance, PinType, TableRef, Value};
use std::sync::LazyLock;

/// Largest number of lines that a guest may write in one scan; further ones are counted.
const LINES_MOST: usize = 16;

/// Largest number of bytes of a line; the rest is cut off.
const LINE_MOST: u32 = 1024;

/// The results of the blocks' functions; numbers and meanings are those of the C library.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Code {
    /// Done.
    Ok = 0,
    /// An address is 0.
    NullPointer = -1,
    /// The size in front of a structure is smaller than the structure.
    StructSize = -2,
    /// A block or `log_read` was called in `plc_init`.
    NotInTick = -7,
    /// No instance has this key.
    UnknownKey = -10,
    /// The key belongs to an instance of another block.
    WrongBlock = -11,
    /// The guest already has [`INSTANCES_MOST`] instances.
    NoRoom = -12,
    /// An array has more records than its block accepts, or records at address 0.
    Table = -17,
}

/// The permitted imports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Import {
    Log,
    /// Records of the diagnostic ring.
    LogRead,
    /// A function of one number, by its index in [`FUNCTIONS`].
    Function(usize),
    /// A function of two numbers, by its index in [`FUNCTIONS_OF_TWO`].
    FunctionOfTwo(usize),
    /// A block, by its index in the registry.
    Block(usize),
}

type OfOne = fn(f64) -> f64;

type OfTwo = fn(f64, f64) -> f64;

/// Functions of one number: names and implementations. In software, so that their bits are the same
/// everywhere.
pub(crate) const FUNCTIONS: [(&str, OfOne); 9] = [
    ("math_acos", libm::acos),
    ("math_asin", libm::asin),
    ("math_atan", libm::atan),
    ("math_cos", libm::cos),
    ("math_exp", libm::exp),
    ("math_ln", libm::log),
    ("math_log", libm::log10),
    ("math_sin", libm::sin),
    ("math_tan", libm::tan),
];

/// Functions of two numbers.
pub(crate) const FUNCTIONS_OF_TWO: [(&str, OfTwo); 2] =
    [("math_atan2", libm::atan2), ("math_pow", libm::pow)];

macro_rules! names {
    ($($group:ident :: $name:ident :: $block:ident)*) => {
        /// Names of the blocks' functions, in the order of the registry.
        const NAMES: &[&str] = &[$(stringify!($name)),*];
    };
}

standstill_blocks::for_every_block!(names);

impl Import {
    pub(crate) fn find(name: &str) -> Option<Self> {
        match name {
            "log" => return Some(Self::Log),
            "log_read" => return Some(Self::LogRead),
            _ => {}
        }
        if let Some(place) = FUNCTIONS.iter().position(|(known, _)| *known == name) {
            return Some(Self::Function(place));
        }
        if let Some(place) = FUNCTIONS_OF_TWO.iter().position(|(known, _)| *known == name) {
            return Some(Self::FunctionOfTwo(place));
        }
        NAMES.iter().position(|known| *known == name).map(Self::Block)
    }
}

/// The layout of a block's pins, computed once.
struct Shape {
    info: &'static BlockInfo,
    inputs: Layout,
    outputs: Layout,
    /// Number of values of its arrays when they are full.
    cells: usize,
}

static SHAPES: LazyLock<Vec<Shape>> = LazyLock::new(|| {
    let shape = |info: &'static BlockInfo| Shape {
        info,
        inputs: info.flat_inputs(Pointer::Bits32),
        outputs: info.flat_outputs(),
        cells: info
            .tables()
            .map(|(_, pin)| match pin.ty {
                PinType::Table(table) => table.most * table.fields.len(),
                _ => 0,
            })
            .sum(),
    };
    REGISTRY.iter().map(shape).collect()
});

/// The instances of a guest, and its messages.
#[derive(Clone, Debug)]
pub(crate) struct Host {
    first: u16,
    /// With the index of their block in the registry; an instance's key is its index here, from 1.
    slots: Vec<(usize, BlockInstance)>,
    cells: Vec<f64>,
    told: Vec<Told>,
    lines: usize,
    lost: u64,
}

/// A range of the guest's memory.
struct Place {
    function: &'static str,
    what: &'static str,
    address: u32,
    bytes: usize,
}

impl Place {
    fn fault(&self, memory: usize) -> Fault {
        Fault::Pointer {
            function: self.function,
            what: self.what,
            address: self.address,
            bytes: self.bytes as u64,
            memory: memory as u64,
        }
    }

    fn of<'m>(&self, memory: &'m [u8]) -> Result<&'m [u8], Fault> {
        let rest = memory.get(self.address as usize..);
        let there = rest.and_then(|rest| rest.get(..self.bytes));
        there.ok_or_else(|| self.fault(memory.len()))
    }

    fn of_mut<'m>(&self, memory: &'m mut [u8]) -> Result<&'m mut [u8], Fault> {
        let fault = self.fault(memory.len());
        let rest = memory.get_mut(self.address as usize..);
        rest.and_then(|rest| rest.get_mut(..self.bytes)).ok_or(fault)
    }
}

impl Host {
    pub(crate) fn new(first: u16) -> Self {
        Self {
            first,
            slots: Vec::new(),
            cells: vec![0.0; SHAPES.iter().map(|shape| shape.cells).max().unwrap_or(0)],
            told: Vec::new(),
            lines: 0,
            lost: 0,
        }
    }

    pub(crate) fn take_told(&mut self) -> Vec<Told> {
        if self.lost > 0 {
            self.told.push(Told::LinesLost(self.lost));
        }
        self.lines = 0;
        self.lost = 0;
        std::mem::take(&mut self.told)
    }

    pub(crate) fn log(&mut self, memory: &[u8], address: u32, bytes: u32) -> Result<(), Fault> {
        let text = Place {
            function: "log",
            what: "text",
            address,
            bytes: bytes as usize,
        }
        .of(memory)?;
        if self.lines >= LINES_MOST {
            self.lost += 1;
            return Ok(());
        }
        self.lines += 1;
        let text = text.get(..bytes.min(LINE_MOST) as usize).unwrap_or(text);
        // Notes are single lines: characters that end a line or move a terminal's cursor are shown in
        // escaped form.
        let text = String::from_utf8_lossy(text);
        let clean = |c: char| if c.is_control() { '\u{fffd}' } else { c };
        self.told.push(Told::Line(text.chars().map(clean).collect()));
        Ok(())
    }

    /// Copies records of the ring, from number `*next` on; the arguments are those of the C library's `log_read`.
    pub(crate) fn log_read(
        &self,
        memory: &mut [u8],
        [next, records, stride, room, copied]: [u32; 5],
        log: &Log,
    ) -> Result<Code, Fault> {
        if next == 0 || copied == 0 || (records == 0 && room > 0) {
            return Ok(Code::NullPointer);
        }
        if (stride as usize) < RECORD_SIZE {
            return Ok(Code::StructSize);
        }
        let place = |what, address, bytes| Place {
            function: "log_read",
            what,
            address,
            bytes,
        };
        let next = place("next", next, 8);
        let copied = place("copied", copied, 4);
        // Both fit into 64 bits; a value that a 32-bit processor cannot count is outside the memory.
        let bytes = usize::try_from(u64::from(stride) * u64::from(room)).unwrap_or(usize::MAX);
        let records = place("records", records, bytes);
        let from = u64::read(next.of(memory)?, 0);
        copied.of(memory)?;
        let rows = records.of_mut(memory)?.chunks_exact_mut(stride as usize);
        // Records no longer in the ring are skipped.
        let total = log.total();
        let first = total.saturating_sub(log.since(from).count() as u64);
        let mut count = 0_u32;
        for (row, record) in rows.zip(log.since(from)) {
            let number = first + u64::from(count);
            FlatRecord::new(number, self.key_of(record.instance), record).put_flat(row);
            count += 1;
        }
        (first + u64::from(count)).write(next.of_mut(memory)?, 0);
        count.write(copied.of_mut(memory)?, 0);
        Ok(Code::Ok)
    }

    /// The key of an instance with this number in records; 0 if the guest has none.
    fn key_of(&self, id: InstanceId) -> u32 {
        let index = id.0.checked_sub(self.first).map(usize::from);
        match index {
            Some(index) if index < self.slots.len() => index as u32 + 1,
            _ => 0,
        }
    }

    /// One call of a block in a scan: any block, with all checks.
    pub(crate) fn block<P: Planner>(
        &mut self,
        block: usize,
        memory: &mut [u8],
        [key, inputs, outputs]: [u32; 3],
        context: &mut Context<'_, P>,
    ) -> Result<Result<(), Code>, Fault> {
        let (Some(shape), Some(&function)) = (SHAPES.get(block), NAMES.get(block)) else {
            return Ok(Err(Code::UnknownKey));
        };
        if key == 0 || inputs == 0 || outputs == 0 {
            return Ok(Err(Code::NullPointer));
        }
        let place = |what, address, bytes| Place {
            function,
            what,
            address,
            bytes,
        };
        for (what, address, size) in [
            ("in", inputs, shape.inputs.size),
            ("out", outputs, shape.outputs.size),
        ] {
            let told = u32::read(place(what, address, 4).of(memory)?, 0);
            if (told as usize) < size {
                return Ok(Err(Code::StructSize));
            }
        }
        let flat = place("in", inputs, shape.inputs.size).of(memory)?;
        if let Err(code) = self.load_tables(shape, function, flat, memory)? {
            return Ok(Err(code));
        }
        place("out", outputs, shape.outputs.size).of(memory)?;
        let mut number = u64::read(place("key", key, 8).of(memory)?, 0);
        if number == 0 {
            match self.make(block, shape, key) {
                Ok(made) => number = made,
                Err(code) => return Ok(Err(code)),
            }
            let made = place("key", key, 8).of_mut(memory)?;
            number.write(made, 0);
        }
        let slot = usize::try_from(number)
            .ok()
            .and_then(|number| number.checked_sub(1));
        let Some((index, (found, instance))) = slot.and_then(|slot| Some((slot, self.slots.get_mut(slot)?)))
        else {
            return Ok(Err(Code::UnknownKey));
        };
        if *found != block {
            return Ok(Err(Code::WrongBlock));
        }
        let flat = place("in", inputs, shape.inputs.size).of(memory)?;
        instance.set_flat(flat, Pointer::Bits32);
        set_tables(shape, instance, flat);
        let mut inner = Context {
            now_ns: context.now_ns,
            // At most INSTANCES_MOST.
            scope: context
                .scope
                .with(InstanceId(self.first.saturating_add(index as u16))),
            axes: &mut *context.axes,
            tables: &self.cells,
        };
        instance.call(&mut inner);
        instance.put_flat(place("out", outputs, shape.outputs.size).of_mut(memory)?);
        Ok(Ok(()))
    }

    /// The instance with this key and its number in records, if it is of the given kind of block. None if there is
    /// no such instance, or the key is 0.
    #[inline]
    pub(crate) fn find<B>(
        &mut self,
        number: u64,
        as_block: impl Fn(&mut BlockInstance) -> Option<&mut Instance<B>>,
    ) -> Option<(InstanceId, &mut Instance<B>)>
    where
        B: Block,
    {
        let index = usize::try_from(number).ok()?.checked_sub(1)?;
        let (_, instance) = self.slots.get_mut(index)?;
        // At most INSTANCES_MOST.
        let id = InstanceId(self.first.saturating_add(index as u16));
        Some((id, as_block(instance)?))
    }

    /// Makes a new instance and returns its key.
    fn make(&mut self, block: usize, shape: &Shape, key: u32) -> Result<u64, Code> {
        if self.slots.len() >= INSTANCES_MOST {
            return Err(Code::NoRoom);
        }
        let instance = BlockInstance::new(shape.info.name).ok_or(Code::NoRoom)?;
        self.told.push(Told::Made {
            id: InstanceId(self.first.saturating_add(self.slots.len() as u16)),
            number: self.slots.len() + 1,
            block: shape.info.name,
            key,
        });
        self.slots.push((block, instance));
        Ok(self.slots.len() as u64)
    }

    /// Copies the records of a block's arrays, one array behind the other.
    fn load_tables(
        &mut self,
        shape: &Shape,
        function: &'static str,
        flat: &[u8],
        memory: &[u8],
    ) -> Result<Result<(), Code>, Fault> {
        let mut cells = &mut self.cells[..];
        if shape.cells == 0 {
            return Ok(Ok(()));
        }
        for (index, pin) in shape.info.tables() {
            let PinType::Table(table) = pin.ty else { continue };
            let (address, count) = read_table(flat, shape.inputs.offset(index), Pointer::Bits32);
            let count = count as usize;
            if count > table.most || (count > 0 && address == 0) {
                return Ok(Err(Code::Table));
            }
            let record = Layout::of_record(table.fields);
            let bytes = Place {
                function,
                what: pin.name,
                // Read as 32 bits.
                address: address as u32,
                bytes: count * record.size,
            };
            for row in bytes.of(memory)?.chunks_exact(record.size) {
                let Some((cells_of_row, rest)) = cells.split_at_mut_checked(table.fields.len()) else {
                    return Ok(Err(Code::Table));
                };
                read_record(row, table.fields, &record, cells_of_row);
                cells = rest;
            }
        }
        Ok(Ok(()))
    }
}

/// Gives a block the places where [`Host::load_tables`] put its records.
fn set_tables(shape: &Shape, instance: &mut BlockInstance, flat: &[u8]) {
    let mut first = 0_u32;
    for (index, pin) in shape.info.tables() {
        let PinType::Table(table) = pin.ty else { continue };
        let (_, count) = read_table(flat, shape.inputs.offset(index), Pointer::Bits32);
        // Both were checked against the largest number of records of the table.
        let place = TableRef {
            first,
            records: count as u16,
        };
        let _fits = instance.set(index, Value::Table(place));
        first += count * table.fields.len() as u32;
    }
}
