//! The tables of docs/papers.md: published against ours, written from the code.

use super::generator::{first_difference, sequential};
use super::published::{short_path, static_formula, timed, trapezoid};
use super::support::{bounds, case, case_bounds, cases, integrated, number, numbers, rows};
use serde_json::Value;
use standstill_planner::Setpoint;
use standstill_planner::papers::{SCurve, ShortPath, ShortPathPolicy, Stepper, Tracking};
use std::env;
use std::fs;

const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/papers.md");

#[test]
fn the_tables_of_the_page_are_those_of_the_code() {
    // A checkout may have Windows line ends.
    let page = fs::read_to_string(PAGE)
        .expect("docs/papers.md")
        .replace("\r\n", "\n");
    let tables = [
        ("blejan", blejan()),
        ("stepping", stepping()),
        ("garcia", garcia()),
        ("bui", bui()),
        ("bui-lengths", bui_lengths()),
        ("bui-policies", bui_policies()),
        ("zhang", zhang()),
        ("zhang-moving", zhang_moving()),
        ("clock", clock()),
    ];
    let mut fresh = page.clone();
    for (name, table) in &tables {
        let begin = format!("<!-- table: {name} -->\n");
        let (before, rest) = fresh.split_once(&begin).expect("the marker of a table");
        let (_, after) = rest.split_once("<!-- end -->").expect("the end of a table");
        fresh = format!("{before}{begin}{table}<!-- end -->{after}");
    }
    assert_eq!(page.matches("<!-- table:").count(), tables.len());
    if env::var_os("STANDSTILL_WRITE_DOCS").is_some() {
        fs::write(PAGE, &fresh).expect("docs/papers.md can be written");
    } else {
        let stale = page.lines().zip(fresh.lines()).find(|(old, new)| old != new);
        assert!(
            page == fresh,
            "docs/papers.md is stale, first here: {stale:?}; write it anew with STANDSTILL_WRITE_DOCS=1"
        );
    }
}

/// A table from its head and rows, cells parted by ` | `.
fn table(head: &str, rows: impl IntoIterator<Item = String>) -> String {
    let rule = "| --- ".repeat(head.split(" | ").count());
    let rows: String = rows.into_iter().map(|row| format!("| {row} |\n")).collect();
    format!("| {head} |\n{rule}|\n{rows}")
}

/// A printed number as it was printed.
fn printed(value: &Value) -> String {
    value.to_string()
}

fn list(values: &[f64]) -> String {
    values.iter().map(f64::to_string).collect::<Vec<_>>().join(" ")
}

fn yes(holds: bool) -> &'static str {
    if holds { "yes" } else { "**no**" }
}

fn blejan() -> String {
    let ids = ["blejan-5-D1", "blejan-5-D2", "blejan-5-A-boundary", "blejan-5-C2"];
    let figures = ["9-10", "11-12", "13-14", "15-16"];
    let rows = ids.iter().zip(figures).map(|(id, figures)| {
        let case = case(id);
        let input = &case["input"];
        let plan = SCurve::new(0.0, number(&input["s"]), &case_bounds(&case)).expect("a plan");
        let times = plan.times();
        let lengths = numbers(&case["published"]["jerk_vector_segment_ms"]);
        let signs = [1.0, 0.0, -1.0, 0.0, -1.0, 0.0, 1.0].map(|sign| sign * number(&input["J"]));
        let [exact, ..] = integrated([0.0; 3], lengths.iter().copied().zip(signs));
        let final_position = &case["published"]["final_position"];
        let agrees = (exact - number(final_position)).abs() <= 0.005;
        format!(
            "{figures} | {}, {}, {}, {} | {} | {:.4}, {:.4}, {:.4} | {} | {} | {} | {exact:.4} | {}",
            input["s"],
            input["V"],
            input["A"],
            input["J"],
            plan.case().name(),
            times.jerk,
            times.acceleration,
            times.velocity,
            plan.profile().end().position,
            list(&lengths),
            printed(final_position),
            yes(agrees),
        )
    });
    table(
        "figures | s, V, A, J (mm, ms) | case | our t_j, t_a, t_v | our end | printed segment lengths | their printed end | their exact end | agrees",
        rows,
    )
}

fn stepping() -> String {
    let case = case("blejan-5-D2");
    let curve = SCurve::new(0.0, 50.0, &case_bounds(&case)).expect("a plan");
    let profile = curve.profile();
    let jerk = number(&case["input"]["J"]);
    // The jerk after each switch, up to the next; the two pulses in the middle are one.
    let signs = [1.0, 0.0, -1.0, 0.0, 1.0, 0.0].map(|sign| sign * jerk);
    let switches = || {
        let middle = curve.times().velocity;
        profile
            .switches()
            .filter(move |time| (time - middle).abs() > 1e-6)
    };
    let rounded = |round: fn(f64) -> f64| {
        let mut before = 0.0;
        let lengths = switches().map(round).map(move |time| {
            let length = time - before;
            before = time;
            length
        });
        integrated([0.0; 3], lengths.zip(signs))
    };
    let symmetric = integrated([0.0; 3], [20.0, 128.0, 40.0, 128.0, 20.0].into_iter().zip(signs));
    let mut stepper = Stepper::new(profile);
    let stepped = (0..337).map(|_| stepper.step(1.0)).last().expect("steps");
    let row = |what: &str, p: f64, v: f64| format!("{what} | {p:.3} | {:.3}", snapped(v));
    let [nearest, up] = [rounded(f64::round), rounded(f64::ceil)];
    table(
        "D2 move to 50 mm in steps of 1 ms | ends at (mm) | with velocity (mm/ms)",
        [
            row("every switch to the nearest step", nearest[0], nearest[1]),
            row(
                "every switch to the next step (the paper's stepping)",
                up[0],
                up[1],
            ),
            row("the printed, symmetric lengths", symmetric[0], symmetric[1]),
            row(
                "`Stepper`: steps split at switches",
                stepped.position,
                stepped.velocity,
            ),
        ],
    )
}

/// Makes 0 of a rounding residue, without its sign.
fn snapped(value: f64) -> f64 {
    if value.abs() < 1e-9 { 0.0 } else { value }
}

fn garcia() -> String {
    let mut rows: Vec<_> = cases("garcia").iter().filter_map(garcia_row).collect();
    let case = case("garcia-trapezoid");
    let input = &case["input"];
    let peaks = trapezoid(input).profile().peaks();
    rows.push(format!(
        "trapezoid | {:.4}, {}, - , - | {} / {:.4} | {} (measured) / {:.4} | - | not computed by the paper",
        number(&input["theta"]),
        input["T"],
        input["V"],
        peaks.velocity,
        printed(&case["published"]["a_measured"]),
        peaks.acceleration
    ));
    table(
        "case | theta, T, gamma, phi | velocity printed / ours | acceleration | jerk | agrees",
        rows,
    )
}

fn garcia_row(case: &Value) -> Option<String> {
    let (input, published) = (&case["input"], &case["published"]);
    let [theta, duration, gamma, phi] = ["theta", "T", "gamma", "phi"].map(|key| number(&input[key]));
    published.get("v")?;
    let peaks = timed(input).profile().peaks();
    let ours = [peaks.velocity, peaks.acceleration, peaks.jerk].map(|peak| peak * theta.signum());
    let cell = |key: &str, ours: f64| format!("{} / {ours:.4}", printed(&published[key]));
    let agrees = ["v", "a", "j"].iter().zip(ours).all(|(key, ours)| {
        // One unit of the last place: some are cut off instead of rounded.
        (number(&published[*key]) - ours).abs() <= 1.01e-4
    });
    Some(format!(
        "{} | {theta:.4}, {duration}, {gamma}, {phi:.4} | {} | {} | {} | {}",
        case["id"].as_str().expect("an id").trim_start_matches("garcia-"),
        cell("v", ours[0]),
        cell("a", ours[1]),
        cell("j", ours[2]),
        yes(agrees)
    ))
}

fn bui_rows() -> impl Iterator<Item = (String, Value)> {
    cases("bui").into_iter().filter_map(|case| {
        let id = case["id"].as_str()?.strip_prefix("bui-table2-row")?;
        let row = id.split('-').next()?.trim_start_matches('0').to_owned();
        Some((row, case.clone()))
    })
}

fn bui() -> String {
    let rows = bui_rows().map(|(row, case)| {
        let plan = short_path(&case["input"], ShortPathPolicy::Paper);
        let (input, published) = (&case["input"], &case["published"]);
        let velocity = |key: &str| {
            if input[key] == published[key] {
                printed(&input[key])
            } else {
                format!("**{}** (printed {})", input[key], published[key])
            }
        };
        let peak = plan.peak_velocity();
        let duration = plan.profile().duration();
        // Half a unit of the last of four printed places.
        let agrees = (number(&published["v_max"]) - peak).abs() <= 5.1e-5
            && (number(&published["total_time"]) - duration).abs() <= 5.1e-5;
        format!(
            "{row} | {} | {} | {} | {} | {} / {peak:.6} | {} / {duration:.6} | {}",
            plan.kind().name(),
            velocity("v_s"),
            velocity("v_e"),
            number(&input["s"]),
            printed(&published["v_max"]),
            printed(&published["total_time"]),
            yes(agrees),
        )
    });
    table(
        "row | type | v_s | v_e | s | V printed / ours | T printed / ours | agrees",
        rows,
    )
}

fn bui_lengths() -> String {
    let rows = cases("bui_path_length").into_iter().flat_map(|case| {
        let (input, published) = (&case["input"], &case["published"]);
        let [v_s, v_e, a, j] = ["v_s", "v_e", "A", "J"].map(|key| number(&input[key]));
        let id = case["id"].as_str().expect("an id");
        let group = id.trim_start_matches("bui-thresholds-g").to_owned();
        let names = input["V_name"].as_array().expect("names").clone();
        let printed = numbers(&published["S"]);
        let velocities = numbers(&input["V"]);
        (0..velocities.len()).map(move |i| {
            // On a longer path the part without cruise is S(V).
            let (way, peak) = (1.0, velocities[i]);
            let limits = bounds(peak, a, j);
            let plan = ShortPath::new(0.0, v_s, way, v_e, &limits, ShortPathPolicy::Paper).expect("a plan");
            let mut segments = plan.profile().segments();
            let cruise = segments.find(|segment| segment.acceleration == 0.0 && segment.jerk == 0.0);
            let ours = way - peak * cruise.expect("a cruise").duration;
            let name = names[i].as_str().expect("a name");
            format!(
                "{group} | {v_s}, {v_e} | {name} = {peak} | {} / {ours:.6}",
                printed[i]
            )
        })
    });
    table("group | v_s, v_e | peak V | S(V) printed / ours", rows)
}

fn bui_policies() -> String {
    let rows = bui_rows().filter(|(_, case)| case["expected"]["type"] == "8B");
    let rows = rows.map(|(row, case)| {
        let cell = |policy| {
            let plan = short_path(&case["input"], policy);
            format!("{:.6}, {:.6}", plan.end_velocity(), plan.profile().duration())
        };
        format!(
            "{row} | {} | {} | {}",
            case["input"]["v_e"],
            cell(ShortPathPolicy::Paper),
            cell(ShortPathPolicy::Nearest)
        )
    });
    table(
        "row | v_e | `paper`: v_e reached, T | `nearest`: v_e reached, T",
        rows,
    )
}

fn zhang() -> String {
    let case = case("zhang-table2");
    let curve = SCurve::new(0.0, number(&case["input"]["d"]), &case_bounds(&case)).expect("a plan");
    let velocities = case["published"]["v"].as_array().expect("a list");
    let sums = case["published"]["displacement"].as_array().expect("a list");
    let mut sum = 0.0;
    let rows = velocities
        .iter()
        .zip(sums)
        .enumerate()
        .map(|(k, (v, displacement))| {
            let state = curve.profile().at(k as f64);
            sum += state.velocity;
            let agrees =
                (state.velocity - number(v)).abs() <= 1e-9 && (sum - number(displacement)).abs() <= 6e-8;
            let position = curve.profile().at((k + 1) as f64).position;
            format!(
                "{} | {k} | {v} / {:.9} | {displacement} / {sum:.8} | {position:.6} | {}",
                k + 1,
                state.velocity,
                yes(agrees)
            )
        });
    let rows: Vec<_> = rows.collect();
    table(
        "row | true time (s) | velocity printed / ours | \"displacement\" printed / our running sum | true position at the row's time | agrees",
        rows,
    )
}

fn zhang_moving() -> String {
    let rows = cases("zhang_moving").into_iter().map(|case| {
        let limits = case_bounds(&case);
        let changes = rows(&case["input"]["retarget"]);
        let [first, second] = [changes[0][1], changes[1][1]];
        let at = changes[1][0];
        let start = Setpoint::at_rest(0.0);
        let mut tracking = Tracking::new(&start, first, &limits, 1.0).expect("a plan");
        let before = tracking.advance(at as u32);
        tracking.retarget(second).expect("a plan");
        let after = tracking.now();
        let printed = SCurve::new(0.0, second, &limits).expect("a plan");
        // The essay's formula is that of the same profile, as another test shows.
        let [_, _, c0, c1, c2] = static_formula(second, limits.velocity, limits.acceleration, limits.jerk);
        assert!((2.0 * c0 + c1 + c2 - printed.profile().duration()).abs() < 1e-9);
        let jumped = printed.profile().at(at);
        format!(
            "{first} -> {second} at {at} s | {:.3} -> {:.3} | {:.3} -> {:.3} | {:.3} -> {:.3} | {:.4}",
            before.velocity,
            jumped.velocity,
            before.position,
            jumped.position,
            before.velocity,
            after.velocity,
            at + tracking.plan().duration()
        )
    });
    table(
        "target | essay: velocity jumps | essay: position jumps | `tracking`: velocity | rest at (s)",
        rows,
    )
}

fn clock() -> String {
    let limits = [0.05, 1.0, 20.0, 400.0];
    let rows = [0.05, 0.5, 1.5].map(|way| {
        let plan = sequential(way, limits, 0.001);
        let word = |difference: Option<u64>| match difference {
            None => "never".to_owned(),
            Some(sample) => format!("sample {sample}"),
        };
        format!(
            "{way} | {} | {} | {}",
            plan.scans(),
            word(first_difference::<f64>(&plan)),
            word(first_difference::<f32>(&plan))
        )
    });
    table(
        "way at 0.05, 1, 20, 400 and 1 ms | samples | a 64-bit clock leaves the plan | a 32-bit clock",
        rows,
    )
}
