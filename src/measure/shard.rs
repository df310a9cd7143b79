//! Shares of work that several processes or machines do.

use std::fmt;
use std::ops::Range;
use std::str::FromStr;

/// The most processes that share some work.
pub const MOST: u32 = 100_000;

/// One of several processes that share some work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// From 0 to `count` - 1.
    pub number: u32,
    /// From 1 to [`MOST`].
    pub count: u32,
}

impl Shard {
    /// A process that shares with no other.
    pub const ALONE: Shard = Shard { number: 0, count: 1 };

    /// Its part of a range: consecutive, and as long as the others' but for one.
    pub fn of(self, whole: Range<u32>) -> Range<u32> {
        let length = u64::from(whole.end - whole.start);
        let place = |number: u32| whole.start + (length * u64::from(number) / u64::from(self.count)) as u32;
        place(self.number)..place(self.number + 1)
    }

    /// True for what is its of a list that is dealt out one by one.
    pub fn has(self, index: usize) -> bool {
        index % self.count as usize == self.number as usize
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("{text:?} is no shard: give I/N, with I from 0 to N - 1 and N at most {MOST}");
        let (number, count) = text.split_once('/').ok_or_else(wrong)?;
        match (number.parse(), count.parse()) {
            (Ok(number), Ok(count)) if number < count && count <= MOST => Ok(Shard { number, count }),
            _ => Err(wrong()),
        }
    }
}

impl fmt::Display for Shard {
    /// As a part of a file's name.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "shard-{}-of-{}", self.number, self.count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_cover_a_range_once() {
        for (whole, count) in [(0..24, 6), (5..12, 3), (0..2, 5), (7..8, 1), (0..u32::MAX, 7)] {
            let shards = (0..count).map(|number| Shard { number, count });
            let parts: Vec<_> = shards.clone().map(|shard| shard.of(whole.clone())).collect();
            assert_eq!((parts[0].start, parts[parts.len() - 1].end), (whole.start, whole.end));
            assert!(parts.windows(2).all(|pair| pair[0].end == pair[1].start));
            let lengths = parts.iter().map(|part| part.end - part.start);
            assert!(lengths.clone().max().unwrap() - lengths.min().unwrap() <= 1);
            assert!((0..100).all(|index| shards.clone().filter(|shard| shard.has(index)).count() == 1));
        }
    }

    #[test]
    fn shards_are_checked() {
        assert_eq!("5/6".parse(), Ok(Shard { number: 5, count: 6 }));
        for text in ["6/6", "1", "-1/2", "0/0", "a/b", "0/100001", ""] {
            assert!(text.parse::<Shard>().is_err(), "{text}");
        }
    }
}
