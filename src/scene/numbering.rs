//! Numbers for keys of three words, in the order of first use: welded positions, corners of faces.

use std::hash::{BuildHasher, RandomState};

use glam::Vec3;

/// No key in a slot.
const FREE: u32 = u32::MAX;

/// Gives equal keys the same number.
///
/// Linear probing over a list of the keys: 16 to 24 bytes a key, where a map of keys to numbers takes twice that. Its
/// hash differs from process to process, so that no file can be made that has all keys fall together.
pub struct Numbering {
    keys: Vec<[u32; 3]>,
    slots: Vec<u32>,
    seed: u64,
}

impl Default for Numbering {
    fn default() -> Self {
        Numbering { keys: Vec::new(), slots: vec![FREE; 16], seed: RandomState::new().hash_one(0_u8) | 1 }
    }
}

impl Numbering {
    /// The key of a position; -0 and +0 are equal.
    pub fn key_of(position: Vec3) -> [u32; 3] {
        (position + Vec3::ZERO).to_array().map(f32::to_bits)
    }

    /// The number of a key.
    pub fn number(&mut self, key: [u32; 3]) -> u32 {
        if 3 * self.keys.len() >= 2 * self.slots.len() {
            self.grow();
        }
        let mut slot = self.slot_of(key);
        loop {
            let number = self.slots[slot];
            if number == FREE {
                // A mesh has fewer than u32::MAX vertices, which its loader checks.
                let next = self.keys.len() as u32;
                self.slots[slot] = next;
                self.keys.push(key);
                return next;
            }
            if self.keys[number as usize] == key {
                return number;
            }
            slot = (slot + 1) & (self.slots.len() - 1);
        }
    }

    /// Number of keys.
    pub fn len(&self) -> usize {
        self.keys.len()
    }

    /// The keys in the order of their numbers.
    pub fn into_keys(self) -> Vec<[u32; 3]> {
        self.keys
    }

    /// The keys as positions, [`Numbering::key_of`] which they were.
    pub fn into_positions(self) -> Vec<Vec3> {
        self.keys.into_iter().map(|key| Vec3::from_array(key.map(f32::from_bits))).collect()
    }

    fn slot_of(&self, key: [u32; 3]) -> usize {
        let [a, b, c] = key.map(u64::from);
        let product = u128::from((a | b << 32) ^ self.seed) * u128::from((c | c << 32) ^ self.seed.rotate_left(29) | 1);
        let folded = (product as u64) ^ (product >> 64) as u64;
        let mixed = folded.wrapping_mul(0x9e37_79b9_7f4a_7c15);
        // The length is a power of two, 2^4 at least.
        (mixed >> (64 - self.slots.len().trailing_zeros())) as usize
    }

    fn grow(&mut self) {
        let length = 2 * self.slots.len();
        self.slots = Vec::new();
        self.slots = vec![FREE; length];
        for number in 0..self.keys.len() {
            let mut slot = self.slot_of(self.keys[number]);
            while self.slots[slot] != FREE {
                slot = (slot + 1) & (length - 1);
            }
            self.slots[slot] = number as u32;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::random::Random;
    use std::collections::HashMap;

    #[test]
    fn numbers_are_those_of_a_map() {
        let mut random = Random::new(5);
        let (mut numbering, mut map) = (Numbering::default(), HashMap::new());
        for _ in 0..50_000 {
            let key = [0; 3].map(|_: u32| random.next_u32() % 40);
            let next = map.len() as u32;
            assert_eq!(numbering.number(key), *map.entry(key).or_insert(next));
        }
        assert_eq!(numbering.len(), map.len());
        assert!(numbering.into_keys().iter().zip(0..).all(|(key, number)| map[key] == number));
    }

    #[test]
    fn signs_of_zero_are_one_position() {
        let mut numbering = Numbering::default();
        for (position, number) in [(Vec3::ZERO, 0), (Vec3::X, 1), (Vec3::new(-0.0, 0.0, -0.0), 0)] {
            assert_eq!(numbering.number(Numbering::key_of(position)), number);
        }
        assert_eq!(numbering.into_positions(), [Vec3::ZERO, Vec3::X]);
    }
}
