//! The begin and the duration of scans.

use serde_json::{Value, json};

/// Largest number of overruns that are kept individually; all are counted.
pub const OVERRUNS_KEPT: usize = 64;

/// The largest time that a histogram resolves (ns).
const LARGEST_NS: u64 = 1 << 36;

/// A histogram of times; its memory is fixed from the start.
///
/// Figures are within 1 % of the measured ones, up to 68 s; the largest one is exact.
#[derive(Clone, Debug)]
pub struct Histogram {
    counts: hdrhistogram::Histogram<u64>,
    max_ns: u64,
}

impl Histogram {
    fn new() -> Self {
        let counts = hdrhistogram::Histogram::new_with_bounds(1, LARGEST_NS, 2);
        Self {
            counts: counts.expect("the bounds are constants, and in order"),
            max_ns: 0,
        }
    }

    fn record(&mut self, ns: u64) {
        self.counts.saturating_record(ns);
        self.max_ns = self.max_ns.max(ns);
    }

    /// Times measured.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.counts.len()
    }

    /// The longest one (ns); 0 if there is none.
    #[must_use]
    pub const fn max_ns(&self) -> u64 {
        self.max_ns
    }

    /// The time (ns) that this share (0 to 1) of the measured ones does not exceed.
    #[must_use]
    pub fn quantile_ns(&self, share: f64) -> u64 {
        self.counts.value_at_quantile(share).min(self.max_ns)
    }

    fn to_json(&self) -> Value {
        let buckets: Vec<_> = self
            .counts
            .iter_log(1 << 10, 2.0)
            .map(|step| json!({"below_ns": step.value_iterated_to() + 1, "count": step.count_since_last_iteration()}))
            .collect();
        json!({
            "count": self.count(),
            "min": if self.count() == 0 { 0 } else { self.counts.min() },
            "mean": if self.count() == 0 { 0.0 } else { self.counts.mean().round() },
            "p50": self.quantile_ns(0.5),
            "p90": self.quantile_ns(0.9),
            "p99": self.quantile_ns(0.99),
            "p99_9": self.quantile_ns(0.999),
            "max": self.max_ns,
            "buckets": buckets,
        })
    }
}

/// A scan that was not over when the next one was due.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Overrun {
    /// The scan.
    pub scan: u64,
    /// The delay of its begin (ns).
    pub wake_latency_ns: u64,
    /// Its duration (ns).
    pub scan_time_ns: u64,
    /// Periods without a scan that follow from it.
    pub skipped: u64,
}

/// The measurements of a run; nothing here takes memory while it runs.
#[derive(Clone, Debug)]
pub struct Timing {
    period_ns: u64,
    wake_latency: Histogram,
    scan_time: Histogram,
    overruns: u64,
    skipped: u64,
    first: Vec<Overrun>,
}

impl Timing {
    /// No measurements yet, for scans of this period (ns); 0 counts as 1.
    #[must_use]
    pub fn new(period_ns: u64) -> Self {
        Self {
            period_ns: period_ns.max(1),
            wake_latency: Histogram::new(),
            scan_time: Histogram::new(),
            overruns: 0,
            skipped: 0,
            first: Vec::with_capacity(OVERRUNS_KEPT),
        }
    }

    /// Takes a scan with the instants (ns) when it was due, began and ended. Returns the number of
    /// periods to skip after it.
    pub(crate) fn record(&mut self, scan: u64, due_ns: u64, woke_ns: u64, ended_ns: u64) -> u64 {
        let wake_latency_ns = woke_ns.saturating_sub(due_ns);
        let scan_time_ns = ended_ns.saturating_sub(woke_ns);
        self.wake_latency.record(wake_latency_ns);
        self.scan_time.record(scan_time_ns);
        let took = ended_ns.saturating_sub(due_ns).div_ceil(self.period_ns);
        let skipped = took.saturating_sub(1);
        if skipped > 0 {
            self.overruns += 1;
            self.skipped = self.skipped.saturating_add(skipped);
            if self.first.len() < OVERRUNS_KEPT {
                self.first.push(Overrun {
                    scan,
                    wake_latency_ns,
                    scan_time_ns,
                    skipped,
                });
            }
        }
        skipped
    }

    /// The period (ns).
    #[must_use]
    pub const fn period_ns(&self) -> u64 {
        self.period_ns
    }

    /// The delays of the begin of scans.
    #[must_use]
    pub const fn wake_latency(&self) -> &Histogram {
        &self.wake_latency
    }

    /// The durations of scans, including their trace row.
    #[must_use]
    pub const fn scan_time(&self) -> &Histogram {
        &self.scan_time
    }

    /// Scans that were not over when the next one was due.
    #[must_use]
    pub const fn overruns(&self) -> u64 {
        self.overruns
    }

    /// Periods without a scan.
    #[must_use]
    pub const fn skipped(&self) -> u64 {
        self.skipped
    }

    /// The first overruns, [`OVERRUNS_KEPT`] at most.
    #[must_use]
    pub fn first_overruns(&self) -> &[Overrun] {
        &self.first
    }

    /// The timing file: the measures, and `about` the run.
    #[must_use]
    pub fn to_json(&self, about: &serde_json::Map<String, Value>) -> Value {
        let mut file = serde_json::Map::new();
        file.insert("format".to_owned(), json!("standstill-timing"));
        file.insert("version".to_owned(), json!(1));
        file.extend(about.clone());
        let overruns: Vec<_> = self
            .first
            .iter()
            .map(|overrun| {
                json!({
                    "scan": overrun.scan,
                    "wake_latency_ns": overrun.wake_latency_ns,
                    "scan_time_ns": overrun.scan_time_ns,
                    "skipped_periods": overrun.skipped,
                })
            })
            .collect();
        let measures = [
            ("period_ns", json!(self.period_ns)),
            ("scans", json!(self.scan_time.count())),
            ("overruns", json!(self.overruns)),
            ("skipped_periods", json!(self.skipped)),
            ("first_overruns", json!(overruns)),
            ("wake_latency_ns", self.wake_latency.to_json()),
            ("scan_time_ns", self.scan_time.to_json()),
        ];
        file.extend(measures.map(|(name, value)| (name.to_owned(), value)));
        Value::Object(file)
    }
}
