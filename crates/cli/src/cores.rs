//! Work on all processors; results are taken in order.

use crate::exit::Failure;
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

/// Largest number of results per thread that wait to be taken, because they need memory.
const AHEAD: usize = 2;

/// Stack of a thread (bytes), the same as the main one's: files may be nested as deep as the reader
/// permits.
const STACK: usize = 8 << 20;

/// Time between two reports of progress.
const PERIOD: Duration = Duration::from_millis(50);

/// The progress of the work.
struct State<T> {
    /// Number of pieces that were begun.
    begun: usize,
    /// Number of results that were taken.
    taken: usize,
    /// Results that wait to be taken. Work that panicked counts as done: the panic continues where it is taken.
    done: BTreeMap<usize, thread::Result<T>>,
    /// No more results are needed.
    is_over: bool,
}

struct Shared<T> {
    state: Mutex<State<T>>,
    changed: Condvar,
    count: usize,
    ahead: usize,
}

impl<T> Shared<T> {
    fn lock(&self) -> MutexGuard<'_, State<T>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The number of the next piece of work; none if there is no more.
    fn next(&self) -> Option<usize> {
        let is_far = |state: &mut State<T>| {
            !state.is_over && state.begun < self.count && state.begun >= state.taken + self.ahead
        };
        let held = self.changed.wait_while(self.lock(), is_far);
        let mut state = held.unwrap_or_else(PoisonError::into_inner);
        if state.is_over || state.begun >= self.count {
            return None;
        }
        state.begun += 1;
        Some(state.begun - 1)
    }

    /// The result of piece `index`; none if it is not done after a while.
    fn take(&self, index: usize) -> Option<T> {
        let is_missing = |state: &mut State<T>| !state.done.contains_key(&index);
        let held = self.changed.wait_timeout_while(self.lock(), PERIOD, is_missing);
        let (mut state, _) = held.unwrap_or_else(PoisonError::into_inner);
        let result = state.done.remove(&index)?;
        state.taken = index + 1;
        drop(state);
        self.changed.notify_all();
        Some(result.unwrap_or_else(|panic| resume_unwind(panic)))
    }
}

/// Ends the work when it is dropped, in every case.
struct End<'s, T>(&'s Shared<T>);

impl<T> Drop for End<'_, T> {
    fn drop(&mut self) {
        self.0.lock().is_over = true;
        self.0.changed.notify_all();
    }
}

/// The number of threads: as many as processors.
pub fn processors() -> usize {
    thread::available_parallelism().map_or(1, usize::from)
}

/// Does `work` for 0, 1, .. below `count` on `threads` threads, and passes each result to `take`, in this order.
/// While a result is not ready, `take` receives nothing, at once and then from time to time.
///
/// # Errors
/// The first error of `take`; running work is finished first.
pub fn in_order<T: Send>(
    count: usize,
    threads: usize,
    work: impl Fn(usize) -> T + Sync,
    mut take: impl FnMut(usize, Option<T>) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let threads = threads.clamp(1, count.max(1));
    let shared = Shared {
        state: Mutex::new(State {
            begun: 0,
            taken: 0,
            done: BTreeMap::new(),
            is_over: false,
        }),
        changed: Condvar::new(),
        count,
        ahead: AHEAD * threads,
    };
    let work = &work;
    let worker = || {
        while let Some(index) = shared.next() {
            let result = catch_unwind(AssertUnwindSafe(|| work(index)));
            shared.lock().done.insert(index, result);
            shared.changed.notify_all();
        }
    };
    thread::scope(|scope| {
        let _end = End(&shared);
        let spawn = |_| {
            thread::Builder::new()
                .stack_size(STACK)
                .spawn_scoped(scope, worker)
                .is_ok()
        };
        // If no more threads are available, the existing ones do the work. Some systems have none.
        if (0..threads).take_while(|number| spawn(*number)).count() == 0 {
            return (0..count).try_for_each(|index| {
                take(index, None)?;
                take(index, Some(work(index)))
            });
        }
        (0..count).try_for_each(|index| {
            take(index, None)?;
            loop {
                let result = shared.take(index);
                let is_done = result.is_some();
                take(index, result)?;
                if is_done {
                    return Ok(());
                }
            }
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exit::Exit;
    use std::sync::atomic::{AtomicUsize, Ordering};

    #[test]
    fn results_come_in_order_on_any_number_of_threads() {
        for threads in [1, 2, 3, 64] {
            let (mut taken, mut awaited) = (Vec::new(), Vec::new());
            let slow_first = |index: usize| {
                thread::sleep(Duration::from_millis(if index == 0 { 120 } else { 0 }));
                index * index
            };
            let take = |index, square: Option<usize>| {
                match square {
                    Some(square) => taken.push((index, square)),
                    None => awaited.push(index),
                }
                Ok(())
            };
            in_order(50, threads, slow_first, take).unwrap();
            let expected: Vec<_> = (0..50).map(|index| (index, index * index)).collect();
            assert_eq!(taken, expected);
            assert_eq!(awaited[..2], [0, 0], "the slow one is awaited more than once");
            assert!((0..50).all(|index| awaited.contains(&index)));
        }
        in_order(0, 4, |index| index, |_, _| unreachable!()).unwrap();
    }

    #[test]
    fn work_is_never_far_ahead_of_what_was_taken() {
        let (begun, taken) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let most = AtomicUsize::new(0);
        let work = |_| {
            let ahead = begun.fetch_add(1, Ordering::SeqCst) + 1 - taken.load(Ordering::SeqCst);
            most.fetch_max(ahead, Ordering::SeqCst);
        };
        let take = |_, done: Option<()>| {
            if done.is_some() {
                thread::sleep(Duration::from_millis(1));
                taken.fetch_add(1, Ordering::SeqCst);
            }
            Ok(())
        };
        in_order(60, 3, work, take).unwrap();
        // One more was started than `take` has counted yet.
        assert!(most.into_inner() <= AHEAD * 3 + 1);
    }

    #[test]
    fn a_failure_and_a_panic_end_the_work() {
        let done = AtomicUsize::new(0);
        let work = |_| done.fetch_add(1, Ordering::SeqCst);
        let take = |index, done: Option<usize>| match done {
            Some(_) if index == 3 => Err(Failure::Told(Exit::Failed, "enough".to_owned())),
            _ => Ok(()),
        };
        in_order(1000, 2, work, take).unwrap_err();
        assert!(done.into_inner() <= 4 + AHEAD * 2);

        let panics = |index: usize| assert!(index != 5, "number five");
        let ended = catch_unwind(AssertUnwindSafe(|| in_order(9, 2, panics, |_, _| Ok(()))));
        let said = ended.unwrap_err();
        assert_eq!(said.downcast_ref::<&str>(), Some(&"number five"));
    }
}
