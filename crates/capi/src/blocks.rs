//! A function for every block of the registry. Their declarations stand in `standstill_blocks.h`.

use crate::enter::{When, enter, running};
use crate::runtime::{Inner, Runtime};
use crate::{Code, raw};
use core::marker::PhantomData;
use core::slice;
use standstill_blocks::BlockInstance;
use standstill_fb::flat::{Layout, Pointer, read_record, read_table};
use standstill_fb::{Block, Described, Instance, PinType, Pins, TableRef, Value};

/// Bytes of the structures of `B`.
struct Sizes<B>(PhantomData<B>);

impl<B: Block> Sizes<B> {
    const INPUTS: usize = Layout::of_pins(<B::Inputs as Pins>::PINS, Pointer::NATIVE).size;
    const OUTPUTS: usize = Layout::of_pins(<B::Outputs as Pins>::PINS, Pointer::NATIVE).size;
}

/// One call of an instance of `B`, made first if its key is 0.
///
/// # Safety
/// As every function of `standstill_blocks.h`: each pointer is null or leads to what its type says, as long as the size
/// in front tells, and arrays to as many records as their count.
unsafe fn call<B: Block + Described>(
    inner: &mut Inner,
    key: *mut u64,
    inputs: *const u8,
    outputs: *mut u8,
    make: impl Fn(Instance<B>) -> BlockInstance,
    find: impl Fn(&mut BlockInstance) -> Option<&mut Instance<B>>,
) -> Result<(), Code> {
    running(inner)?;
    if key.is_null() {
        return Err(Code::NullPointer);
    }
    // SAFETY: null, or long enough for a size, by the contract.
    unsafe {
        raw::check_size(inputs, Sizes::<B>::INPUTS)?;
        raw::check_size(outputs, Sizes::<B>::OUTPUTS)?;
    }
    // SAFETY: not null, and as long as its size told. Nothing writes there while it is used: the outputs are written
    // later.
    let flat = unsafe { slice::from_raw_parts(inputs, Sizes::<B>::INPUTS) };
    if const { B::INFO.has_tables() } {
        // SAFETY: the contract says that arrays are as long as their counts.
        unsafe { load_tables::<B>(inner, inputs, flat)? };
    }
    // SAFETY: not null; its place may be odd.
    let mut number = unsafe { key.read_unaligned() };
    if number == 0 {
        number = inner.create(make(Instance::default()))?;
        // SAFETY: as for reading.
        unsafe { key.write_unaligned(number) };
    }
    let (instance, mut context) = inner.instance(number, find)?;
    if const { B::INFO.has_tables() } {
        set_tables(instance, flat);
    }
    instance.call_flat(flat, Pointer::NATIVE, &mut context);
    // SAFETY: not null, and as long as its size told; the inputs are not used any more, should they overlap.
    let shown = unsafe { raw::bytes_mut(outputs, Sizes::<B>::OUTPUTS) };
    instance.outputs.put_flat(shown);
    Ok(())
}

/// Copies the records of a block's arrays into the numbers of the runtime, one array behind the other.
///
/// # Safety
/// `flat` are the bytes at `inputs`, and every address in there leads to as many records as its count says.
unsafe fn load_tables<B: Block + Described>(
    inner: &mut Inner,
    inputs: *const u8,
    flat: &[u8],
) -> Result<(), Code> {
    let layout = B::INFO.flat_inputs(Pointer::NATIVE);
    let mut cells = &mut inner.cells[..];
    for (index, pin) in B::INFO.tables() {
        let PinType::Table(table) = pin.ty else { continue };
        let (_, count) = read_table(flat, layout.offset(index), Pointer::NATIVE);
        let count = count as usize;
        // SAFETY: the layout puts an address there. Read as one, and not as a number, it keeps what it leads to.
        let first = unsafe {
            inputs
                .add(layout.offset(index))
                .cast::<*const u8>()
                .read_unaligned()
        };
        if count > table.most || (count > 0 && first.is_null()) {
            return Err(Code::Table);
        }
        let record = Layout::of_record(table.fields);
        for row in 0..count {
            // SAFETY: the caller says that so many records are there.
            let bytes = unsafe { slice::from_raw_parts(first.add(row * record.size), record.size) };
            let (cells_of_row, rest) = cells
                .split_at_mut_checked(table.fields.len())
                .ok_or(Code::Table)?;
            read_record(bytes, table.fields, &record, cells_of_row);
            cells = rest;
        }
    }
    Ok(())
}

/// Tells a block where [`load_tables`] put its records.
fn set_tables<B: Block + Described>(instance: &mut Instance<B>, flat: &[u8]) {
    let layout = B::INFO.flat_inputs(Pointer::NATIVE);
    let mut first = 0_u32;
    for (index, pin) in B::INFO.tables() {
        let PinType::Table(table) = pin.ty else { continue };
        let (_, count) = read_table(flat, layout.offset(index), Pointer::NATIVE);
        // Both were checked against the most records of the table.
        let place = TableRef {
            first,
            records: count as u16,
        };
        let _fits = instance.inputs.set(index, Value::Table(place));
        first += count * table.fields.len() as u32;
    }
}

macro_rules! functions {
    ($($group:ident :: $name:ident :: $block:ident)*) => {$(
        #[doc = concat!("One call of [`", stringify!($block), "`](standstill_blocks::", stringify!($group), "::",
            stringify!($name), "): see `standstill_blocks.h`.")]
        ///
        /// # Safety
        /// Each pointer is null or leads to what its type says, as long as the size in front tells, and arrays to as
        /// many records as their count; nothing else changes them during the call.
        #[unsafe(export_name = concat!(env!("STANDSTILL_SYMBOLS"), "_", stringify!($name)))]
        pub unsafe extern "C" fn $name(
            runtime: *mut Runtime,
            key: *mut u64,
            inputs: *const u8,
            outputs: *mut u8,
        ) -> i32 {
            type Own = Instance<standstill_blocks::$group::$name::$block>;
            fn find(block: &mut BlockInstance) -> Option<&mut Own> {
                match block {
                    BlockInstance::$block(instance) => Some(instance),
                    _ => None,
                }
            }
            // SAFETY: passed on.
            unsafe {
                enter(runtime, When::InTick, |inner| {
                    call(inner, key, inputs, outputs, BlockInstance::$block, find)
                })
            }
        }
    )*};
}

standstill_blocks::for_every_block!(functions);
