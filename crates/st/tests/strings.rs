//! Strings: their contents, comparisons and functions.

use crate::common;

use crate::common::{Running, ran};
use standstill_st::FaultKind;

/// Whether each of these is TRUE in a program with some variables.
fn hold(conditions: &[&str]) {
    let bits: String = (0..conditions.len()).map(|n| format!("b{n} : BOOL;")).collect();
    let body: String = conditions
        .iter()
        .enumerate()
        .map(|(n, it)| format!("b{n} := {it};\n"))
        .collect();
    let run = ran(
        &format!(
            "{bits} s : STRING := 'motion'; short : STRING[3]; empty : STRING; n : INT := -37; big : ULINT := 18446744073709551615; w : WORD := 16#FF; t : TIME := T#1m1s5ms;"
        ),
        &format!("short := s;\n{body}"),
    );
    for (n, it) in conditions.iter().enumerate() {
        assert_eq!(run.whole(&format!("b{n}")), 1, "{it}");
    }
}

/// Covers: ST3, ST10
#[test]
fn strings_are_bytes_that_are_cut_to_their_length() {
    hold(&[
        "short = 'mot'",
        "LEN(short) = 3",
        "LEN(empty) = 0",
        "LEN('it$'s$N$$') = 6",
        "'$41$42' = 'AB'",
        "'$n' = '$0A' AND '$T' = '$09' AND '$R' = '$0D' AND '$P' = '$0C'",
        "STRING#'x' = 'x'",
        // Bytes of UTF-8.
        "LEN('ü') = 2",
    ]);
}

/// Covers: ST10, ST40
#[test]
fn strings_are_compared_byte_by_byte() {
    hold(&[
        "s = 'motion'",
        "s <> 'Motion'",
        "'a' < 'b' AND 'a' < 'aa' AND '' < 'a' AND 'Z' < 'a'",
        "'b' > 'a' AND 'b' >= 'b' AND 'a' <= 'a'",
        "'ü' > 'z'",
        "GT('c', 'b', 'a') AND EQ(s, s) AND NE(s, short)",
        "(s = 'x') = FALSE",
    ]);
}

/// Covers: ST40
#[test]
fn functions_of_strings_give_new_ones() {
    hold(&[
        "LEFT(s, 3) = 'mot'",
        "LEFT(s, 100) = s",
        "LEFT(s, 0) = ''",
        "RIGHT(s, 2) = 'on'",
        "RIGHT(s, 100) = s",
        "MID(s, 2, 3) = 'ti'",
        "MID(IN := s, L := 9, P := 6) = 'n'",
        "MID(s, 1, 7) = ''",
        "CONCAT('a', 'b', s, 'c') = 'abmotionc'",
        "INSERT(s, '--', 0) = '--motion'",
        "INSERT(s, '--', 2) = 'mo--tion'",
        "INSERT(s, '--', 6) = 'motion--'",
        "DELETE(s, 2, 1) = 'tion'",
        "DELETE(s, 2, 5) = 'moti'",
        "REPLACE(s, 'TOR', 4, 3) = 'moTOR'",
        "FIND(s, 'ion') = 4",
        "FIND(s, 'o') = 2",
        "FIND(s, 'x') = 0 AND FIND(s, '') = 0 AND FIND('', 'x') = 0 AND FIND('ab', 'abc') = 0",
        "CONCAT(LEFT(s, 1), LEFT(s, 2), CONCAT(LEFT(s, 3), RIGHT(s, 1))) = 'mmomotn'",
    ]);
}

/// Covers: ST40
#[test]
fn a_string_is_chosen_like_any_value() {
    hold(&[
        "SEL(n < 0, 'OK', 'Error') = 'Error'",
        "SEL(n > 0, 'OK', 'Error') = 'OK'",
        "SEL(G := TRUE, IN0 := s, IN1 := CONCAT(s, '!')) = 'motion!'",
        "MUX(2, 'a', 'bcd', s) = s",
        "MAX('a', 'ab', 'B') = 'ab'",
        "MIN('a', 'ab', 'B') = 'B' AND MIN(s, s) = s",
        "LIMIT('b', 'a', 'c') = 'b' AND LIMIT('b', 'd', 'c') = 'c' AND LIMIT('b', 'bb', 'c') = 'bb'",
        "LEN(SEL(TRUE, short, s)) = 6",
        "SEL(FALSE, INT_TO_STRING(1), INT_TO_STRING(2)) = '1'",
    ]);
}

/// Covers: ST35, ST40
#[test]
fn numbers_become_strings_and_strings_numbers() {
    hold(&[
        "INT_TO_STRING(n) = '-37'",
        "TO_STRING(n) = '-37'",
        "TO_STRING(w) = '255'",
        "ULINT_TO_STRING(big) = '18446744073709551615'",
        "LINT_TO_STRING(LINT#-9223372036854775807 - 1) = '-9223372036854775808'",
        "BOOL_TO_STRING(n < 0) = 'TRUE'",
        "TIME_TO_STRING(t) = 'T#1m1s5ms' AND TIME_TO_STRING(T#0s) = 'T#0ms' AND TIME_TO_STRING(T#-2ms) = 'T#-2ms'",
        "STRING_TO_INT('-37') = n",
        "STRING_TO_DINT('+12 parts') = 12 AND STRING_TO_DINT('none') = 0 AND STRING_TO_DINT('') = 0",
        "STRING_TO_ULINT('18446744073709551615') = big",
        "STRING_TO_WORD('255') = w",
        "STRING_TO_BOOL('TRUE') AND NOT STRING_TO_BOOL('FALSE')",
    ]);
}

/// Covers: ST35, ST40
#[test]
fn durations_are_read_from_strings() {
    hold(&[
        "STRING_TO_TIME('T#1m1s5ms') = t AND STRING_TO_LTIME('LTIME#1m1s5ms') = t",
        "STRING_TO_TIME(TIME_TO_STRING(t)) = t AND STRING_TO_LTIME(LTIME_TO_STRING(T#-2d7ns)) = T#-2d7ns",
        "STRING_TO_TIME('time#1D2H3M4S5MS6US7NS') = T#1d2h3m4s5ms6us7ns",
        "STRING_TO_TIME('T#-1_500ms') = T#-1500ms AND STRING_TO_TIME('T#+90m') = T#90m",
        "STRING_TO_TIME('T#2.5ms') = T#2500us AND STRING_TO_TIME('T#0.000000001d') = T#86us400ns",
        "STRING_TO_TIME('T#1.0000000015s') = T#1s2ns AND STRING_TO_TIME('T#1.0000000014s') = T#1s1ns",
        "STRING_TO_TIME('T#1h_30m') = T#1h30m AND STRING_TO_TIME('T#3.ms') = T#3ms",
        // Only the parts before what is no part.
        "STRING_TO_TIME('T#5s and more') = T#5s AND STRING_TO_TIME('T#5s20') = T#5s",
        "STRING_TO_TIME('T#5s1h') = T#5s AND STRING_TO_TIME('T#5s5s') = T#5s AND STRING_TO_TIME('T#1.5m3s') = T#90s",
        // What is no duration.
        "STRING_TO_TIME('') = T#0s AND STRING_TO_TIME('5s') = T#0s AND STRING_TO_TIME('T#') = T#0s",
        "STRING_TO_TIME('T#-') = T#0s AND STRING_TO_TIME('T#s') = T#0s AND STRING_TO_TIME('T#.5s') = T#0s",
        "STRING_TO_TIME('T#5u') = T#0s AND STRING_TO_TIME('T#5?') = T#0s AND STRING_TO_TIME('ME#5s') = T#0s",
        "STRING_TO_TIME('#5s') = T#0s AND STRING_TO_TIME('T# 5s') = T#0s",
    ]);
}

const UNITS: &str = "
TYPE Part : STRUCT Name : STRING[12] := 'none'; Count : INT; Code : STRING; END_STRUCT; END_TYPE
FUNCTION Named : STRING[6]
VAR_INPUT Prefix : STRING[8] := 'P'; Number : DINT; END_VAR
VAR_OUTPUT Long : STRING; END_VAR
Long := CONCAT(Prefix, '-', DINT_TO_STRING(Number));
Named := Long;
END_FUNCTION
FUNCTION_BLOCK Journal
VAR_INPUT Text : STRING[5]; END_VAR
VAR_IN_OUT Last : STRING; END_VAR
VAR_OUTPUT Count : INT; Echo : STRING[3] := 'abc'; END_VAR
VAR_TEMP Scratch : STRING := 'tmp'; END_VAR
Scratch := CONCAT(Scratch, Text);
Last := Scratch;
Echo := Text;
Count := Count + LEN(Echo);
END_FUNCTION_BLOCK
PROGRAM Main
VAR
  p, q : Part := (Count := 2);
  l : Journal;
  Rows : ARRAY [1..3] OF STRING[4] := ['one', 2('more')];
  Last, Long, Both : STRING;
  Out : STRING[2];
  i : INT := 2;
  a, b, c, d, e, f, g : BOOL;
END_VAR
VAR CONSTANT Title : STRING := 'title'; END_VAR
a := p.Name = 'none' AND p.Code = '';
p.Name := Named('Part', 123456, Long => Long);
b := p.Name = 'Part-1' AND Long = 'Part-123456';
q := p;
c := q.Name = p.Name AND q.Count = 2;
Rows[i] := CONCAT(Rows[i], '!');
Rows[3] := Rows[1];
d := Rows[i] = 'more' AND Rows[3] = 'one';
Both := CONCAT(Named(Number := 1), Named(Number := 2));
e := Both = 'P-1P-2' AND Named(Number := 1) <> Named(Number := 2);
l(Text := 'abcdefg', Last := Last, Echo => Out);
f := Last = 'tmpabcde' AND Out = 'ab' AND l.Echo = 'abc';
g := Title = 'title';
END_PROGRAM";

/// Covers: ST10, ST11, ST21, ST22, ST23
#[test]
fn strings_stand_wherever_values_do() {
    let text = UNITS.replace("l(Text := 'abcdefg'", "l(Text := 'abcde'");
    let mut run = Running::new(&text);
    run.scan().unwrap_or_else(|fault| panic!("{fault}"));
    for name in ["a", "b", "c", "d", "e", "f", "g"] {
        assert_eq!(run.whole(name), 1, "{name}");
    }
    assert_eq!(run.whole("l.Count"), 3);
}

/// Covers: ST3
#[test]
fn a_literal_that_does_not_fit_is_told() {
    assert!(common::compile(UNITS).is_err());
}

/// Covers: ST36
#[test]
fn a_position_outside_of_a_string_is_a_fault() {
    for (statement, value) in [
        ("s := MID(s, 1, n);", 8),
        ("s := MID(s, 1, n - 8);", 0),
        ("s := INSERT(s, 'x', n - 9);", -1),
        ("s := DELETE(s, n - 10, 1);", -2),
        ("s := LEFT(s, n - 9);", -1),
        ("s := REPLACE(s, 'x', 1, DINT#100000 * n);", 800_000),
    ] {
        let text =
            format!("PROGRAM P VAR s : STRING := 'motion'; n : DINT := 8; END_VAR\n{statement}\nEND_PROGRAM");
        let mut run = Running::new(&text);
        assert!(run.scan().is_err(), "{statement}");
        let (place, told) = run.fault();
        assert_eq!(
            (place.kind, place.position.line, told),
            (FaultKind::Position, 2, value),
            "{statement}"
        );
    }
}
