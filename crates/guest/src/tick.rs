//! A scan, where the functions of a guest find what blocks may touch.
//!
//! The interpreter keeps its functions for as long as the guest, and a scan lends its axes for one call of the guest. So
//! they stand in a variable of the thread for as long as that call, without their planner, which functions do not know.

use crate::Fault;
use crate::host::{Code, Host};
use scoped_tls_hkt::scoped_thread_local;
use standstill_axis::Planner;
use standstill_blocks::BlockInstance;
use standstill_fb::flat::{Flat, Layout, Pointer};
use standstill_fb::{Block, Context, Described, Instance, Pins};
use std::cell::Cell;

scoped_thread_local!(static TICK: for<'a> &'a (dyn Tick + 'a));

/// The scan of some planner.
struct Lent<'l, 'c, P: Planner>(Cell<Option<&'l mut Context<'c, P>>>);

/// No scan: what stands there while a guest starts.
struct NoTick;

/// Whether blocks can be called while `work` is at it: not.
pub(crate) fn before<R>(work: impl FnOnce() -> R) -> R {
    TICK.set(&NoTick, work)
}


/// Lends `context` to the functions of a guest while `work` is at it.
#[inline]
pub(crate) fn during<P: Planner, R>(context: &mut Context<'_, P>, work: impl FnOnce() -> R) -> R {
    TICK.set(&Lent(Cell::new(Some(context))), work)
}

/// The function of a block: a call with the addresses of key, inputs and outputs. Its result, or a fault that ends the
/// guest.
pub(crate) type Function = fn(&mut Host, &mut [u8], [u32; 3]) -> Result<i32, Box<Fault>>;

/// The structure at an address: so many of its bytes, if they are there and the size in front is as large.
#[inline(always)]
fn structure(memory: &[u8], address: u32, size: usize) -> Option<&[u8]> {
    let bytes = memory.get(address as usize..)?.get(..size)?;
    (address != 0 && u32::read(bytes, 0) as usize >= size).then_some(bytes)
}

/// What a guest does in almost every scan: a call of an instance that is there, with addresses that are good. Nothing
/// happened if there is anything else about it.
#[inline(always)]
fn glance<B: Block + Described, P: Planner>(
    host: &mut Host,
    memory: &mut [u8],
    [key, inputs, outputs]: [u32; 3],
    context: &mut Context<'_, P>,
    as_block: impl Fn(&mut BlockInstance) -> Option<&mut Instance<B>>,
) -> Option<()> {
    let (inputs_size, outputs_size) = const {
        let inputs = Layout::of_pins(<B::Inputs as Pins>::PINS, Pointer::Bits32);
        let outputs = Layout::of_pins(<B::Outputs as Pins>::PINS, Pointer::Bits32);
        (inputs.size, outputs.size)
    };
    if key == 0 || const { B::INFO.has_tables() } {
        return None;
    }
    structure(memory, outputs, outputs_size)?;
    let flat = structure(memory, inputs, inputs_size)?;
    let number = u64::from_le_bytes(*memory.get(key as usize..)?.first_chunk()?);
    let (id, instance) = host.find(number, as_block)?;
    let mut inner = Context {
        now_ns: context.now_ns,
        scan: context.scan,
        instance: id,
        axes: &mut *context.axes,
        log: &mut *context.log,
        tables: &[],
    };
    if !instance.rests_with(flat, Pointer::Bits32, &mut inner) {
        instance.wake(flat, Pointer::Bits32, &mut inner);
    }
    let shown = memory.get_mut(outputs as usize..)?.get_mut(..outputs_size)?;
    instance.outputs.put_flat(shown);
    Some(())
}

/// A call with whatever there may be about it.
#[inline(never)]
fn look<P: Planner>(
    block: usize,
    host: &mut Host,
    memory: &mut [u8],
    addresses: [u32; 3],
    context: &mut Context<'_, P>,
) -> Result<i32, Box<Fault>> {
    let outcome = host.block(block, memory, addresses, context)?;
    Ok(outcome.map_or_else(|code| code as i32, |()| Code::Ok as i32))
}

macro_rules! functions {
    ($($group:ident :: $name:ident :: $block:ident)*) => {
        /// The scan of some planner: every block, called with its place in the registry first.
        trait Tick {
            $(fn $name(&self, _: usize, _: &mut Host, _: &mut [u8], _: [u32; 3]) -> Result<i32, Box<Fault>> {
                Ok(Code::NotInTick as i32)
            })*
        }

        impl Tick for NoTick {}

        impl<P: Planner> Tick for Lent<'_, '_, P> {
            $(fn $name(
                &self,
                block: usize,
                host: &mut Host,
                memory: &mut [u8],
                addresses: [u32; 3],
            ) -> Result<i32, Box<Fault>> {
                fn own(block: &mut BlockInstance) -> Option<&mut Instance<standstill_blocks::$group::$name::$block>> {
                    match block {
                        BlockInstance::$block(instance) => Some(instance),
                        _ => None,
                    }
                }
                let Some(context) = self.0.take() else {
                    return Ok(Code::NotInTick as i32);
                };
                let outcome = match glance(host, memory, addresses, context, own) {
                    Some(()) => Ok(Code::Ok as i32),
                    None => look(block, host, memory, addresses, context),
                };
                self.0.set(Some(context));
                outcome
            })*
        }

        #[allow(non_camel_case_types)]
        enum Place {
            $($name),*
        }

        /// The functions of the blocks, in the order of the registry.
        pub(crate) const FUNCTIONS: &[Function] = &[$(
            |host, memory, addresses| {
                TICK.with(|tick| tick.$name(Place::$name as usize, host, memory, addresses))
            }
        ),*];
    };
}

standstill_blocks::for_every_block!(functions);
