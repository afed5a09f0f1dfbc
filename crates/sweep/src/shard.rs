//! The cases of a sweep that a process computes.

use std::fmt;
use std::str::FromStr;

/// Every n-th case, beginning with the i-th. Neighbouring cases often have similar cost, so shards take
/// about the same time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// From 0.
    index: u64,
    of: u64,
}

impl Shard {
    /// All cases.
    pub const ALL: Self = Self { index: 0, of: 1 };

    /// Its cases among `count`, in order.
    pub fn cases(self, count: u64) -> impl Iterator<Item = u64> {
        // `of` is at least 1, and a sweep that can run has no cases beyond the range of usize.
        (self.index..count).step_by(usize::try_from(self.of).unwrap_or(usize::MAX))
    }

    /// Whether it has this case.
    pub const fn has(self, case: u64) -> bool {
        case % self.of == self.index
    }
}

/// `i/n`, i from 1.
impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.split_once('/');
        let parts = parts.and_then(|(i, n)| Some((i.parse::<u64>().ok()?, n.parse::<u64>().ok()?)));
        match parts {
            Some((i, of)) if (1..=of).contains(&i) => Ok(Self { index: i - 1, of }),
            Some((i, of)) => Err(format!("there is no shard {i} of {of}: shards count from 1")),
            None => Err("write I/N, such as 2/8".to_owned()),
        }
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}/{}", self.index + 1, self.of)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_share_the_cases_out_without_rest() {
        let shards: Vec<Shard> = ["1/3", "2/3", "3/3"]
            .map(|text| text.parse().expect(text))
            .to_vec();
        let mut all: Vec<u64> = shards.iter().flat_map(|shard| shard.cases(10)).collect();
        assert_eq!(shards[1].cases(10).collect::<Vec<_>>(), [1, 4, 7]);
        all.sort_unstable();
        assert_eq!(all, (0..10).collect::<Vec<_>>());
        assert_eq!(Shard::ALL.cases(3).collect::<Vec<_>>(), [0, 1, 2]);
        assert!(shards[1].has(4) && !shards[1].has(5));
        assert_eq!(shards[1].to_string(), "2/3");
    }

    #[test]
    fn a_shard_that_does_not_exist_is_refused() {
        for wrong in ["0/3", "4/3", "1/0", "3", "a/b", "-1/2", ""] {
            assert!(wrong.parse::<Shard>().is_err(), "{wrong}");
        }
    }
}
