//! The thesis's own numbers, as printed, in seconds on a GeForce 6800 where they are times.

/// A table with a row for every number of planes from 3 to 101.
#[derive(Debug, Clone, Copy)]
pub struct ThesisTable(&'static str);

/// Table 5-1. It prints one volumetric column for teapot and sphere, digit for digit, which two measurements cannot have
/// given: the sphere's ratios rest on the teapot's times.
pub const TABLE_5_1: ThesisTable = ThesisTable(include_str!("thesis_5_1.csv"));
/// Table 5-3: slicing normally against smartly.
pub const TABLE_5_3: ThesisTable = ThesisTable(include_str!("thesis_5_3.csv"));
/// Table 5-4: planes that smart slicing needs.
pub const TABLE_5_4: ThesisTable = ThesisTable(include_str!("thesis_5_4.csv"));

/// Table 5-2: polygons of the sample models; and of the appendix's others that have a name here.
pub const TABLE_5_2: [(&str, u64); 4] = [("teapot", 6_320), ("dolphin", 4_442), ("sphere", 1_984), ("box", 12)];

impl ThesisTable {
    /// The number in the column of that name, if the thesis has one.
    pub fn get(self, column: &str, planes: u32) -> Option<f64> {
        let mut lines = self.0.lines().map(|line| line.split(',').collect::<Vec<_>>());
        let at = lines.next()?.iter().position(|name| *name == column)?;
        lines.find(|row| row[0] == planes.to_string())?.get(at)?.parse().ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tables_are_read_as_printed() {
        assert_eq!(TABLE_5_1.get("teapot level-map", 3), Some(0.068));
        assert_eq!(TABLE_5_1.get("dolphin volumetric", 31), Some(1.222));
        assert_eq!(TABLE_5_3.get("sphere level-map-smart", 101), Some(0.825));
        assert_eq!(TABLE_5_4.get("teapot", 101), Some(61.0));
        assert_eq!(TABLE_5_4.get("teapot", 2), None);
        assert_eq!(TABLE_5_1.get("bunny level-map", 31), None);
    }

    #[test]
    fn every_row_is_there() {
        for planes in 3..=101 {
            assert!(TABLE_5_1.get("teapot volumetric", planes).is_some(), "{planes}");
            assert!(TABLE_5_3.get("dolphin level-map-smart", planes).is_some(), "{planes}");
            assert!(TABLE_5_4.get("sphere", planes).is_some(), "{planes}");
        }
    }

    #[test]
    fn table_5_1_prints_one_volumetric_column_twice() {
        let same = |p| TABLE_5_1.get("teapot volumetric", p) == TABLE_5_1.get("sphere volumetric", p);
        assert!((3..=101).all(same));
    }
}
