//! Number of photons that make the truth certain.

/// Correlation of the truth's halves that is asked for.
const CERTAIN: f64 = 0.999;
/// Photons of a half for a texel, at the most.
pub const MOST_PHOTONS: u32 = 100_000;
/// By which photons grow at once, at the least and at the most.
const GROWTH: (f64, f64) = (1.5, 8.0);
/// Factor by which more photons must have lowered what the halves lack of correlating wholly, for still more to be worth their time.
const WORTHWHILE: f64 = 0.8;

/// The photons for a texel with which halves that correlate so are to be traced again; `before` is the correlation with fewer. None
/// where they are certain, or where more photons do not make them so: light that hardly varies correlates with nothing.
pub fn more_photons(photons: u32, halves: f64, before: Option<f64>) -> Option<u32> {
    let lacking = 1.0 - halves;
    let is_idle = before.is_some_and(|before| lacking > WORTHWHILE * (1.0 - before));
    if halves >= CERTAIN || halves.is_nan() || is_idle || photons >= MOST_PHOTONS {
        return None;
    }
    // What is lacking falls in proportion to the photons at least; a tenth more makes sure.
    let growth = (1.1 * lacking / (1.0 - CERTAIN)).clamp(GROWTH.0, GROWTH.1);
    Some((f64::from(photons) * growth).round().min(f64::from(MOST_PHOTONS)) as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn photons_grow_by_what_is_lacking() {
        assert_eq!(more_photons(100, 0.9991, None), None);
        assert_eq!(more_photons(100, 0.998, None), Some(220));
        assert_eq!(more_photons(100, 0.9989, None), Some(150));
        assert_eq!(more_photons(100, 0.5, None), Some(800));
        assert_eq!(more_photons(60_000, 0.5, None), Some(MOST_PHOTONS));
        assert_eq!(more_photons(MOST_PHOTONS, 0.5, None), None);
    }

    #[test]
    fn light_that_does_not_vary_ends_it() {
        assert_eq!(more_photons(100, f64::NAN, None), None);
        assert_eq!(more_photons(800, 0.02, Some(0.01)), None);
        assert_eq!(more_photons(800, 0.99, Some(0.9)), Some(6400));
    }
}
