//! The standard blocks over 22 scans of 10 ms, side by side.
//!
//! Timer and edge columns are the results of the open-source IEC compiler matiec for the same program in
//! October 2024 (commit 6bb2c33); STruC++ gave the same in August 2026, except for its CTD. F_TRIG
//! follows the advice of IEC 61131-8 for the first call. Counter columns are the standard's rule that
//! only the limits of the type end counting, as IronPLC 0.239 and truST 0.9.15 do. All inputs are `x`, PT
//! is T#30ms, PV is 2; CTU.R is TRUE in scan 20 and CTD.LD in scan 1.

use standstill_axis::{Log, Scope, Standard};
use standstill_blocks::BlockInstance;
use standstill_fb::{AnyInstance, Context, Value};

const SCAN_NS: i64 = 10_000_000;

/// Scan, x, TON Q/ET, TOF Q/ET, TP Q/ET, R_TRIG, F_TRIG, CTU Q/CV, CTD Q/CV; ET in units of 10 ms.
const GOLDEN: &str = "
 0 1  0/0 1/0 1/0  1 0  0/1 1/-1
 1 1  0/1 1/0 1/1  0 0  0/1 0/2
 2 1  0/2 1/0 1/2  0 0  0/1 0/2
 3 0  0/0 1/0 0/0  0 1  0/1 0/2
 4 0  0/0 1/1 0/0  0 0  0/1 0/2
 5 1  0/0 1/0 1/0  1 0  1/2 0/1
 6 1  0/1 1/0 1/1  0 0  1/2 0/1
 7 1  0/2 1/0 1/2  0 0  1/2 0/1
 8 1  1/3 1/0 0/3  0 0  1/2 0/1
 9 1  1/3 1/0 0/3  0 0  1/2 0/1
10 1  1/3 1/0 0/3  0 0  1/2 0/1
11 1  1/3 1/0 0/3  0 0  1/2 0/1
12 0  0/0 1/0 0/0  0 1  1/2 0/1
13 0  0/0 1/1 0/0  0 0  1/2 0/1
14 1  0/0 1/0 1/0  1 0  1/3 1/0
15 0  0/0 1/0 1/1  0 1  1/3 1/0
16 1  0/0 1/0 1/2  1 0  1/4 1/-1
17 0  0/0 1/0 0/0  0 1  1/4 1/-1
18 0  0/0 1/1 0/0  0 0  1/4 1/-1
19 0  0/0 1/2 0/0  0 0  1/4 1/-1
20 0  0/0 0/3 0/0  0 0  0/0 1/-1
21 0  0/0 0/3 0/0  0 0  0/0 1/-1
";

struct Bench {
    instance: BlockInstance,
}

impl Bench {
    fn new(block: &str) -> Self {
        Self {
            instance: BlockInstance::new(block).unwrap(),
        }
    }

    fn set(&mut self, pin: &str, value: Value) {
        let (index, _) = self.instance.info().pin(pin).unwrap();
        self.instance.set(index, value).unwrap();
    }

    fn call(&mut self, now_ns: i64) {
        self.instance.call(&mut Context::<Standard> {
            now_ns,
            scope: Scope::new(0, &mut Log::default()),
            axes: &mut [],
            tables: &[],
        });
    }

    /// All outputs in the notation of the table.
    fn shown(&self) -> String {
        let inputs = self.instance.info().input_count();
        let outputs = self.instance.info().pins().count();
        let cells: Vec<_> = (inputs..outputs)
            .map(|index| match self.instance.get(index).unwrap() {
                Value::Bool(value) => u8::from(value).to_string(),
                Value::Int(value) => value.to_string(),
                Value::Time(ns) => {
                    assert_eq!(ns % SCAN_NS, 0);
                    (ns / SCAN_NS).to_string()
                }
                other => panic!("{other:?}"),
            })
            .collect();
        cells.join("/")
    }
}

#[test]
fn the_standard_blocks_give_the_golden_table() {
    let columns = [
        ("TON", "IN"),
        ("TOF", "IN"),
        ("TP", "IN"),
        ("R_TRIG", "CLK"),
        ("F_TRIG", "CLK"),
        ("CTU", "CU"),
        ("CTD", "CD"),
    ];
    let mut benches = columns.map(|(block, _)| Bench::new(block));
    for bench in &mut benches[..3] {
        bench.set("PT", Value::Time(3 * SCAN_NS));
    }
    for bench in &mut benches[5..] {
        bench.set("PV", Value::Int(2));
    }
    let rows = GOLDEN.lines().skip(1);
    assert_eq!(rows.clone().count(), 22);
    for (scan, row) in rows.enumerate() {
        let mut cells = row.split_whitespace();
        assert_eq!(cells.next(), Some(&*scan.to_string()));
        let x = cells.next() == Some("1");
        benches[5].set("R", Value::Bool(scan == 20));
        benches[6].set("LD", Value::Bool(scan == 1));
        for ((block, input), bench) in columns.iter().zip(&mut benches) {
            bench.set(input, Value::Bool(x));
            bench.call(scan as i64 * SCAN_NS);
            assert_eq!(bench.shown(), cells.next().unwrap(), "{block} in scan {scan}");
        }
        assert_eq!(cells.next(), None);
    }
}

/// FB-1, FB-2, FB-4: inputs keep their last value, outputs can be read before the first call, and without a
/// call nothing happens.
#[test]
fn an_instance_keeps_its_pins_and_is_frozen_without_calls() {
    let mut ctu = Bench::new("CTU");
    assert_eq!(ctu.shown(), "0/0");
    ctu.set("PV", Value::Int(1));
    ctu.set("CU", Value::Bool(true));
    assert_eq!(ctu.shown(), "0/0");
    ctu.call(0);
    ctu.call(0);
    assert_eq!(ctu.shown(), "1/1");
    ctu.set("PV", Value::Int(9));
    assert_eq!(ctu.shown(), "1/1");
    ctu.call(0);
    assert_eq!(ctu.shown(), "0/1");
}
