//! Paths of light that is scattered any number of times: against closed forms, single scattering and what is known of slabs.

use fumarole::papers::gas::Parameters;
use fumarole::papers::gas::model::{DensityFunction, HenyeyGreenstein, SolidTexture, Volume};
use fumarole::papers::gas::parameters::default_volume;
use fumarole::papers::gas::reference::paths::{Paths, Scattered};
use fumarole::papers::gas::reference::rays::{Rays, Sampling};
use fumarole::scene::{Camera, Light};
use glam::{DVec3, Vec3};

use super::march::{FRAME, HEIGHT, WIDTH, gases, parameters};

fn picture(parameters: &Parameters, paths: u32) -> Vec<Scattered> {
    let all = Paths::new(parameters, FRAME);
    (0..parameters.height).flat_map(|row| all.row(row, paths).expect("every path ends")).collect()
}

/// Green of the mean of the halves, and the square of its standard error as the halves have it.
fn estimate([a, b]: [DVec3; 2]) -> (f64, f64) {
    ((a.y + b.y) / 2.0, ((a.y - b.y) / 2.0).powi(2))
}

/// The sum over all pixels is within four standard errors of what is expected.
fn agrees(name: &str, estimates: &[(f64, f64)], expected: impl Fn(usize) -> f64) {
    let error = estimates.iter().map(|(_, square)| square).sum::<f64>().sqrt();
    let off: f64 = estimates.iter().enumerate().map(|(i, (mean, _))| mean - expected(i)).sum();
    let light: f64 = (0..estimates.len()).map(expected).sum();
    println!("{name}: off by {:.2} standard errors, each {:.2} % of the light", off / error, 100.0 * error / light);
    assert!(off.abs() < 4.0 * error && error < 0.03 * light, "{name}: {off} of {light}, {error}");
}

/// Gas that only scatters, in light from all around, is invisible, whatever it is and however light is turned in it.
#[test]
fn what_only_scatters_shines_as_what_is_around_it() {
    for gas in gases() {
        let gas = Volume { albedo: Vec3::ONE, tau_per_m: 4.0, ..gas };
        let around = Parameters { ambient: Vec3::splat(0.7), ..parameters(vec![gas]) };
        let dark = Light::Parallel { direction: Vec3::NEG_Y, intensity: Vec3::ZERO };
        let pixels = picture(&Parameters { lights: vec![dark], ..around }, 4);
        assert!(pixels.iter().map(|pixel| 1.0 - pixel.transparency).sum::<f64>() > 5.0, "{:?}", gas.texture.function);
        for pixel in pixels {
            let expected = 0.7 * (1.0 - pixel.transparency);
            for found in pixel.all {
                // Where a bound is exceeded, weights are not 1.
                let slack = if expected > 0.0 { 0.05 } else { 0.0 };
                assert!((found.y - expected).abs() <= slack, "{:?}: {found} for {expected}", gas.texture.function);
            }
        }
    }
}

/// Light that is scattered once is what rays with shadows find, in every gas; transparencies are theirs.
#[test]
fn the_first_scattering_is_that_of_rays() {
    for gas in gases() {
        let mut own = Parameters { ambient: Vec3::ZERO, steps: 60, ..parameters(vec![gas]) };
        own.lights.truncate(2);
        let rays = Rays::new(&own, FRAME);
        let expected: Vec<_> = (0..WIDTH * HEIGHT)
            .map(|pixel| rays.pixel(pixel % WIDTH, pixel / WIDTH, true, Sampling::Fine(2)))
            .collect();
        let pixels = picture(&own, 24);
        let estimates: Vec<_> = pixels.iter().map(|pixel| estimate(pixel.once)).collect();
        agrees(&format!("{:?}", gas.texture.function), &estimates, |pixel| expected[pixel].color.y);
        for (pixel, expected) in pixels.iter().zip(&expected) {
            assert!((pixel.transparency - expected.transparency).abs() < 4e-3, "{:?}", gas.texture.function);
        }
        let more = |pixel: &Scattered| pixel.all[0].y + pixel.all[1].y - pixel.once[0].y - pixel.once[1].y;
        assert!(pixels.iter().map(more).sum::<f64>() > 0.01 * expected.iter().map(|gas| gas.color.y).sum::<f64>());
    }
}

/// S. Chandrasekhar's H function of isotropic scattering (Radiative Transfer, 1950), by its integral equation.
fn chandrasekhar(albedo: f64) -> impl Fn(f64) -> f64 {
    const COUNT: usize = 400;
    let at = |i: usize| (i as f64 + 0.5) / COUNT as f64;
    let mut values = vec![1.0; COUNT];
    let of = move |values: &[f64], mu: f64| {
        let integral: f64 =
            values.iter().enumerate().map(|(i, h)| at(i) * h / (mu + at(i))).sum::<f64>() / COUNT as f64;
        1.0 / ((1.0 - albedo).sqrt() + albedo / 2.0 * integral)
    };
    for _ in 0..200 {
        values = (0..COUNT).map(|i| f64::midpoint(values[i], of(&values, at(i)))).collect();
    }
    move |mu| of(&values, mu)
}

/// A deep slab under a slanting light, seen from above: a / 4 mu0 / (mu + mu0) H(mu) H(mu0) of its irradiance.
#[test]
fn a_deep_slab_reflects_what_is_known() {
    let albedo = 0.8;
    let texture = SolidTexture { function: DensityFunction::Constant, opaque: 1.0, ..default_volume().texture };
    let slab = Volume {
        center: Vec3::NEG_Y * 7.0,
        half_extent_m: Vec3::new(400.0, 7.0, 400.0),
        texture,
        tau_per_m: 1.0,
        albedo: Vec3::splat(albedo),
        phase: [HenyeyGreenstein { weight: 1.0, g: 0.0 }, HenyeyGreenstein { weight: 0.0, g: 0.0 }],
        ..default_volume()
    };
    for mu_0 in [0.3_f32, 1.0] {
        let direction = Vec3::new((1.0 - mu_0 * mu_0).sqrt(), -mu_0, 0.0);
        let own = Parameters {
            lights: vec![Light::Parallel { direction, intensity: Vec3::ONE }],
            ambient: Vec3::ZERO,
            camera: Camera {
                eye: Vec3::Y * 5.0,
                target: Vec3::ZERO,
                up: Vec3::Z,
                vertical_fov_rad: 0.01,
                ..Parameters::default().camera
            },
            width: 16,
            height: 16,
            ..parameters(vec![slab])
        };
        let pixels = picture(&own, 60);
        let (h, mu, mu_0, albedo) = (chandrasekhar(albedo.into()), 1.0, f64::from(mu_0), f64::from(albedo));
        let once = albedo / 4.0 * mu_0 / (mu + mu_0);
        let estimates =
            |of: fn(&Scattered) -> [DVec3; 2]| -> Vec<_> { pixels.iter().map(|p| estimate(of(p))).collect() };
        agrees("once", &estimates(|pixel| pixel.once), |_| once);
        agrees("at will", &estimates(|pixel| pixel.all), |_| once * h(mu) * h(mu_0));
    }
}

/// Two halves of a gas at one place are one gas, and gases of two albedos are met by their shares.
#[test]
fn gases_that_overlap_scatter_by_their_shares() {
    let one = gases()[1];
    let mut halves = [Volume { tau_per_m: one.tau_per_m / 2.0, ..one }; 2];
    let (once, at_once) = (parameters(vec![one]), parameters(halves.to_vec()));
    let estimates = |own: &Parameters| -> Vec<_> { picture(own, 12).iter().map(|p| estimate(p.all)).collect() };
    let (a, b) = (estimates(&once), estimates(&at_once));
    let differences: Vec<_> = a.iter().zip(&b).map(|(a, b)| (a.0 - b.0, a.1 + b.1)).collect();
    let error = differences.iter().map(|(_, square)| square).sum::<f64>().sqrt();
    let off = differences.iter().map(|(difference, _)| difference).sum::<f64>();
    assert!(error > 0.0 && off.abs() < 4.0 * error, "{off}, {error}");
    // A half that scatters nothing leaves half of what is scattered once.
    (halves[0].albedo, halves[1].albedo) = (Vec3::ZERO, Vec3::splat(0.6));
    let whole = parameters(vec![Volume { albedo: Vec3::splat(0.3), ..one }]);
    let once = |own: &Parameters| -> Vec<_> { picture(own, 12).iter().map(|p| estimate(p.once)).collect() };
    let (a, b) = (once(&whole), once(&parameters(halves.to_vec())));
    let error = a.iter().zip(&b).map(|(a, b)| a.1 + b.1).sum::<f64>().sqrt();
    let off = a.iter().zip(&b).map(|(a, b)| a.0 - b.0).sum::<f64>();
    assert!(off.abs() < 4.0 * error, "{off}, {error}");
}

/// One seed gives the same bits, however rows are asked for; more paths are nearer to their mean.
#[test]
fn paths_follow_from_the_seed_and_their_noise_falls() {
    let mut own = parameters(vec![gases()[1]]);
    own.lights.truncate(2);
    let few = picture(&own, 4);
    assert_eq!(few[WIDTH as usize * 5..WIDTH as usize * 6], Paths::new(&own, FRAME).row(5, 4).unwrap());
    assert!(few != picture(&Parameters { seed: 2, ..own.clone() }, 4));
    let noise = |pixels: &[Scattered]| pixels.iter().map(|pixel| estimate(pixel.all).1).sum::<f64>().sqrt();
    let (few, many) = (noise(&few), noise(&picture(&own, 64)));
    println!("noise of 4 and of 64 paths: {few:.2e}, {many:.2e}");
    assert!(many < 0.4 * few, "{few} {many}");
}
