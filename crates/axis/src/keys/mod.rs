//! The keys of a configuration, each described once: its name, its range, its meaning, and its field in
//! the structure.
//!
//! These tables are the source of: the reader of scripts, the JSON Schema, the tables in the docs, the
//! check of ranges, the C library's set-up, the writer of scripts, and the reduction of random programs.
//! A key that is added here is in all of them.

mod axis;

pub use axis::AXIS;

/// The range of a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The lowest value.
    pub least: f64,
    /// `least` itself is outside.
    pub is_above: bool,
    /// The highest value.
    pub most: f64,
}

impl Bounds {
    /// Any finite number.
    pub const FINITE: Self = Self {
        least: f64::MIN,
        is_above: false,
        most: f64::MAX,
    };

    /// Above 0.
    pub const POSITIVE: Self = Self {
        least: 0.0,
        is_above: true,
        most: f64::MAX,
    };

    /// From `least` on.
    pub const fn from(least: f64) -> Self {
        Self {
            least,
            ..Self::FINITE
        }
    }

    /// Whether a value is inside; NaN is not.
    pub fn hold(&self, value: f64) -> bool {
        let is_enough = if self.is_above {
            value > self.least
        } else {
            value >= self.least
        };
        is_enough && value <= self.most
    }
}

/// The values a key may have, and their field in `T`.
#[derive(Clone, Copy, Debug)]
pub enum Holds<T: 'static> {
    /// TRUE or FALSE.
    Bool {
        /// Its value.
        get: fn(&T) -> bool,
        /// Sets it.
        set: fn(&mut T, bool),
    },
    /// One of some words.
    Word {
        /// The words; the index of a word is its value.
        words: &'static [&'static str],
        /// Its value, if it has one.
        get: fn(&T) -> Option<usize>,
        /// Sets it.
        set: fn(&mut T, usize),
    },
    /// A number.
    Number {
        /// Its range.
        bounds: Bounds,
        /// Its value, if it has one.
        get: fn(&T) -> Option<f64>,
        /// Sets it.
        set: fn(&mut T, f64),
    },
    /// A whole number.
    Whole {
        /// The lowest and the highest value.
        range: (u64, u64),
        /// Its value, if it has one.
        get: fn(&T) -> Option<u64>,
        /// Sets it.
        set: fn(&mut T, u64),
    },
    /// A count of scans, which may be given as a time.
    Scans {
        /// The lowest and the highest value.
        range: (u64, u64),
        /// Its value, if it has one.
        get: fn(&T) -> Option<u64>,
        /// Sets it.
        set: fn(&mut T, u64),
    },
    /// Keys of its own.
    Object(Object<T>),
    /// A list of objects, each with keys of its own. It has at most this number of objects.
    List(&'static [Object<T>]),
}

/// The meaning of null at a key.
#[derive(Clone, Copy, Debug)]
pub struct Null<T: 'static> {
    /// Whether the value is null.
    pub is: fn(&T) -> bool,
    /// Sets it to null.
    pub set: fn(&mut T),
}

impl<T> Null<T> {
    /// As if the key were not given.
    pub const ABSENT: Self = Self {
        is: |_| false,
        set: |_| {},
    };
}

/// A key.
#[derive(Clone, Copy, Debug)]
pub struct Key<T: 'static> {
    /// Its name, after those of the objects around it, such as `homing.velocity`.
    pub path: &'static str,
    /// Its meaning, with unit and range.
    pub doc: &'static str,
    /// The default without it; none if it must be given.
    pub absent: Option<&'static str>,
    /// The meaning of null, if it may be given.
    pub null: Option<Null<T>>,
    /// The values it may have.
    pub holds: Holds<T>,
}

impl<T> Key<T> {
    /// A key for which null means nothing.
    pub const fn new(
        path: &'static str,
        absent: Option<&'static str>,
        doc: &'static str,
        holds: Holds<T>,
    ) -> Self {
        Self {
            path,
            doc,
            absent,
            null: None,
            holds,
        }
    }

    /// A key for a number.
    pub const fn number(
        path: &'static str,
        bounds: Bounds,
        absent: Option<&'static str>,
        doc: &'static str,
        get: fn(&T) -> Option<f64>,
        set: fn(&mut T, f64),
    ) -> Self {
        Self::new(path, absent, doc, Holds::Number { bounds, get, set })
    }

    /// A key with keys of its own.
    pub const fn object(
        path: &'static str,
        what: &'static str,
        keys: &'static [Self],
        absent: Option<&'static str>,
        doc: &'static str,
    ) -> Self {
        Self::new(path, absent, doc, Holds::Object(Object::new(what, keys)))
    }

    /// Its own name.
    pub fn name(&self) -> &'static str {
        let above = self.path.bytes().rposition(|byte| byte == b'.');
        let own = above.and_then(|dot| self.path.get(dot + 1..));
        own.unwrap_or(self.path)
    }

    /// Whether it must be given if its object is.
    pub const fn is_needed(&self) -> bool {
        self.absent.is_none()
    }

    /// Whether both have the same value.
    pub fn is_same(&self, one: &T, other: &T) -> bool {
        match &self.holds {
            Holds::Bool { get, .. } => get(one) == get(other),
            Holds::Word { get, .. } => get(one) == get(other),
            Holds::Number { get, .. } => get(one) == get(other),
            Holds::Whole { get, .. } | Holds::Scans { get, .. } => get(one) == get(other),
            Holds::Object(object) => object.is_same(one, other),
            Holds::List(objects) => objects.iter().all(|object| object.is_same(one, other)),
        }
    }

    /// Copies the value of `other`. A missing value leaves this one unchanged.
    pub fn take(&self, from: &T, to: &mut T) {
        match &self.holds {
            Holds::Bool { get, set } => set(to, get(from)),
            Holds::Word { get, set, .. } => give(to, get(from), *set),
            Holds::Number { get, set, .. } => give(to, get(from), *set),
            Holds::Whole { get, set, .. } | Holds::Scans { get, set, .. } => give(to, get(from), *set),
            Holds::Object(object) => object.take(from, to),
            Holds::List(objects) => objects.iter().for_each(|object| object.take(from, to)),
        }
    }
}

fn give<T, V>(to: &mut T, value: Option<V>, set: fn(&mut T, V)) {
    if let Some(value) = value {
        set(to, value);
    }
}

/// Some keys.
#[derive(Clone, Copy, Debug)]
pub struct Object<T: 'static> {
    /// The name of the object in messages.
    pub what: &'static str,
    /// Its keys, in the order in which they are read.
    pub keys: &'static [Key<T>],
    /// At least one of them must be given.
    pub needs_one: bool,
}

impl<T> Object<T> {
    /// An object that may be empty, unless it has keys that are needed.
    pub const fn new(what: &'static str, keys: &'static [Key<T>]) -> Self {
        Self {
            what,
            keys,
            needs_one: false,
        }
    }

    fn is_same(&self, one: &T, other: &T) -> bool {
        self.keys.iter().all(|key| key.is_same(one, other))
    }

    fn take(&self, from: &T, to: &mut T) {
        self.keys.iter().for_each(|key| key.take(from, to));
    }

    /// The key with a path that begins here.
    pub fn find(&self, path: &str) -> Option<&'static Key<T>> {
        self.keys.iter().find_map(|key| match &key.holds {
            _ if key.path == path => Some(key),
            Holds::Object(object) if path.starts_with(key.path) => object.find(path),
            Holds::List(objects) => objects.iter().find_map(|object| object.find(path)),
            Holds::Object(_)
            | Holds::Bool { .. }
            | Holds::Word { .. }
            | Holds::Number { .. }
            | Holds::Whole { .. }
            | Holds::Scans { .. } => None,
        })
    }

    /// Calls `look` with every key that is not an object.
    pub fn each(&self, look: &mut impl FnMut(&'static Key<T>)) {
        for key in self.keys {
            match &key.holds {
                Holds::Object(object) => object.each(look),
                Holds::List(objects) => objects.iter().for_each(|object| object.each(look)),
                Holds::Bool { .. }
                | Holds::Word { .. }
                | Holds::Number { .. }
                | Holds::Whole { .. }
                | Holds::Scans { .. } => look(key),
            }
        }
    }
}
