//! The names that another system has for the types, elements and pins of the library. This is data: the
//! caller knows which system it is and the source of the names.

/// Other names and numbers; the default has none.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Dialect {
    /// Its name, for messages.
    pub name: String,
    /// Our type, its name there.
    pub types: Vec<(String, String)>,
    /// Our type, our element, its name there.
    pub elements: Vec<(String, String, String)>,
    /// Our type, the number there, our element. Numbers of such a type that are not listed are refused.
    pub numbers: Vec<(String, i32, String)>,
    /// Our block, our pin, its name there.
    pub pins: Vec<(String, String, String)>,
    /// Dialects that could have been chosen, for messages.
    pub others: Vec<Dialect>,
}

impl Dialect {
    /// Our type for its name in the dialect.
    pub(crate) fn type_called(&self, name: &str) -> Option<&str> {
        let found = self
            .types
            .iter()
            .find(|(_, there)| there.eq_ignore_ascii_case(name));
        found.map(|(ty, _)| ty.as_str())
    }

    /// The elements of an enumeration: our name, and the one there.
    pub(crate) fn elements_called<'a>(&'a self, ty: &'a str) -> impl Iterator<Item = (&'a str, &'a str)> {
        let of_type = self.elements.iter().filter(move |(of, ..)| of == ty);
        of_type.map(|(_, element, there)| (element.as_str(), there.as_str()))
    }

    /// Our name of a block's pin for its name in the dialect.
    pub(crate) fn pin_called(&self, block: &str, name: &str) -> Option<&str> {
        let same =
            |(of, _, there): &&(String, String, String)| of == block && there.eq_ignore_ascii_case(name);
        self.pins.iter().find(same).map(|(_, pin, _)| pin.as_str())
    }

    /// Our pin for a name that it has in other dialects, as a help.
    pub(crate) fn pin_elsewhere(&self, block: &str, name: &str) -> Option<String> {
        let called = |other: &Self| other.pin_called(block, name).is_some();
        let found = self.others.iter().filter(|other| called(other));
        let dialects: Vec<&str> = found.map(|other| other.name.as_str()).collect();
        let pin = self
            .others
            .iter()
            .find_map(|other| other.pin_called(block, name))?;
        Some(format!(
            "here it is `{pin}`; --dialect {} takes the names of that system",
            dialects.join(" or ")
        ))
    }

    /// The element with a number in the dialect: `None` if the numbers are ours, `Some(None)` if no
    /// element has it.
    pub(crate) fn element_numbered(&self, ty: &str, number: i128) -> Option<Option<&str>> {
        let mut of_type = self.numbers.iter().filter(|(of, ..)| of == ty).peekable();
        of_type.peek()?;
        let same = of_type.find(|(_, it, _)| i128::from(*it) == number);
        Some(same.map(|(.., element)| element.as_str()))
    }
}
