//! Different names of pins and numbers of enumerations in other systems: data, in `dialects.txt`.

use standstill_blocks::REGISTRY;
use standstill_fb::{BlockInfo, EnumInfo, Pin, PinType};

const DATA: &str = include_str!("../dialects.txt");

/// The names of pins and numbers of enumerations; the default is our own, which is the standard's.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Dialect {
    name: String,
    /// Type, number there, element.
    numbers: Vec<(String, i32, String)>,
    /// Block, pin, name there.
    pins: Vec<(String, String, String)>,
    /// Type, name there.
    types: Vec<(String, String)>,
    /// Type, element, name there.
    names: Vec<(String, String, String)>,
}

/// No dialect has this name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "there is no dialect `{name}`: choose one of {known}, or leave it out for the names and numbers of the standard"
)]
pub struct UnknownDialect {
    name: String,
    known: String,
}

impl Dialect {
    /// The names of all.
    pub fn known() -> impl Iterator<Item = &'static str> {
        DATA.lines().filter_map(|line| line.strip_prefix("dialect "))
    }

    /// # Errors
    /// [`UnknownDialect`] if the data has none of that name.
    pub fn new(name: &str) -> Result<Self, UnknownDialect> {
        let mut dialect = Self::default();
        let mut found = false;
        let own = str::to_owned;
        for line in DATA.lines() {
            let words: Vec<_> = line.split_whitespace().collect();
            match words[..] {
                ["dialect", other] => {
                    found = other == name;
                    if found {
                        dialect.name = own(other);
                    }
                }
                ["number", ty, number, element] if found => {
                    // A test reads all of them.
                    if let Ok(number) = number.parse() {
                        dialect.numbers.push((own(ty), number, own(element)));
                    }
                }
                ["pin", place, to] if found => {
                    if let Some((block, pin)) = place.split_once('.') {
                        dialect.pins.push((own(block), own(pin), own(to)));
                    }
                }
                ["type", ty, to] if found => dialect.types.push((own(ty), own(to))),
                ["element", ty, element, to] if found => {
                    dialect.names.push((own(ty), own(element), own(to)));
                }
                _ => {}
            }
        }
        if dialect.name.is_empty() {
            let known: Vec<_> = Self::known().collect();
            return Err(UnknownDialect {
                name: name.to_owned(),
                known: known.join(", "),
            });
        }
        Ok(dialect)
    }

    /// Its name; empty for our own.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Types and their names in the dialect.
    #[must_use]
    pub fn types(&self) -> &[(String, String)] {
        &self.types
    }

    /// Types, their elements, and the elements' names in the dialect.
    #[must_use]
    pub fn names(&self) -> &[(String, String, String)] {
        &self.names
    }

    /// Types whose elements have other numbers in the dialect: type, number, element.
    #[must_use]
    pub fn numbers(&self) -> &[(String, i32, String)] {
        &self.numbers
    }

    /// Blocks, their pins, and the pins' names in the dialect.
    #[must_use]
    pub fn pins(&self) -> &[(String, String, String)] {
        &self.pins
    }

    /// The name of a pin.
    pub(crate) fn pin<'a>(&'a self, block: &BlockInfo, pin: &'a Pin) -> &'a str {
        let other = self
            .pins
            .iter()
            .find(|(of, name, _)| of == block.name && name == pin.name);
        other.map_or(pin.name, |(_, _, name)| name)
    }

    /// Elements of an enumeration with their numbers in the dialect, with ours at the end of each;
    /// elements unknown there are left out.
    pub(crate) fn elements(&self, of: &EnumInfo) -> Vec<(&'static str, i32, i32)> {
        let numbered = |name: &'static str, ours: i32| {
            if !self.renumbers(of) {
                return Some((name, ours, ours));
            }
            let theirs = self
                .numbers
                .iter()
                .find(|(ty, _, element)| ty == of.name && element == name);
            theirs.map(|(_, number, _)| (name, *number, ours))
        };
        let mut elements: Vec<_> = of
            .elements
            .iter()
            .filter_map(|(name, ours)| numbered(name, *ours))
            .collect();
        elements.sort_by_key(|(_, theirs, _)| *theirs);
        elements
    }

    /// Whether it numbers an enumeration in its own way.
    pub(crate) fn renumbers(&self, of: &EnumInfo) -> bool {
        self.numbers.iter().any(|(ty, ..)| ty == of.name)
    }
}

/// All enumerations at pins of the registry, each once.
pub(crate) fn enumerations() -> Vec<EnumInfo> {
    let mut found: Vec<EnumInfo> = Vec::new();
    for pin in REGISTRY.iter().flat_map(BlockInfo::pins) {
        if let PinType::Enum(info) = pin.ty
            && found.iter().all(|other| other.name != info.name)
        {
            found.push(info);
        }
    }
    found.sort_by_key(|info| info.name);
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_line_of_the_data_speaks_of_something_there_is() {
        assert!(Dialect::known().count() >= 3);
        let mut lines = 0;
        for name in Dialect::known() {
            let dialect = Dialect::new(name).unwrap();
            for (ty, number, element) in &dialect.numbers {
                let all = enumerations();
                let info = all.iter().find(|info| info.name == ty).expect(ty);
                assert!(info.number_of(element).is_some(), "{name}: {ty} {element}");
                let same = dialect.numbers.iter().filter(|(t, n, _)| t == ty && n == number);
                assert_eq!(same.count(), 1, "{name}: {ty} {number}");
                lines += 1;
            }
            for (block, pin, _) in &dialect.pins {
                let info = REGISTRY.iter().find(|info| info.name == block).expect(block);
                assert!(info.pins().any(|it| it.name == pin), "{name}: {block}.{pin}");
                lines += 1;
            }
            for (ty, element, there) in &dialect.names {
                let all = enumerations();
                let info = all.iter().find(|info| info.name == ty).expect(ty);
                assert!(info.number_of(element).is_some(), "{name}: {ty} {element}");
                assert!(info.number_of(there).is_none(), "{name}: {there} is ours");
                lines += 1;
            }
            for (ty, there) in &dialect.types {
                assert!(!there.eq_ignore_ascii_case(ty), "{name}: {there} is ours");
                lines += 1;
            }
        }
        let said = DATA
            .lines()
            .filter(|line| !line.is_empty() && !line.starts_with('#') && !line.starts_with("dialect "));
        assert_eq!(said.count(), lines, "a line was not understood");
    }

    #[test]
    fn an_unknown_dialect_is_told_with_those_there_are() {
        let text = Dialect::new("klingon").unwrap_err().to_string();
        assert!(text.contains("`klingon`") && text.contains("codesys"), "{text}");
    }

    #[test]
    fn numbers_of_a_dialect_stand_beside_ours() {
        let all = enumerations();
        let direction = all.iter().find(|info| info.name == "MC_DIRECTION").unwrap();
        let codesys = Dialect::new("codesys").unwrap();
        assert_eq!(
            codesys.elements(direction),
            [
                ("mcNegativeDirection", -1, 3),
                ("mcShortestWay", 0, 2),
                ("mcPositiveDirection", 1, 1),
                ("mcCurrentDirection", 2, 4),
            ]
        );
        assert_eq!(
            Dialect::default().elements(direction).len(),
            direction.elements.len()
        );
    }
}
