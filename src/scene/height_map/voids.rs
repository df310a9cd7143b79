//! Heights for samples without one.
//!
//! A void becomes the mean of its four neighbours, as a membrane stretched over the hole would lie. The membrane is
//! found from coarse to fine: each coarser level averages the heights that it has, the coarsest void takes its
//! neighbours', and each finer level starts from the level before it and is relaxed a fixed number of times. So the
//! work is proportional to the map, the result is the same on every machine, and no filled height leaves the range of
//! the known ones.

const RELAXATIONS: usize = 8;

/// Fills the voids of heights, row by row, of which at least one is known.
pub(super) fn fill(mut heights: Vec<f32>, width: usize, voids: &[u32]) -> Vec<f32> {
    for &void in voids {
        heights[void as usize] = f32::NAN;
    }
    fill_level(&mut heights, width, voids);
    heights
}

/// [`fill`] for 16-bit steps, rounded to the nearest.
pub(super) fn fill_steps(mut steps: Vec<u16>, width: usize, voids: &[u32]) -> Vec<u16> {
    if !voids.is_empty() {
        let heights = fill(steps.iter().map(|&step| step.into()).collect(), width, voids);
        for &void in voids {
            steps[void as usize] = heights[void as usize].round() as u16;
        }
    }
    steps
}

/// Fills the voids of one level, which are NaN.
fn fill_level(heights: &mut [f32], width: usize, voids: &[u32]) {
    if voids.is_empty() {
        return;
    }
    let height = heights.len() / width;
    let coarse_width = width.div_ceil(2);
    let mut coarse = halve(heights, width);
    let coarse_voids: Vec<u32> =
        coarse.iter().zip(0..).filter(|(height, _)| height.is_nan()).map(|(_, index)| index).collect();
    fill_level(&mut coarse, coarse_width, &coarse_voids);
    for &void in voids {
        let (column, row) = (void as usize % width, void as usize / width);
        heights[void as usize] = upsampled(&coarse, coarse_width, column, row);
    }
    for sweep in 0..RELAXATIONS {
        // There and back, so that no side is favoured.
        for place in 0..voids.len() {
            let void = voids[if sweep % 2 == 0 { place } else { voids.len() - 1 - place }] as usize;
            let (column, row) = (void % width, void / width);
            let neighbours = [
                (column > 0).then(|| heights[void - 1]),
                (column + 1 < width).then(|| heights[void + 1]),
                (row > 0).then(|| heights[void - width]),
                (row + 1 < height).then(|| heights[void + width]),
            ];
            let (sum, count) = neighbours.iter().flatten().fold((0.0, 0.0), |(sum, count), h| (sum + h, count + 1.0));
            if count > 0.0 {
                heights[void] = sum / count;
            }
        }
    }
}

/// Half the columns and rows, rounded up: means of the known heights of two by two, NaN where none is known.
fn halve(heights: &[f32], width: usize) -> Vec<f32> {
    let coarse_row = |rows: &[f32]| -> Vec<f32> {
        let (upper, lower) = rows.split_at(width);
        let pairs = upper.chunks(2).enumerate().map(|(column, pair)| {
            let below = lower.chunks(2).nth(column).unwrap_or_default();
            let known = pair.iter().chain(below).filter(|height| !height.is_nan());
            let (sum, count) = known.fold((0.0, 0.0), |(sum, count), height| (sum + height, count + 1.0));
            // 0 / 0 is NaN: nothing is known.
            sum / count
        });
        pairs.collect()
    };
    heights.chunks(2 * width).flat_map(coarse_row).collect()
}

/// The coarse level, bilinear, at a sample of the finer level.
fn upsampled(coarse: &[f32], coarse_width: usize, column: usize, row: usize) -> f32 {
    let coarse_height = coarse.len() / coarse_width;
    // A sample's centre lies a quarter of a coarse sample beside the centre of its coarse sample.
    let tap = |fine: usize, size: usize| {
        let near = fine / 2;
        let far = if fine.is_multiple_of(2) { near.saturating_sub(1) } else { (near + 1).min(size - 1) };
        [(near, 0.75), (far, 0.25)]
    };
    let mut sum = 0.0;
    for (y, vertical) in tap(row, coarse_height) {
        for (x, horizontal) in tap(column, coarse_width) {
            sum += vertical * horizontal * coarse[y * coarse_width + x];
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    fn filled(width: usize, height: usize, known: impl Fn(usize, usize) -> Option<f32>) -> Vec<f32> {
        let heights: Vec<Option<f32>> = (0..width * height).map(|index| known(index % width, index / width)).collect();
        let voids: Vec<u32> = heights.iter().zip(0..).filter(|(h, _)| h.is_none()).map(|(_, index)| index).collect();
        fill(heights.iter().map(|height| height.unwrap_or(-9_999.0)).collect(), width, &voids)
    }

    #[test]
    fn a_hole_in_a_slope_is_bridged_by_the_slope() {
        let slope = |column: usize, row: usize| 3.0 * column as f32 - 2.0 * row as f32;
        let hole = |column: usize, row: usize| (10..30).contains(&column) && (5..21).contains(&row);
        let heights = filled(41, 33, |column, row| (!hole(column, row)).then(|| slope(column, row)));
        for (index, height) in heights.iter().enumerate() {
            let error_m = (height - slope(index % 41, index / 41)).abs();
            // The hole is 60 m wide and 32 m high.
            assert!(error_m < 1.5, "{index}: {error_m}");
            assert!(hole(index % 41, index / 41) || error_m == 0.0);
        }
    }

    #[test]
    fn one_known_height_fills_any_map() {
        for (width, height) in [(2, 2), (7, 3), (33, 64), (65, 1)] {
            let heights = filled(width, height, |column, row| (column == 1 && row == 0).then_some(12.5));
            assert!(heights.iter().all(|height| *height == 12.5), "{width} x {height}: {heights:?}");
        }
    }

    #[test]
    fn filled_heights_stay_between_the_known_ones_at_the_border_too() {
        let heights = filled(50, 20, |column, row| (column % 7 == 3 && row > 4).then(|| (column * row) as f32));
        let (low, high) = (3.0 * 5.0, 45.0 * 19.0);
        assert!(heights.iter().all(|height| (low..=high).contains(height)));
    }

    #[test]
    fn steps_are_rounded_and_known_ones_kept() {
        let steps = fill_steps(vec![10, 0, 13, 10, 11, 13], 3, &[1]);
        // The mean of 10, 13 and 11 is 11.3.
        assert_eq!(steps, [10, 11, 13, 10, 11, 13]);
    }
}
