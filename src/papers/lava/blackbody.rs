//! Colours of a black body (chapter 9, "Convert lava temperature to emitted radiance"): Planck's law against the CIE 1931
//! observer, as a table by temperature that `lava/emission.glsl` reads.

use std::sync::Arc;

use ash::vk;

use super::targets::Context;
use crate::gpu::{Buffer, Error};

/// Entries of the table, from 0 to [`HOTTEST_K`]: those of `lava/emission.glsl`.
const ENTRIES: u32 = 4096;
/// The last entry's temperature, kelvin.
pub const HOTTEST_K: f32 = 10_000.0;

/// Wavelengths of [`OBSERVER`], metres.
pub(super) const FIRST_M: f64 = 360e-9;
pub(super) const STEP_M: f64 = 5e-9;

/// Planck's constant times the square of light's speed, W m^2, and times light's speed over Boltzmann's constant, m K: of
/// the SI's exact values (2019).
const HC_SQUARED: f64 = 6.626_070_15e-34 * 299_792_458.0 * 299_792_458.0;
const HC_OVER_K: f64 = 6.626_070_15e-34 * 299_792_458.0 / 1.380_649e-23;
/// Lumens of a watt at the observer's peak.
const LUMENS: f64 = 683.002;

/// XYZ of a black body, from an observer's rows from [`FIRST_M`] on: Y in candela per square metre. No light at 0 K.
pub fn xyz(kelvin: f64) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for (row, weights) in (0..).zip(OBSERVER) {
        let wavelength = FIRST_M + STEP_M * f64::from(row);
        let radiance = 2.0 * HC_SQUARED / wavelength.powi(5) / (HC_OVER_K / (wavelength * kelvin)).exp_m1();
        for (sum, weight) in sum.iter_mut().zip(weights) {
            *sum += LUMENS * STEP_M * radiance * weight;
        }
    }
    sum
}

/// Linear light of the display's primaries (ITU-R BT.709, D65), candela per square metre. Below 1,900 K a black body is
/// more saturated than the display's red and green make: what would be negative is 0.
pub fn light(kelvin: f64) -> [f64; 3] {
    let [x, y, z] = xyz(kelvin);
    [
        3.240_454_2 * x - 1.537_138_5 * y - 0.498_531_4 * z,
        -0.969_266 * x + 1.876_010_8 * y + 0.041_556 * z,
        0.055_643_4 * x - 0.204_025_9 * y + 1.057_225_2 * z,
    ]
    .map(|value| value.max(0.0))
}

/// The factor that makes the brightest primary of a black body 1; 0 where it gives no light that a number holds.
pub fn per_brightest(kelvin: f32) -> f32 {
    let brightest = light(f64::from(kelvin)).into_iter().fold(0.0, f64::max);
    let factor = (1.0 / brightest) as f32;
    if factor.is_finite() { factor } else { 0.0 }
}

/// A linear value as the display encodes it (IEC 61966-2-1).
pub fn encoded(value: f32) -> f32 {
    if value <= 0.003_130_8 { 12.92 * value } else { 1.055 * value.powf(1.0 / 2.4) - 0.055 }
}

/// The table on the device.
pub fn load(context: Context<'_>) -> Result<Arc<Buffer>, Error> {
    let entry = |at: u32| {
        let kelvin = f64::from(HOTTEST_K) * f64::from(at) / f64::from(ENTRIES - 1);
        let [r, g, b] = light(kelvin).map(|value| value as f32);
        [r, g, b, 0.0]
    };
    let table: Vec<[f32; 4]> = (0..ENTRIES).map(entry).collect();
    context.upload("emission", vk::BufferUsageFlags::STORAGE_BUFFER, bytemuck::cast_slice(&table))
}

/// The CIE 1931 standard observer (ISO/CIE 11664-1), every 5 nm.
#[rustfmt::skip]
pub(super) const OBSERVER: [[f64; 3]; 95] = [
    [0.0001299, 0.000003917, 0.0006061],
    [0.0002321, 0.000006965, 0.001086],
    [0.0004149, 0.00001239, 0.001946],
    [0.0007416, 0.00002202, 0.003486],
    [0.001368, 0.000039, 0.006450001],
    [0.002236, 0.000064, 0.01054999],
    [0.004243, 0.00012, 0.02005001],
    [0.00765, 0.000217, 0.03621],
    [0.01431, 0.000396, 0.06785001],
    [0.02319, 0.00064, 0.1102],
    [0.04351, 0.00121, 0.2074],
    [0.07763, 0.00218, 0.3713],
    [0.13438, 0.004, 0.6456],
    [0.21477, 0.0073, 1.0390501],
    [0.2839, 0.0116, 1.3856],
    [0.3285, 0.01684, 1.62296],
    [0.34828, 0.023, 1.74706],
    [0.34806, 0.0298, 1.7826],
    [0.3362, 0.038, 1.77211],
    [0.3187, 0.048, 1.7441],
    [0.2908, 0.06, 1.6692],
    [0.2511, 0.0739, 1.5281],
    [0.19536, 0.09098, 1.28764],
    [0.1421, 0.1126, 1.0419],
    [0.09564, 0.13902, 0.8129501],
    [0.05795001, 0.1693, 0.6162],
    [0.03201, 0.20802, 0.46518],
    [0.0147, 0.2586, 0.3533],
    [0.0049, 0.323, 0.272],
    [0.0024, 0.4073, 0.2123],
    [0.0093, 0.503, 0.1582],
    [0.0291, 0.6082, 0.1117],
    [0.06327, 0.71, 0.07824999],
    [0.1096, 0.7932, 0.05725001],
    [0.1655, 0.862, 0.04216],
    [0.2257499, 0.9148501, 0.02984],
    [0.2904, 0.954, 0.0203],
    [0.3597, 0.9803, 0.0134],
    [0.4334499, 0.9949501, 0.008749999],
    [0.5120501, 1.0, 0.005749999],
    [0.5945, 0.995, 0.0039],
    [0.6784, 0.9786, 0.002749999],
    [0.7621, 0.952, 0.0021],
    [0.8425, 0.9154, 0.0018],
    [0.9163, 0.87, 0.001650001],
    [0.9786, 0.8163, 0.0014],
    [1.0263, 0.757, 0.0011],
    [1.0567, 0.6949, 0.001],
    [1.0622, 0.631, 0.0008],
    [1.0456, 0.5668, 0.0006],
    [1.0026, 0.503, 0.00034],
    [0.9384, 0.4412, 0.00024],
    [0.8544499, 0.381, 0.00019],
    [0.7514, 0.321, 0.0001],
    [0.6424, 0.265, 0.00004999999],
    [0.5419, 0.217, 0.00003],
    [0.4479, 0.175, 0.00002],
    [0.3608, 0.1382, 0.00001],
    [0.2835, 0.107, 0.0],
    [0.2187, 0.0816, 0.0],
    [0.1649, 0.061, 0.0],
    [0.1212, 0.04458, 0.0],
    [0.0874, 0.032, 0.0],
    [0.0636, 0.0232, 0.0],
    [0.04677, 0.017, 0.0],
    [0.0329, 0.01192, 0.0],
    [0.0227, 0.00821, 0.0],
    [0.01584, 0.005723, 0.0],
    [0.01135916, 0.004102, 0.0],
    [0.008110916, 0.002929, 0.0],
    [0.005790346, 0.002091, 0.0],
    [0.004109457, 0.001484, 0.0],
    [0.002899327, 0.001047, 0.0],
    [0.00204919, 0.00074, 0.0],
    [0.001439971, 0.00052, 0.0],
    [0.0009999493, 0.0003611, 0.0],
    [0.0006900786, 0.0002492, 0.0],
    [0.0004760213, 0.0001719, 0.0],
    [0.0003323011, 0.00012, 0.0],
    [0.0002348261, 0.0000848, 0.0],
    [0.0001661505, 0.00006, 0.0],
    [0.000117413, 0.0000424, 0.0],
    [0.00008307527, 0.00003, 0.0],
    [0.00005870652, 0.0000212, 0.0],
    [0.00004150994, 0.00001499, 0.0],
    [0.00002935326, 0.0000106, 0.0],
    [0.00002067383, 0.0000074657, 0.0],
    [0.00001455977, 0.0000052578, 0.0],
    [0.00001025398, 0.0000037029, 0.0],
    [0.000007221456, 0.0000026078, 0.0],
    [0.000005085868, 0.0000018366, 0.0],
    [0.000003581652, 0.0000012934, 0.0],
    [0.000002522525, 0.00000091093, 0.0],
    [0.000001776509, 0.00000064153, 0.0],
    [0.000001251141, 0.00000045181, 0.0],
];

#[cfg(test)]
mod tests {
    use super::*;

    fn chromaticity(kelvin: f64) -> [f64; 2] {
        let [x, y, z] = xyz(kelvin);
        [x / (x + y + z), y / (x + y + z)]
    }

    /// Of two tables: by 1,000 K from the radiance package's `blackbody.cal`, others from Wyszecki and Stiles, *Color
    /// Science*, 2nd edition, table 1(3.11).
    #[test]
    fn chromaticities_are_the_published_ones() {
        let published = [
            (1000.0, [0.6528, 0.3444]),
            (1500.0, [0.5857, 0.3931]),
            (2000.0, [0.5267, 0.4133]),
            (2500.0, [0.4770, 0.4137]),
            (3000.0, [0.4369, 0.4041]),
            (4000.0, [0.3805, 0.3768]),
            (5000.0, [0.3451, 0.3516]),
            (6000.0, [0.3221, 0.3318]),
            (7000.0, [0.3064, 0.3166]),
            (8000.0, [0.2952, 0.3048]),
            (10_000.0, [0.2807, 0.2884]),
        ];
        for (kelvin, expected) in published {
            let found = chromaticity(kelvin);
            let off = (0..2).map(|i| (found[i] - expected[i]).abs()).fold(0.0, f64::max);
            assert!(off < 3e-4, "{kelvin} K: {found:?} {expected:?}");
        }
    }

    /// Freezing platinum, 2042 K, was the candela: 60 of them on a square centimetre.
    #[test]
    fn platinum_has_the_luminance_that_once_was_the_unit() {
        let [_, luminance, _] = xyz(2042.0);
        assert!((luminance / 6e5 - 1.0).abs() < 0.02, "{luminance}");
    }

    #[test]
    fn no_temperature_gives_what_no_display_can_show() {
        for kelvin in [0.0, 1.0, 300.0, 900.0, 1400.0, 10_000.0] {
            assert!(light(kelvin).iter().all(|value| *value >= 0.0 && value.is_finite()), "{kelvin}");
        }
        assert_eq!(per_brightest(1.0), 0.0);
        let factor = f64::from(per_brightest(1423.0));
        assert!((light(1423.0)[0] * factor - 1.0).abs() < 1e-6);
    }
}
