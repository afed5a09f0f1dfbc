//! The values of expressions. They are also computed at run time: operands are variables where it
//! matters.

use crate::common;

use crate::common::{ran, real, worth, wrong};

/// Covers: ST3, ST4
#[test]
fn literals_have_their_values() {
    for (ty, expression, value) in [
        ("INT", "1_000", 1000),
        ("BYTE", "2#1010", 10),
        ("INT", "8#17", 15),
        ("WORD", "16#FF", 255),
        ("INT", "INT#-5", -5),
        ("WORD", "WORD#16#FF", 255),
        ("BOOL", "BOOL#1", 1),
        ("BOOL", "TRUE", 1),
        ("TIME", "T#1d2h3m4s5ms6us7ns", 93_784_005_006_007),
        ("TIME", "T#90m", 5_400_000_000_000),
        ("TIME", "TIME#-2.5ms", -2_500_000),
        ("LTIME", "LTIME#1us", 1000),
        ("ULINT", "18446744073709551615", (1 << 64) - 1),
        ("LINT", "-9223372036854775808", -(1 << 63)),
    ] {
        assert_eq!(worth(ty, expression), value, "{expression}");
    }
    assert_eq!(real("LREAL", "1.0E-3"), 1e-3);
    assert_eq!(real("LREAL", "5"), 5.0);
    assert_eq!(real("REAL", "0.1"), f64::from(0.1_f32));
    for (ty, literal) in [
        ("INT", "40000"),
        ("USINT", "-1"),
        ("BYTE", "256"),
        ("BOOL", "2"),
        ("REAL", "1.0E39"),
    ] {
        let told = wrong(&format!(
            "PROGRAM P VAR x : {ty}; END_VAR x := {literal}; END_PROGRAM"
        ));
        assert_eq!(
            told.first().map(|it| it.0),
            Some("out_of_range"),
            "{literal}: {told:?}"
        );
    }
}

/// Covers: ST31
#[test]
fn operators_bind_as_the_standard_says() {
    for (ty, expression, value) in [
        ("INT", "2 + 3 * 4", 14),
        ("INT", "20 - 5 - 3", 12),
        ("INT", "100 / 10 / 2", 5),
        ("INT", "(2 + 3) * 4", 20),
        ("INT", "-2 + 5", 3),
        ("INT", "7 MOD 4 * 2", 6),
        ("BOOL", "TRUE OR TRUE AND FALSE", 1),
        ("BOOL", "TRUE OR TRUE XOR TRUE", 1),
        ("BOOL", "TRUE XOR FALSE AND FALSE", 1),
        ("BOOL", "NOT TRUE OR TRUE", 1),
        ("TIME", "T#1s+T#500ms", 1_500_000_000),
        ("TIME", "T#1s-T#500ms", 500_000_000),
        ("TIME", "T#-1s-T#1.5s+T#1ms", -2_499_000_000),
        ("BOOL", "1 + 1 = 2 AND 3 < 4", 1),
        ("BOOL", "1 < 2 = TRUE", 1),
        ("BOOL", "NOT (1 = 2) & (2 <> 3)", 1),
    ] {
        assert_eq!(worth(ty, expression), value, "{expression}");
    }
    assert_eq!(real("LREAL", "-2.0 ** 2.0"), -4.0);
    assert_eq!(real("LREAL", "2.0 ** 3.0 ** 2.0"), 64.0);
}

/// Every operation of two variables, against numbers of 128 bits that are cut to the width.
/// Covers: ST33
#[test]
fn whole_numbers_wrap_in_their_width_and_divide_towards_zero() {
    let types: [(&str, u32, bool); 8] = [
        ("SINT", 8, true),
        ("USINT", 8, false),
        ("INT", 16, true),
        ("UINT", 16, false),
        ("DINT", 32, true),
        ("UDINT", 32, false),
        ("LINT", 64, true),
        ("ULINT", 64, false),
    ];
    for (ty, bits, signed) in types {
        let (low, high): (i128, i128) = if signed {
            (-(1 << (bits - 1)), (1 << (bits - 1)) - 1)
        } else {
            (0, (1 << bits) - 1)
        };
        let wrap = |value: i128| {
            let kept = value & ((1 << bits) - 1);
            if signed && kept >> (bits - 1) != 0 {
                kept - (1 << bits)
            } else {
                kept
            }
        };
        let mut values = vec![low, low + 1, high - 1, high, 1, 7, 100];
        if signed {
            values.extend([-1, -7]);
        }
        for a in &values {
            // Division by zero is a fault, which another test shows.
            for b in values.iter().filter(|b| **b != 0) {
                let variables = format!(
                    "a : {ty} := {a}; b : {ty} := {b}; s, d, p, q, r : {ty}; lt, le, eq : BOOL; n, m : {ty};"
                );
                let run = ran(
                    &variables,
                    "s := a + b; d := a - b; p := a * b; q := a / b; r := a MOD b; lt := a < b; le := a <= b; \
                     eq := a = b; n := MIN(a, b); m := MAX(a, b);",
                );
                let wide = a.wrapping_mul(*b);
                for (name, value) in [
                    ("s", wrap(a + b)),
                    ("d", wrap(a - b)),
                    ("p", wrap(wide)),
                    ("q", wrap(a / b)),
                    ("r", wrap(a % b)),
                    ("lt", (a < b).into()),
                    ("le", (a <= b).into()),
                    ("eq", (a == b).into()),
                    ("n", *a.min(b)),
                    ("m", *a.max(b)),
                ] {
                    assert_eq!(run.whole(name), value, "{ty}: {a} {b} {name}");
                }
            }
        }
    }
}

/// Covers: ST34
#[test]
fn real_is_computed_in_32_bits_and_lreal_in_64() {
    let run = ran(
        "a : REAL := 0.1; b : REAL := 0.2; c : REAL; d : LREAL := 0.1; e : LREAL; f, g : LREAL; z : LREAL; n : BOOL;",
        "c := a + b; e := d + 0.2; f := a * 3.0; g := a / b; z := 0.0; z := z / z; n := z = z;",
    );
    assert_eq!(run.real("c"), f64::from(0.1_f32 + 0.2_f32));
    assert_eq!(run.real("e"), 0.1 + 0.2);
    assert_eq!(run.real("f"), f64::from(0.1_f32 * 3.0_f32));
    assert_eq!(run.real("g"), f64::from(0.1_f32 / 0.2_f32));
    assert!(run.real("z").is_nan());
    assert_eq!(run.whole("n"), 0);
}

/// Covers: ST35
#[test]
fn conversions_round_half_to_even_saturate_and_keep_low_bits() {
    for (call, ty, value) in [
        ("LREAL_TO_INT(2.5)", "INT", 2),
        ("LREAL_TO_INT(3.5)", "INT", 4),
        ("LREAL_TO_INT(-2.5)", "INT", -2),
        ("LREAL_TO_INT(1.0E9)", "INT", 32_767),
        ("LREAL_TO_INT(-1.0E9)", "INT", -32_768),
        ("LREAL_TO_USINT(-3.0)", "USINT", 0),
        ("LREAL_TO_USINT(300.0)", "USINT", 255),
        ("LREAL_TO_SINT(-200.0)", "SINT", -128),
        ("LREAL_TO_UDINT(5.0E9)", "UDINT", 4_294_967_295),
        ("LREAL_TO_LINT(1.0E30)", "LINT", i64::MAX.into()),
        ("LREAL_TO_ULINT(-1.0)", "ULINT", 0),
        ("LREAL_TO_DINT(0.0 / 0.0)", "DINT", 0),
        ("REAL_TO_DINT(1.5)", "DINT", 2),
        ("TRUNC(-2.9)", "DINT", -2),
        ("TRUNC(2.9)", "INT", 2),
        ("DINT_TO_INT(70000)", "INT", 4464),
        ("INT_TO_USINT(-1)", "USINT", 255),
        ("INT_TO_UDINT(-1)", "UDINT", 4_294_967_295),
        ("UINT_TO_INT(65535)", "INT", -1),
        ("BOOL_TO_INT(TRUE)", "INT", 1),
        ("INT_TO_BOOL(5)", "BOOL", 1),
        ("TIME_TO_DINT(T#1s500us)", "DINT", 1000),
        ("DINT_TO_TIME(1500)", "TIME", 1_500_000_000),
        ("LTIME_TO_LINT(LTIME#1us)", "LINT", 1000),
        ("LINT_TO_LTIME(77)", "LTIME", 77),
        ("LREAL_TO_TIME(1.5)", "TIME", 1_500_000),
        ("DWORD_TO_UDINT(16#FFFFFFFF)", "UDINT", 4_294_967_295),
        ("WORD_TO_INT(16#FFFF)", "INT", -1),
        ("TO_INT(2.5)", "INT", 2),
    ] {
        assert_eq!(worth(ty, call), value, "{call}");
    }
    assert_eq!(real("LREAL", "TIME_TO_LREAL(T#1500us)"), 1.5);
    assert_eq!(real("REAL", "LREAL_TO_REAL(0.1)"), f64::from(0.1_f32));
    assert_eq!(real("LREAL", "UDINT_TO_LREAL(4294967295)"), 4_294_967_295.0);
    assert_eq!(real("LREAL", "LINT_TO_LREAL(-3)"), -3.0);
    // The same with variables, which nothing evaluates before.
    let run = ran(
        "l : LREAL := 2.5; d : DINT := 70000; u : ULINT := 18446744073709551615; a, b : INT; c : LREAL; e : SINT;",
        "a := LREAL_TO_INT(l); b := DINT_TO_INT(d); c := ULINT_TO_LREAL(u); e := LREAL_TO_SINT(l * -100.0);",
    );
    assert_eq!((run.whole("a"), run.whole("b"), run.whole("e")), (2, 4464, -128));
    assert_eq!(run.real("c"), 18_446_744_073_709_551_615.0);
}

/// Covers: ST32
#[test]
fn and_then_and_or_else_leave_the_right_side_alone() {
    let run = ran(
        "zero : INT; a, b, c : BOOL;",
        "a := zero <> 0 AND_THEN 10 / zero > 1; b := zero = 0 OR_ELSE 10 / zero > 1; c := zero = 0 AND_THEN zero < 1;",
    );
    assert_eq!((run.whole("a"), run.whole("b"), run.whole("c")), (0, 1, 1));
    let text = "PROGRAM P VAR zero : INT; a : BOOL; END_VAR a := zero <> 0 AND 10 / zero > 1; END_PROGRAM";
    assert!(common::Running::new(text).scan().is_err());
}

/// Covers: ST14
#[test]
fn bits_are_read_and_written() {
    let run = ran(
        "w : WORD; d : LWORD; i : INT := -1; a, b, c : BOOL; s : ARRAY [0..1] OF BYTE; k : INT := 1;",
        "w.3 := TRUE; w.%X15 := TRUE; a := w.3; b := w.4; d.63 := TRUE; c := i.15; i.0 := FALSE; s[k].7 := TRUE; \
         w.15 := NOT w.15;",
    );
    assert_eq!(run.whole("w"), 8);
    assert_eq!((run.whole("a"), run.whole("b"), run.whole("c")), (1, 0, 1));
    assert_eq!(run.whole("d"), 1 << 63);
    assert_eq!(
        (run.whole("i"), run.whole("s[1]"), run.whole("s[0]")),
        (-2, 128, 0)
    );
}

/// Covers: ST40
#[test]
fn functions_of_the_library_are_worth_what_they_say() {
    for (ty, call, value) in [
        ("INT", "ABS(-5)", 5),
        ("INT", "ADD(1, 2, 3)", 6),
        ("INT", "SUB(5, 3)", 2),
        ("INT", "MUL(2, 3, 4)", 24),
        ("INT", "DIV(9, 2)", 4),
        ("INT", "MOD(9, 4)", 1),
        ("BOOL", "GT(3, 2, 1)", 1),
        ("BOOL", "GT(3, 1, 2)", 0),
        ("BOOL", "LE(1, 1, 2)", 1),
        ("BOOL", "EQ(1, 1)", 1),
        ("BOOL", "NE(1, 1)", 0),
        ("BOOL", "AND(TRUE, TRUE, FALSE)", 0),
        ("BOOL", "OR(FALSE, TRUE)", 1),
        ("BOOL", "XOR(TRUE, TRUE, TRUE)", 1),
        ("BOOL", "NOT(FALSE)", 1),
        ("INT", "MIN(3, 1, 2)", 1),
        ("INT", "MAX(3, 1, 2)", 3),
        ("INT", "LIMIT(0, 20, 10)", 10),
        ("INT", "LIMIT(MN := 0, IN := -3, MX := 10)", 0),
        ("INT", "SEL(FALSE, 1, 2)", 1),
        ("INT", "SEL(G := TRUE, IN0 := 1, IN1 := 2)", 2),
        ("INT", "MUX(2, 10, 20, 30)", 30),
        ("INT", "MOVE(7)", 7),
        ("BYTE", "SHL(BYTE#16#81, 1)", 2),
        ("BYTE", "SHR(BYTE#16#81, 1)", 0x40),
        ("WORD", "SHL(WORD#1, 16)", 0),
        ("BYTE", "ROL(BYTE#16#81, 1)", 3),
        ("BYTE", "ROR(BYTE#16#81, 1)", 0xC0),
        ("DWORD", "ROL(DWORD#16#80000001, 4)", 0x18),
        ("LWORD", "SHL(LWORD#1, 63)", 1 << 63),
        ("TIME", "LIMIT(T#1s, T#5s, T#3s)", 3_000_000_000),
        ("TIME", "T#1s * 3", 3_000_000_000),
        ("TIME", "T#1s * 0.5", 500_000_000),
        ("TIME", "T#1s / 4", 250_000_000),
        ("TIME", "T#1s - T#1ms", 999_000_000),
    ] {
        assert_eq!(worth(ty, call), value, "{call}");
    }
    for (call, value) in [
        ("SQRT(2.0)", 2.0_f64.sqrt()),
        ("ABS(-0.5)", 0.5),
        ("FLOOR(-1.5)", -2.0),
        ("CEIL(-1.5)", -1.0),
        ("ROUND(2.5)", 2.0),
        ("MIN(1.5, 2)", 1.5),
        ("EXPT(2.0, 10)", 1024.0),
        ("2.0 ** 0.5", 2.0_f64.sqrt()),
        ("EXP(0.0)", 1.0),
        ("LN(1.0)", 0.0),
        ("LOG(1000.0)", 3.0),
        ("SIN(0.0)", 0.0),
        ("COS(0.0)", 1.0),
        ("TAN(0.0)", 0.0),
        ("ASIN(1.0)", std::f64::consts::FRAC_PI_2),
        ("ACOS(1.0)", 0.0),
        ("ATAN(1.0)", std::f64::consts::FRAC_PI_4),
        ("ATAN2(1.0, -1.0)", 3.0 * std::f64::consts::FRAC_PI_4),
        ("SEL(TRUE, 1, 2.5)", 2.5),
    ] {
        assert_eq!(real("LREAL", call), value, "{call}");
    }
}

/// Covers: ST40
#[test]
fn time_is_that_since_the_start_of_the_run() {
    let mut run = common::Running::new("PROGRAM P VAR t : TIME; END_VAR t := TIME(); END_PROGRAM");
    for scan in 0..3 {
        run.scan().unwrap();
        assert_eq!(run.whole("t"), scan * 1_000_000);
    }
}
