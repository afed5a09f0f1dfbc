//! Cases on all cores.

use crate::job::{Job, Row, SweepError};
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;
use std::thread;

/// Runs these cases on so many threads (0 counts as 1) and hands every row to `take` as it comes, in any order. A
/// failure of `take` or a defect of this program ends it; cases that are running are finished first.
///
/// # Errors
/// What `take` said, or [`Job::case`].
pub fn run<E: From<SweepError> + Send>(
    job: &Job,
    cases: &[u64],
    threads: usize,
    mut take: impl FnMut(Row) -> Result<(), E>,
) -> Result<(), E> {
    // Not every system has threads.
    if threads <= 1 {
        return cases.iter().try_for_each(|case| take(job.case(*case)?));
    }
    let (send, receive) = mpsc::sync_channel(threads * 4);
    let stop = AtomicBool::new(false);
    thread::scope(|scope| {
        let worker = || {
            let each = |send: &mut mpsc::SyncSender<Result<Row, SweepError>>, case: &u64| {
                // Nobody listens any more once something went wrong.
                let goes_on = !stop.load(Ordering::Relaxed) && send.send(job.case(*case)).is_ok();
                goes_on.then_some(())
            };
            let all = || cases.par_iter().try_for_each_with(send, each);
            match rayon::ThreadPoolBuilder::new().num_threads(threads).build() {
                Ok(pool) => pool.install(all),
                // The threads there are will do.
                Err(_) => all(),
            }
        };
        scope.spawn(worker);
        let result = receive.iter().try_for_each(|row| take(row?));
        stop.store(true, Ordering::Relaxed);
        drop(receive);
        result
    })
}
