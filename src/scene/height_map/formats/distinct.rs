//! Samples of a few distinct values, which pack the best: a look at each value is enough, however many they are.

/// Values that are told apart: a height and three that stand for none.
const MOST: usize = 4;
/// Values that are compared at once, without a look at each.
const BLOCK: usize = 1 << 12;

/// Indices at which each of the values stands first; none where there are more than four, or a number that no other equals.
pub(super) fn firsts<T: Copy + PartialEq>(values: &[T]) -> Option<Vec<usize>> {
    let mut firsts: Vec<usize> = Vec::with_capacity(MOST);
    for (number, block) in values.chunks(BLOCK).enumerate() {
        loop {
            let found = firsts.len();
            let known =
                |index: usize| firsts.get(index.min(found.saturating_sub(1))).map_or(block[0], |at| values[*at]);
            let [a, b, c, d]: [T; MOST] = std::array::from_fn(known);
            let is_known = |value: &T| (*value == a) | (*value == b) | (*value == c) | (*value == d);
            if found > 0 && block.iter().fold(true, |are, value| are & is_known(value)) {
                break;
            }
            if found == MOST {
                return None;
            }
            let new = if found == 0 { 0 } else { block.iter().position(|value| !is_known(value))? };
            firsts.push(number * BLOCK + new);
        }
    }
    Some(firsts)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_value_is_found_where_it_stands_first() {
        let mut values = vec![7_u16; 20_000];
        assert_eq!(firsts(&values), Some(vec![0]));
        (values[4_096], values[4_097], values[19_999]) = (9, 9, 1);
        assert_eq!(firsts(&values), Some(vec![0, 4_096, 19_999]));
        values[12] = 3;
        assert_eq!(firsts(&values), Some(vec![0, 12, 4_096, 19_999]));
        values[19_998] = 5;
        assert_eq!(firsts(&values), None);
        assert_eq!(firsts::<u8>(&[]), Some(vec![]));
        assert_eq!(firsts(&[1.0, f32::NAN, 1.0]), None);
        assert_eq!(firsts(&[[1_u8, 0], [0, 1], [1, 0]]), Some(vec![0, 1]));
    }
}
