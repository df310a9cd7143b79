//! The variant `gpu-driven` beside the oracle and the thesis's way, where the tests of both variants do not reach.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use bytemuck::Pod;
use fumarole::gpu::bindings::Resource;
use fumarole::gpu::transfer::read_buffer;
use fumarole::gpu::{Buffer, Compiler, Device, PassKind, Track};
use fumarole::image::Rgba8;
use fumarole::image::golden;
use fumarole::measure::Paper;
use fumarole::papers::lava::reference::density;
use fumarole::papers::lava::{
    Bed, CAMERAS, Cells, GpuDriven, Lava, Method, Parameters, Particles, Rock, SurfaceDraw, Variant,
};
use glam::{DVec3, Vec3};

use super::pictures::{TOLERANCE, reduced};
use super::scene::{clamped, densities, draw, driven, grid, parameters, texels, variant_of};
use crate::common::{gpu_test, shaders_by};

fn method(lava: &Lava) -> &GpuDriven {
    match &lava.method {
        Method::GpuDriven(driven) => driven,
        Method::Paper(_) => panic!("it is the other variant"),
    }
}

fn words<T: Pod>(device: &Arc<Device>, buffer: &Arc<Buffer>) -> Vec<T> {
    bytemuck::pod_collect_to_vec(&read_buffer(device, buffer).unwrap())
}

#[test]
fn nothing_is_read_back_and_nothing_waits() {
    gpu_test(|device| {
        let mut lava = driven(device, &Parameters { geometry_stage: false, ..parameters() });
        let sample = draw(device, &mut lava, 0);
        let passes: Vec<_> = sample.passes.iter().map(|p| (p.info.name, p.calls)).collect();
        assert_eq!(
            passes,
            [
                ("animate", 1),
                ("cell-keys", 1),
                // 1,000 particles are in at most 1,000 cells, of two digits.
                ("sort-count", 2),
                ("sort-sum", 6),
                ("sort-scatter", 2),
                ("arrange", 1),
                ("cell-starts", 1),
                ("density", 1),
                ("extract", 1),
                ("accumulate-depths", 1),
                ("normal-height", 1),
                ("highest-rows", 1),
                ("highest", 1),
                ("march", 1),
                ("normalisation", 1),
            ]
        );
        for pass in &sample.passes {
            assert!(matches!(pass.info.kind, PassKind::Compute | PassKind::Graphics), "{}", pass.info.name);
            assert!(pass.wait_ms.is_none() && pass.host_ms.is_none(), "{}", pass.info.name);
        }
    });
}

/// Every particle in its cell, in each cell in the order of their numbers.
#[test]
fn particles_are_sorted_by_cells_and_the_sort_is_stable() {
    gpu_test(|device| {
        let cases = [
            parameters(),
            Parameters { particles: 5000, radius_m: 0.02, ..parameters() },
            Parameters { particles: 20_000, radius_m: 0.03, ..parameters() },
            Parameters { particles: 700, radius_m: 0.9, ..parameters() },
            Parameters { particles: 1, ..parameters() },
        ];
        for parameters in cases {
            let mut lava = driven(device, &parameters);
            draw(device, &mut lava, 3);
            let sort = &method(&lava).sort;
            let starts: Vec<u32> = words(device, &sort.starts);
            let sorted: Vec<[f32; 4]> = texels(device, &sort.places);
            let cells = Cells::new(&parameters, parameters.particles);
            assert_eq!(starts.len(), cells.count() as usize + 1);
            assert_eq!((starts[0], starts[starts.len() - 1]), (0, parameters.particles));
            let key = |place: Vec3| place.to_array().map(f32::to_bits);
            let places = clamped(device, &lava, &parameters);
            let numbers: HashMap<_, usize> = places.iter().enumerate().map(|(i, p)| (key(p.as_vec3()), i)).collect();
            assert_eq!(numbers.len(), places.len(), "no two particles are in one place");
            let mut found = 0;
            for (cell, ends) in starts.windows(2).enumerate() {
                let (y, column) = (cell as u32 % cells.counts[1], cell as u32 / cells.counts[1]);
                let at = Vec3::new((column % cells.counts[0]) as f32, y as f32, (column / cells.counts[0]) as f32);
                let mut before = None;
                for &[x, y, z, _] in &sorted[ends[0] as usize..ends[1] as usize] {
                    let place = Vec3::new(x, y, z);
                    let inside = place / parameters.space_m * Vec3::from(cells.counts.map(|n| n as f32)) - at;
                    let is_inside = inside.cmpge(Vec3::splat(-1e-4)).all() && inside.cmple(Vec3::splat(1.0001)).all();
                    assert!(is_inside, "{place} in cell {cell}");
                    let number = numbers[&key(place)];
                    assert!(before.is_none_or(|before| before < number), "{cell}: {before:?} {number}");
                    before = Some(number);
                    found += 1;
                }
            }
            assert_eq!(found, places.len());
        }
    });
}

#[test]
fn two_runs_are_equal_to_the_bit() {
    gpu_test(|device| {
        let parameters = Parameters { particles: 20_000, ..parameters() };
        let run = || {
            let mut lava = driven(device, &parameters);
            let frames: Vec<_> = [0, 2]
                .map(|number| {
                    draw(device, &mut lava, number);
                    (texels::<u32>(device, lava.method.density()), texels::<u32>(device, &lava.normal_height.surface))
                })
                .into();
            frames
        };
        let first = run();
        assert!(first == run());
        assert!(first[0] != first[1]);
    });
}

/// Submissions of less work give the same to the bit, in whatever parts.
#[test]
fn a_frame_in_several_submissions_is_the_same() {
    gpu_test(|device| {
        let wide = Parameters { density: [61, 10, 37], radius_m: 0.4, ..parameters() };
        for parameters in [parameters(), wide] {
            let run = |most_work: Option<f64>| {
                let mut lava = driven(device, &parameters);
                if let Method::GpuDriven(driven) = &mut lava.method {
                    driven.most_work = most_work.unwrap_or(driven.most_work);
                }
                let sample = draw(device, &mut lava, 2);
                let of = |name: &str| {
                    let pass = sample.passes.iter().find(|p| p.info.name == name).unwrap();
                    (pass.calls, pass.wait_ms.is_some())
                };
                let passes = [of("density"), of("accumulate-depths")];
                let submissions = sample.spans.iter().filter(|span| span.track == Track::Wait).count();
                let targets = [lava.method.density(), lava.method.sums()];
                (passes, submissions, targets.map(|target| texels::<u32>(device, target)))
            };
            let (passes, submissions, whole) = run(None);
            assert_eq!((passes, submissions), ([(1, false); 2], 1));
            for most_work in [3e3, 1e4] {
                let (passes, submissions, found) = run(Some(most_work));
                assert!(passes.iter().all(|&(calls, waits)| calls > 1 && !waits), "{passes:?}");
                assert!(submissions > 1, "{most_work}");
                assert!(found == whole, "{most_work}");
            }
        }
    });
}

/// More particles in one stretch of cells than one dispatch takes: in one spot, as far as the radius sees.
#[test]
fn stretches_are_gathered_piece_by_piece() {
    gpu_test(|device| {
        let count = 61_000;
        let parameters = Parameters {
            particles: count,
            density: [6, 5, 6],
            radius_m: 0.9,
            time_step_s: 0.0,
            surface_draw: Some(SurfaceDraw::March),
            ..parameters()
        };
        let spots = [Vec3::new(0.3, 0.4, 0.5), Vec3::new(1.7, 0.9, 0.8)];
        let at = |i: u32| spots[usize::from(i.is_multiple_of(50))] + 1e-6 * (i % 7) as f32;
        let particles = Particles {
            positions: (0..count).map(at).collect(),
            velocities: vec![Vec3::ZERO; count as usize],
            temperatures_k: Vec::new(),
            bed: Bed::level(),
        };
        let mut lava = variant_of(device, Variant::GpuDriven, &parameters, &particles);
        let sample = draw(device, &mut lava, 0);
        assert_eq!(sample.passes.iter().find(|p| p.info.name == "density").unwrap().calls, 3);
        let radius = f64::from(parameters.radius_m);
        let found = densities(device, &lava, &parameters);
        for (index, found) in grid(&parameters).indices().zip(&found) {
            let place: DVec3 = grid(&parameters).place(index);
            let each = spots.map(|spot| density(place.distance(spot.as_dvec3()), radius));
            let expected = each[0] * f64::from(count) * 0.98 + each[1] * f64::from(count) * 0.02;
            let off = (found - expected).abs() / (f64::from(count) * density(0.0, radius));
            // Equal terms are rounded to one side.
            assert!(off < 1e-3, "{index:?}: {found} {expected}");
        }
        // A second frame begins at nothing.
        draw(device, &mut lava, 1);
        assert!(found == densities(device, &lava, &parameters));
    });
}

/// By splats it draws what the thesis's way draws: the goldens of `paper`.
#[test]
fn its_splats_are_the_golden_pictures() {
    gpu_test(|device| {
        for (name, camera) in CAMERAS {
            let parameters = Parameters { camera, surface_draw: Some(SurfaceDraw::Splats), ..reduced() };
            let mut lava = driven(device, &parameters);
            draw(device, &mut lava, 0);
            let view = lava.picture();
            let picture = Rgba8::new(view.width(), view.height(), texels(device, view)).unwrap();
            let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/golden/lava-{name}.png"));
            if let Err(error) = golden::check(&picture, &golden, TOLERANCE, Path::new(env!("CARGO_TARGET_TMPDIR"))) {
                panic!("{error}");
            }
        }
    });
}

#[test]
fn both_compilers_gather_the_same() {
    gpu_test(|device| {
        let parameters = Parameters { geometry_stage: false, ..parameters() };
        let heights = [Compiler::Glslang, Compiler::Naga].map(|compiler| {
            let shaders = shaders_by(device, compiler);
            let particles = Particles::seeded(&parameters);
            let rock = Rock::built_in();
            let mut lava = Lava::new(&shaders, "test", Variant::GpuDriven, &parameters, &particles, rock, &[]).unwrap();
            let sample = draw(device, &mut lava, 1);
            assert!(sample.passes.iter().all(|p| p.info.compiler == Some(compiler)));
            texels::<[f32; 4]>(device, &lava.normal_height.surface)
        });
        for (a, b) in heights[0].iter().zip(&heights[1]) {
            assert!((0..4).all(|i| (a[i] - b[i]).abs() < 1e-5), "{a:?} {b:?}");
        }
    });
}

#[test]
fn extreme_configurations_draw_finite_values() {
    gpu_test(|device| {
        let small = Parameters { particles: 300, density: [12, 9, 8], width: 40, height: 30, ..parameters() };
        let cases = [
            Parameters { particles: 1, density: [1; 3], width: 1, height: 1, ..small.clone() },
            Parameters { time_step_s: 1000.0, speed_m_s: 1000.0, ..small.clone() },
            Parameters { radius_m: 1.0, ..small.clone() },
            Parameters { radius_m: 1e-30, rho: Some(1e-30), ..small.clone() },
            Parameters { density: [3, 1, 2], radius_m: 0.01, ..small.clone() },
            Parameters { space_m: Vec3::new(1000.0, 1e-3, 1e-3), radius_m: 1e-3, splat_radius_m: 1e-3, ..small },
        ];
        for (case, parameters) in cases.into_iter().enumerate() {
            let mut lava = driven(device, &parameters);
            for number in [0, 1] {
                draw(device, &mut lava, number);
            }
            assert!(method(&lava).accepted(device).unwrap().density_range[1] >= 0.0);
            for target in lava.targets().into_iter().filter(|t| t.name != "picture") {
                let Resource::Image(view) = &target.resource else { panic!("{} is an image", target.name) };
                let values: Vec<f32> = texels(device, view);
                assert!(values.iter().all(|v| v.is_finite()), "case {case}: {}", target.name);
            }
        }
    });
}
