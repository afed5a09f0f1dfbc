//! The variables that a trace shows, and the instances of blocks.

use super::{Part, Section, Symbol, Symbols};
use crate::types::{Member, Type};

/// An instance of a function block of the library.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BlockAt {
    /// Its path, as declared.
    pub path: String,
    /// Its block: `MC_MoveAbsolute`.
    pub block: &'static str,
    /// Its place; its key is there.
    pub address: u32,
}

/// The variables that are searched below a variable.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Wanted {
    /// Every variable of an elementary type.
    All,
    /// Global variables, outputs, and the pins of motion blocks.
    Usual,
}

impl Symbols {
    /// The default columns of a trace, at most `most`: all VAR_GLOBAL, the VAR_OUTPUT of programs and of
    /// the blocks of the sources, and the pins of motion blocks; in the order of memory.
    #[must_use]
    pub fn usual(&self, most: usize) -> Vec<Symbol> {
        let mut found = Vec::new();
        for root in &self.roots {
            self.search(&self.root(root), Wanted::Usual, most, &mut found);
        }
        found
    }

    /// All variables of elementary types at or below a path, at most `most`; `None` if there is nothing
    /// at the path.
    #[must_use]
    pub fn below(&self, path: &str, most: usize) -> Option<Vec<Symbol>> {
        if path.starts_with('%') {
            return self.find(path).map(|symbol| vec![symbol]);
        }
        let part = self.part(path)?;
        let mut found = Vec::new();
        self.search(&part, Wanted::All, most, &mut found);
        Some(found)
    }

    /// The path without the name of the program's instance, if there is one and the rest means the same.
    #[must_use]
    pub fn short<'p>(&self, path: &'p str) -> &'p str {
        let Some(only) = self.only_instance() else {
            return path;
        };
        let name = &only.member.name;
        let head = path.get(..name.len());
        let Some(rest) = head
            .filter(|head| head.eq_ignore_ascii_case(name))
            .and_then(|_| path.get(name.len()..)?.strip_prefix('.'))
        else {
            return path;
        };
        let first = rest.split(['.', '[']).next().unwrap_or(rest);
        let hidden = self
            .roots
            .iter()
            .any(|root| root.path.eq_ignore_ascii_case(first));
        if hidden { path } else { rest }
    }

    /// All instances of blocks of the library, at most `most`, in the order of memory.
    #[must_use]
    pub fn blocks(&self, most: usize) -> Vec<BlockAt> {
        let mut found = Vec::new();
        for root in &self.roots {
            self.search_blocks(&self.root(root), most, &mut found);
        }
        found
    }

    /// Whether there is a STRING at a path, which is no signal.
    #[must_use]
    pub fn is_text(&self, path: &str) -> bool {
        self.part(path)
            .is_some_and(|part| matches!(self.types.get(part.ty), Type::Text(_)))
    }

    pub(super) fn search(&self, part: &Part, wanted: Wanted, most: usize, found: &mut Vec<Symbol>) {
        if found.len() >= most {
            return;
        }
        if let Some(symbol) = self.symbol(part) {
            if wanted == Wanted::All || matches!(part.section, Section::Global | Section::Output) {
                found.push(symbol);
            }
            return;
        }
        let (wanted, skipped) = match (wanted, self.library(part)) {
            // The result of a call is shown only on request.
            (Wanted::Usual, Some(block)) if block.starts_with("MC_") => (Wanted::All, "Result"),
            (Wanted::Usual, Some(_)) => return,
            (wanted, _) => (wanted, ""),
        };
        if let Some(members) = self.members(part.ty) {
            for member in members.list.iter().filter(|member| member.name != skipped) {
                if let Some(inner) = self.part_of(part, member) {
                    self.search(&inner, wanted, most, found);
                }
            }
        }
        self.each_element(part, &mut |element| {
            self.search(element, wanted, most, found);
            found.len() < most
        });
    }

    fn search_blocks(&self, part: &Part, most: usize, found: &mut Vec<BlockAt>) {
        if let Some(block) = self.library(part) {
            if found.len() < most {
                let (path, address) = (part.path.clone(), part.address);
                found.push(BlockAt { path, block, address });
            }
            return;
        }
        if let Some(members) = self.members(part.ty) {
            let plain = |member: &Member| self.types.elementary(member.ty).is_some();
            for member in members.list.iter().filter(|member| !plain(member)) {
                if let Some(inner) = self.part_of(part, member) {
                    self.search_blocks(&inner, most, found);
                }
            }
        }
        self.each_element(part, &mut |element| {
            let before = found.len();
            self.search_blocks(element, most, found);
            // If the first element lacks it, all others do.
            found.len() > before && found.len() < most
        });
    }

    /// The block of the library that this is an instance of.
    fn library(&self, part: &Part) -> Option<&'static str> {
        match self.types.get(part.ty) {
            Type::Block(unit) => self.units.get(unit.0 as usize)?.library.map(|info| info.name),
            _ => None,
        }
    }

    /// The elements of an array in order, while `go` returns TRUE.
    fn each_element(&self, part: &Part, go: &mut dyn FnMut(&Part) -> bool) {
        let Type::Array(array) = self.types.get(part.ty) else {
            return;
        };
        let mut indices: Vec<i64> = array.bounds.iter().map(|(low, _)| *low).collect();
        for number in 0..array.count {
            if !go(&Self::element_at(part, array, &indices, number)) {
                return;
            }
            for (index, (low, high)) in indices.iter_mut().zip(&array.bounds).rev() {
                if *index < *high {
                    *index += 1;
                    break;
                }
                *index = *low;
            }
        }
    }
}
