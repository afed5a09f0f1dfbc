//! The bodies of the shims compile against replacements for the declarations that their compilers make:
//! for matiec pins as `struct { T value; uint8_t flags; }` behind its two macros, for STruC++ values with
//! `get` and `set`.
//!
//! The compilers themselves are not here. Without a C compiler the tests say SKIP; with `CI` in the environment that is a
//! failure.

use standstill_export::{Dialect, Prefix, Target, export};
use std::fs;
use std::path::Path;
use std::process::Command;

/// A block as a shim declares it: its name, its variables with their types, its body.
struct Declared<'a> {
    name: &'a str,
    variables: Vec<(&'a str, &'a str)>,
    body: &'a str,
}

/// Reads the blocks of a shim; bodies are between these two lines.
fn blocks<'a>(text: &'a str, (open, close): (&str, &str)) -> Vec<Declared<'a>> {
    let mut found = Vec::new();
    for part in text.split("\nFUNCTION_BLOCK ").skip(1) {
        let (name, rest) = part.split_once('\n').unwrap();
        let (head, rest) = rest.split_once(&format!("\n  {open}\n")).unwrap();
        let (body, rest) = rest.split_once(&format!("\n  {close}\n")).unwrap();
        assert!(rest.starts_with("END_FUNCTION_BLOCK"), "{name}");
        let variables = head.lines().filter_map(|line| {
            let (variable, ty) = line.strip_prefix("    ")?.split_once(" : ")?;
            Some((variable, ty.split([';', ' ']).next().unwrap()))
        });
        found.push(Declared {
            name,
            variables: variables.collect(),
            body,
        });
    }
    found
}

/// Compiles `source`, beside the headers of a target, without linking it.
fn compiles(name: &str, target: Target, dialect: &Dialect, compiler: &[&str], source: &str) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    fs::create_dir_all(&folder).unwrap();
    for file in export(target, &Prefix::default(), dialect) {
        fs::write(folder.join(file.name), file.text).unwrap();
    }
    fs::write(folder.join("shim_source"), source).unwrap();
    let output = Command::new(compiler[0])
        .args(&compiler[1..])
        .args([
            "-Wall",
            "-Wextra",
            "-Werror",
            "-fsyntax-only",
            "-include",
            "standstill_shim.h",
            "-I",
        ])
        .arg(&folder)
        .arg(folder.join("shim_source"))
        .output();
    let Ok(output) = output else {
        assert!(std::env::var_os("CI").is_none(), "CI must have {}", compiler[0]);
        eprintln!("SKIP: there is no {}", compiler[0]);
        return;
    };
    assert!(
        output.status.success(),
        "{name}: {}",
        String::from_utf8_lossy(&output.stderr)
    );
}

fn dialects() -> Vec<Dialect> {
    let mut all = vec![Dialect::default()];
    all.extend(Dialect::known().map(|name| Dialect::new(name).unwrap()));
    all
}

/// Types of a shim in C after matiec: all upper case, arrays in a structure called `table`.
const MATIEC: &str = r"
typedef uint8_t BOOL; typedef int16_t INT; typedef uint16_t WORD; typedef uint16_t UINT; typedef uint32_t DWORD; typedef double LREAL;
typedef int32_t DINT; typedef uint64_t ULINT; typedef struct { long int tv_sec; long int tv_nsec; } TIME;
typedef struct { DINT NUMBER; } AXIS_REF; typedef AXIS_REF MC_INPUT_REF; typedef AXIS_REF MC_OUTPUT_REF;
typedef int MC_BUFFER_MODE, MC_DIRECTION, MC_SOURCE, MC_EXECUTION_MODE, MC_SYNC_MODE, MC_COMBINE_MODE, MC_TRIGGER_REF,
    MC_START_MODE;
#define ARRAY(name, count, fields) typedef struct { fields } name##_RECORD; \
    typedef struct { DINT COUNT; struct { name##_RECORD table[count]; } RECORDS; } name;
ARRAY(MC_TP_REF, 40, TIME DELTATIME; LREAL POSITION; BOOL LEVEL;)
ARRAY(MC_TV_REF, 40, TIME DELTATIME; LREAL VELOCITY; BOOL LEVEL;)
ARRAY(MC_TA_REF, 40, TIME DELTATIME; LREAL ACCELERATION; BOOL LEVEL;)
ARRAY(MC_TRACK_REF, 32, TIME ONCOMPENSATION; TIME OFFCOMPENSATION; LREAL HYSTERESIS;)
ARRAY(MC_CAMSWITCH_REF, 32, INT TRACKNUMBER; LREAL FIRSTONPOSITION; LREAL LASTONPOSITION; INT AXISDIRECTION;
    INT CAMSWITCHMODE; TIME DURATION;)
ARRAY(MC_CAM_REF, 512, LREAL MASTER; LREAL SLAVE; LREAL SLOPE; LREAL CURVATURE; LREAL THIRD; INT LAW;)
#define GetFbVar(var, ...) (data__->var.value __VA_ARGS__)
#define SetFbVar(var, val) (data__->var.value = (val))
";

#[test]
fn the_bodies_for_matiec_compile_against_its_layout() {
    for dialect in dialects() {
        let files = export(Target::StMatiec, &Prefix::default(), &dialect);
        let shim = files.iter().find(|file| file.name.ends_with(".st")).unwrap();
        let mut source = String::from(MATIEC);
        let found = blocks(&shim.text, ("{{", "}}"));
        assert_eq!(found.len(), standstill_blocks::REGISTRY.len());
        for block in found {
            let name = block.name;
            source += "typedef struct {\n";
            for (variable, ty) in block.variables {
                let variable = variable.to_ascii_uppercase();
                source += &format!("    struct {{ {ty} value; uint8_t flags; }} {variable};\n");
            }
            source += &format!(
                "}} FB_{name};\nvoid {name}_body__(FB_{name} *data__);\nvoid {name}_body__(FB_{name} *data__) {{\n{}\n}}\n",
                block.body
            );
        }
        let name = format!("matiec-{}", dialect.name());
        compiles(
            &name,
            Target::StMatiec,
            &dialect,
            &["cc", "-std=gnu11", "-x", "c"],
            &source,
        );
    }
}

/// Values in C++ after STruC++: elementary ones are wrapped, in structures, too; enumerations are scoped and
/// wrapped twice, without a conversion to numbers; arrays are objects that are indexed as in the program.
const STRUCPP: &str = r"
template <class T> class Wrapped {
    T value{};
public:
    T get() const { return value; }
    void set(T to) { value = to; }
};
template <class E> class Element {
    E value{};
public:
    E get() const { return value; }
};
template <class E> using Enumerated = Wrapped<Element<E>>;
template <class T, int64_t lower, int64_t upper> class Array {
    T values[upper - lower + 1];
public:
    const T &operator[](int64_t index) const { return values[index - lower]; }
};
using BOOL = Wrapped<bool>; using INT = Wrapped<int16_t>; using WORD = Wrapped<uint16_t>; using UINT = Wrapped<uint16_t>; using DWORD = Wrapped<uint32_t>;
using LREAL = Wrapped<double>; using DINT = Wrapped<int32_t>; using ULINT = Wrapped<uint64_t>; using TIME = Wrapped<int64_t>;
struct AXIS_REF { DINT NUMBER; }; using MC_INPUT_REF = AXIS_REF; using MC_OUTPUT_REF = AXIS_REF;
enum class Names { first, second };
using MC_BUFFER_MODE = Enumerated<Names>; using MC_DIRECTION = Enumerated<Names>; using MC_SOURCE = Enumerated<Names>;
using MC_EXECUTION_MODE = Enumerated<Names>; using MC_TRIGGER_REF = Enumerated<Names>; using MC_SYNC_MODE = Enumerated<Names>; using MC_COMBINE_MODE = Enumerated<Names>;
using MC_START_MODE = Enumerated<Names>;
#define ARRAY(name, count, fields) struct name##_RECORD { fields }; \
    struct name { DINT COUNT; Array<name##_RECORD, 0, count - 1> RECORDS; };
ARRAY(MC_TP_REF, 40, TIME DELTATIME; LREAL POSITION; BOOL LEVEL;)
ARRAY(MC_TV_REF, 40, TIME DELTATIME; LREAL VELOCITY; BOOL LEVEL;)
ARRAY(MC_TA_REF, 40, TIME DELTATIME; LREAL ACCELERATION; BOOL LEVEL;)
ARRAY(MC_TRACK_REF, 32, TIME ONCOMPENSATION; TIME OFFCOMPENSATION; LREAL HYSTERESIS;)
ARRAY(MC_CAMSWITCH_REF, 32, INT TRACKNUMBER; LREAL FIRSTONPOSITION; LREAL LASTONPOSITION; INT AXISDIRECTION;
    INT CAMSWITCHMODE; TIME DURATION;)
ARRAY(MC_CAM_REF, 512, LREAL MASTER; LREAL SLAVE; LREAL SLOPE; LREAL CURVATURE; LREAL THIRD; INT LAW;)
";

#[test]
fn the_bodies_for_strucpp_compile_against_wrapped_values() {
    for dialect in dialects() {
        let files = export(Target::StStrucpp, &Prefix::default(), &dialect);
        let shim = files.iter().find(|file| file.name.ends_with(".st")).unwrap();
        let mut source = String::from(STRUCPP);
        let found = blocks(&shim.text, ("{external", "}"));
        assert_eq!(found.len(), standstill_blocks::REGISTRY.len());
        for block in found {
            let name = block.name;
            source += &format!("struct FB_{name} {{\n");
            for (variable, ty) in block.variables {
                source += &format!("    {ty} {};\n", variable.to_ascii_uppercase());
            }
            source += &format!("    void run() {{\n{}\n    }}\n}};\n", block.body);
        }
        let name = format!("strucpp-{}", dialect.name());
        compiles(
            &name,
            Target::StStrucpp,
            &dialect,
            &["c++", "-std=c++17", "-x", "c++"],
            &source,
        );
    }
}
