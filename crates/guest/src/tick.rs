//! A scan, in which the functions of a guest find the context of blocks.
//!
//! The interpreter keeps its functions as long as the guest, but a scan lends its axes for one call of
//! the guest. So the context is stored in a thread-local variable during the call, without the type of
//! its planner, which functions do not know.

use crate::Fault;
use crate::engine::Machine;
use crate::host::{Code, Host};
use scoped_tls_hkt::scoped_thread_local;
use standstill_axis::Planner;
use standstill_blocks::BlockInstance;
use standstill_fb::flat::{Flat, Layout, Pointer};
use standstill_fb::{Block, Context, Described, Instance, Pins};
use std::cell::Cell;
use std::marker::PhantomData;

scoped_thread_local!(pub(crate) static TICK: for<'a> &'a (dyn Tick + 'a));

/// The context lent by a scan; a block takes it out while it uses it.
struct Lent<'l, 'c, P: Planner>(Cell<Option<&'l mut Context<'c, P>>>);

/// No scan: the value while a guest starts.
struct NoTick;

/// Runs `work` without a scan, so blocks cannot be called.
pub(crate) fn before<R>(work: impl FnOnce() -> R) -> R {
    TICK.set(&NoTick, work)
}

/// One execution of a guest; its functions can use `context` meanwhile.
#[inline]
pub(crate) fn scan<P: Planner>(
    machine: &mut Machine,
    entry: usize,
    context: &mut Context<'_, P>,
    fuel: u64,
) -> Result<u64, Box<Fault>> {
    // A tick is the number of the scan, in 32 bits.
    let (tick, now_ns) = (context.scope.scan as i32, context.now_ns);
    during(
        &Lent(Cell::new(Some(context))),
        machine,
        entry,
        (tick, now_ns),
        fuel,
    )
}

/// The same for every planner, so that it is beside the variable and accesses it directly.
fn during(
    lent: &dyn Tick,
    machine: &mut Machine,
    entry: usize,
    (tick, now_ns): (i32, i64),
    fuel: u64,
) -> Result<u64, Box<Fault>> {
    TICK.set(lent, || machine.scan(entry, tick, now_ns, fuel))
}

/// A code, of 64 bits so that it comes back in a register; or a fault that ends the guest.
pub(crate) type Answer = Result<i64, Box<Fault>>;

/// The implementation of `log_read`.
pub(crate) fn log_read(host: &mut Host, memory: &mut [u8], given: [u32; 5]) -> Answer {
    let outcome = TICK.with(|tick| tick.log_read(host, memory, given));
    outcome.map(|code| code as i64).map_err(Box::new)
}

/// The structure at an address: this many of its bytes, if they exist and its size field is as large.
#[inline]
fn structure(memory: &[u8], address: u32, size: usize) -> Option<&[u8]> {
    let bytes = memory.get(address as usize..)?.get(..size)?;
    (address != 0 && u32::read(bytes, 0) as usize >= size).then_some(bytes)
}

/// Bytes of the structures of `B`.
struct Sizes<B>(PhantomData<B>);

impl<B: Block> Sizes<B> {
    const INPUTS: usize = Layout::of_pins(<B::Inputs as Pins>::PINS, Pointer::Bits32).size;
    const OUTPUTS: usize = Layout::of_pins(<B::Outputs as Pins>::PINS, Pointer::Bits32).size;
}

/// Finds the instance of one kind of block.
type Find<B> = fn(&mut BlockInstance) -> Option<&mut Instance<B>>;

/// A call with valid addresses of an existing instance. In any other case nothing has happened.
#[inline]
fn call<B: Block + Described, P: Planner>(
    host: &mut Host,
    memory: &mut [u8],
    [key, inputs, outputs]: [u32; 3],
    context: &mut Context<'_, P>,
    own: Find<B>,
) -> Option<()> {
    if key == 0 || const { B::INFO.has_tables() } {
        return None;
    }
    structure(memory, outputs, Sizes::<B>::OUTPUTS)?;
    let flat = structure(memory, inputs, Sizes::<B>::INPUTS)?;
    let (instance, mut context) = instance(host, memory, key, context, own)?;
    instance.call_flat(flat, Pointer::Bits32, &mut context);
    let shown = memory
        .get_mut(outputs as usize..)?
        .get_mut(..Sizes::<B>::OUTPUTS)?;
    instance.outputs.put_flat(shown);
    Some(())
}

/// The instance with the key at an address, and its context.
#[inline]
fn instance<'h, B: Block, P: Planner>(
    host: &'h mut Host,
    memory: &[u8],
    key: u32,
    context: &'h mut Context<'_, P>,
    own: Find<B>,
) -> Option<(&'h mut Instance<B>, Context<'h, P>)> {
    let number = memory.get(key as usize..)?.first_chunk()?;
    let (id, instance) = host.find(u64::from_le_bytes(*number), own)?;
    let context = Context {
        now_ns: context.now_ns,
        scope: context.scope.with(id),
        axes: &mut *context.axes,
        tables: &[],
    };
    Some((instance, context))
}

/// A call with all checks.
fn look<P: Planner>(
    block: usize,
    host: &mut Host,
    memory: &mut [u8],
    addresses: [u32; 3],
    context: &mut Context<'_, P>,
) -> Answer {
    let outcome = host.block(block, memory, addresses, context)?;
    Ok(outcome.map_or_else(|code| code as i64, |()| 0))
}

macro_rules! functions {
    ($($group:ident :: $name:ident :: $block:ident)*) => {
        /// The scan of some planner, and the calls that it permits.
        pub(crate) trait Tick {
            fn log_read(&self, _: &mut Host, _: &mut [u8], _: [u32; 5]) -> Result<Code, Fault> {
                Ok(Code::NotInTick)
            }

            $(fn $name(&self, _: &mut Host, _: &mut [u8], _: u32, _: u32, _: u32) -> Answer {
                Ok(Code::NotInTick as i64)
            })*
        }

        impl Tick for NoTick {}

        impl<P: Planner> Tick for Lent<'_, '_, P> {
            fn log_read(&self, host: &mut Host, memory: &mut [u8], given: [u32; 5]) -> Result<Code, Fault> {
                let Some(context) = self.0.take() else {
                    return Ok(Code::NotInTick);
                };
                let outcome = host.log_read(memory, given, context.scope.log);
                self.0.set(Some(context));
                outcome
            }

            $(fn $name(
                &self,
                host: &mut Host,
                memory: &mut [u8],
                key: u32,
                inputs: u32,
                outputs: u32,
            ) -> Answer {
                fn own(block: &mut BlockInstance) -> Option<&mut Instance<standstill_blocks::$group::$name::$block>> {
                    match block {
                        BlockInstance::$block(instance) => Some(instance),
                        _ => None,
                    }
                }
                let Some(context) = self.0.take() else {
                    return Ok(Code::NotInTick as i64);
                };
                let addresses = [key, inputs, outputs];
                let outcome = match call(host, memory, addresses, context, own) {
                    Some(()) => Ok(0),
                    None => look(Place::$name as usize, host, memory, addresses, context),
                };
                self.0.set(Some(context));
                outcome
            })*
        }

        /// Places in the registry.
        #[allow(non_camel_case_types)]
        enum Place {
            $($name),*
        }
    };
}

standstill_blocks::for_every_block!(functions);
