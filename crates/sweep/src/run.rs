//! Cases on all cores.

use crate::job::{Bench, Job, Row, SweepError};
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;
use std::thread;

/// Runs these cases on `threads` threads (0 counts as 1) and passes every row to `take` when it is ready, in any
/// order. A failure of `take` or a defect of this program ends it; running cases are finished first.
///
/// # Errors
/// The error of `take`, or a defect of this program.
pub fn run<E: From<SweepError> + Send>(
    job: &Job,
    cases: &[u64],
    threads: usize,
    mut take: impl FnMut(Row) -> Result<(), E>,
) -> Result<(), E> {
    // Some systems have no threads.
    if threads <= 1 {
        let mut bench = job.bench();
        return cases
            .iter()
            .try_for_each(|case| take(job.case(&mut bench, *case)?));
    }
    let (send, receive) = mpsc::sync_channel(threads * 4);
    let stop = AtomicBool::new(false);
    thread::scope(|scope| {
        let worker = || {
            let each = |(send, bench): &mut (mpsc::SyncSender<_>, Bench), case: &u64| {
                // After an error there is no receiver any more.
                let goes_on = !stop.load(Ordering::Relaxed) && send.send(job.case(bench, *case)).is_ok();
                goes_on.then_some(())
            };
            let all = || cases.par_iter().try_for_each_with((send, job.bench()), each);
            match rayon::ThreadPoolBuilder::new().num_threads(threads).build() {
                Ok(pool) => pool.install(all),
                // If the system has no more threads, the existing ones do the work.
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
