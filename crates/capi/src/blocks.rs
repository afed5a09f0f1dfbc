//! A function for every block of the registry. Their declarations are in `standstill_blocks.h`.

use crate::enter::{When, enter, running};
use crate::runtime::{Inner, Runtime};
use crate::{Code, raw};
use core::marker::PhantomData;
use core::slice;
use standstill_blocks::BlockInstance;
use standstill_fb::flat::{Layout, Pointer, read_record, read_table};
use standstill_fb::{Block, Described, Instance, PinType, Pins, TableRef, Value};

/// Sizes of the structures of `B`.
struct Sizes<B>(PhantomData<B>);

impl<B: Block> Sizes<B> {
    const INPUTS: usize = Layout::of_pins(<B::Inputs as Pins>::PINS, Pointer::NATIVE).size;
    const OUTPUTS: usize = Layout::of_pins(<B::Outputs as Pins>::PINS, Pointer::NATIVE).size;
}

/// One call of an instance of `B`. A key of 0 creates the instance first.
///
/// # Safety
/// As for every function of `standstill_blocks.h`: each pointer is null or valid for as many bytes as its
/// size field says, and arrays have as many records as their count.
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
    // SAFETY: by contract null, or long enough for a size field.
    unsafe {
        raw::check_size(inputs, Sizes::<B>::INPUTS)?;
        raw::check_size(outputs, Sizes::<B>::OUTPUTS)?;
    }
    // SAFETY: not null, and as long as its size field says. Nothing writes there while it is used: the
    // outputs are written later.
    let flat = unsafe { slice::from_raw_parts(inputs, Sizes::<B>::INPUTS) };
    if const { B::INFO.has_tables() } {
        // SAFETY: by contract arrays are as long as their counts.
        unsafe { load_tables::<B>(inner, inputs, flat)? };
    }
    // SAFETY: not null; it may be unaligned.
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
    // SAFETY: not null, and as long as its size field says. The inputs are not used any more, in case the
    // two overlap.
    let shown = unsafe { raw::bytes_mut(outputs, Sizes::<B>::OUTPUTS) };
    instance.outputs.put_flat(shown);
    Ok(())
}

/// Copies the records of a block's arrays into the numbers of the runtime, one array behind the other.
///
/// # Safety
/// `flat` are the bytes at `inputs`, and every address in them has as many records as its count says.
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
        // SAFETY: the layout has an address there. It is read as a pointer and not as a number, so that
        // it keeps its provenance.
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
            // SAFETY: by contract these records exist.
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

/// Gives a block the places where [`load_tables`] put its records.
fn set_tables<B: Block + Described>(instance: &mut Instance<B>, flat: &[u8]) {
    let layout = B::INFO.flat_inputs(Pointer::NATIVE);
    let mut first = 0_u32;
    for (index, pin) in B::INFO.tables() {
        let PinType::Table(table) = pin.ty else { continue };
        let (_, count) = read_table(flat, layout.offset(index), Pointer::NATIVE);
        // Both were checked against the largest number of records of the table.
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
        /// Each pointer is null or valid for as many bytes as its size field says, and arrays have as
        /// many records as their count. Nothing else changes them during the call.
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
