//! Smart slicing: the depth profile, the planes that follow from it, and what they light.

use std::path::PathBuf;
use std::slice::from_ref;
use std::sync::Arc;

use fumarole::gpu::{Compiler, Device};
use fumarole::measure::parameter::Choice as _;
use fumarole::measure::study::Study;
use fumarole::papers::caustics::reference::{
    Cell, PositionMap, caustics_map, depth_profile, keep_occupied, smart_planes, smart_sub_boxes, uniform_epsilon,
};
use fumarole::papers::caustics::setup::Setup;
use fumarole::papers::caustics::{
    CullSteps, IntensityRule, Parameters, ReceiverInput, SmartParameters, SmartPlacement, Variant, WaveParameters,
};
use fumarole::scene::{Light, Mesh, MeshSource, shapes};
use glam::{Mat4, UVec2, Vec2, Vec3};

use super::drawing::{Drawing, FRAME, planes_drawn};
use super::level_map::assert_meets;
use super::oracle::Oracle;
use super::scene::{OBLIQUE, OVERHEAD, POINT, bowl, floor, parameters, sphere, sunk, teapot, tilted_plane};
use crate::common::gpu_test;

const UNIFORM: SmartPlacement = SmartPlacement::Fitted { epsilon_m: None };

/// The oracle's planes for the heights that the device found.
fn expected_planes(parameters: &Parameters, height_m: f64, heights: &PositionMap) -> Vec<Cell> {
    let SmartParameters { levels, placement } = parameters.smart;
    let epsilon = match placement {
        SmartPlacement::Fitted { epsilon_m: Some(epsilon) } => f64::from(epsilon),
        _ => uniform_epsilon(height_m, parameters.planes as usize),
    };
    // A box has no more than 4,096 planes.
    let epsilon = epsilon.max(height_m / 8192.0);
    let profile = depth_profile(heights, height_m, levels as usize);
    smart_planes(height_m, levels as usize, &smart_sub_boxes(&profile), epsilon)
}

#[test]
fn the_profile_counts_the_texels_of_the_position_map() {
    gpu_test(|device| {
        for (light, levels) in [OVERHEAD, OBLIQUE, POINT].into_iter().flat_map(|l| [1, 7, 100].map(|n| (l, n))) {
            for receiver in [teapot(), sphere(), floor(), tilted_plane(), bowl()] {
                let mut parameters = parameters(light);
                parameters.smart.levels = levels;
                let drawing = Drawing::of(device, Variant::LevelMapSmart, &parameters, from_ref(&receiver));
                let oracle = Oracle::of(&parameters, &light, &receiver, &drawing.grid);
                let heights = oracle.with_heights(drawing.target("position-map"));
                let found = drawing.depth_profile.as_ref().unwrap();
                let case = format!("{} under {light:?}", receiver.mesh.name);
                assert!(
                    *found == depth_profile(&heights, oracle.receiver.height, levels as usize),
                    "{case}: {found:?}"
                );
                let texels = heights.y.iter().flatten().count();
                assert_eq!(found.iter().sum::<u32>() as usize, texels, "{case}");
                assert!(texels * 4 > heights.y.len(), "{case}: {texels}");
            }
        }
    });
}

/// The heights of the planes show in what they light: the maps meet the oracle's, drawn with its own planes.
#[test]
fn planes_stand_where_the_oracle_places_them() {
    gpu_test(|device| {
        let cases = [
            (OVERHEAD, 9, 100, UNIFORM),
            (OBLIQUE, 9, 100, UNIFORM),
            (POINT, 31, 100, UNIFORM),
            (OVERHEAD, 31, 23, UNIFORM),
            (OBLIQUE, 1, 100, UNIFORM),
            (OVERHEAD, 9, 100, SmartPlacement::Fitted { epsilon_m: Some(0.04) }),
        ];
        for ((light, planes, levels, placement), receiver) in
            cases.into_iter().flat_map(|case| [teapot(), sphere(), bowl()].map(|receiver| (case, receiver)))
        {
            let smart = SmartParameters { levels, placement };
            let parameters = Parameters { planes, smart, ..parameters(light) };
            let drawing = Drawing::of(device, Variant::LevelMapSmart, &parameters, from_ref(&receiver));
            let oracle = Oracle::of(&parameters, &light, &receiver, &drawing.grid);
            let heights = oracle.with_heights(drawing.target("position-map"));
            let cells = expected_planes(&parameters, oracle.receiver.height, &heights);
            let case = format!("{} under {light:?}, {} of {planes} planes", receiver.mesh.name, cells.len());
            assert_eq!(drawing.plane_counts, [cells.len()], "{case}");
            let map = caustics_map(&oracle.receiver, &cells, &oracle.volumes, oracle.medium, &heights);
            assert_meets(drawing.target("caustics-map"), &map, &case);
        }
    });
}

#[test]
fn every_receiver_under_every_light_has_planes_of_its_own() {
    gpu_test(|device| {
        let receivers = [teapot(), tilted_plane(), bowl()];
        let parameters = Parameters { lights: vec![OVERHEAD, POINT], ..parameters(OVERHEAD) };
        let drawing = Drawing::of(device, Variant::LevelMapSmart, &parameters, &receivers);
        let mut counts = Vec::new();
        for (l, light) in parameters.lights.iter().enumerate() {
            for (r, receiver) in receivers.iter().enumerate() {
                let oracle = Oracle::among(&parameters, light, receiver, &receivers, &drawing.grid);
                let heights = oracle.with_heights(drawing.map("position-map", l, r));
                counts.push(expected_planes(&parameters, oracle.receiver.height, &heights).len());
            }
        }
        println!("{counts:?}");
        assert_eq!(drawing.plane_counts, counts);
    });
}

/// Table 5-4 of the thesis: planes actually drawn of those specified.
#[test]
fn as_many_planes_are_drawn_as_in_table_5_4() {
    gpu_test(|device| {
        let thesis = [(teapot(), [(11, 7), (31, 19), (101, 61)]), (sphere(), [(11, 6), (31, 15), (101, 50)])];
        for (receiver, rows) in thesis {
            for (planes, expected) in rows {
                let parameters = Parameters { planes, map_size: 512, ..parameters(OVERHEAD) };
                let [found] = planes_drawn(device, &parameters, from_ref(&receiver))[..] else {
                    panic!("one receiver under one light");
                };
                println!("{}: {found} of {planes} planes, {expected} in the thesis", receiver.mesh.name);
                assert!(found.abs_diff(expected) <= 1, "{}: {found} of {planes}", receiver.mesh.name);
            }
        }
    });
}

/// Dropping the planes whose cells hold no texel changes no bit.
#[test]
fn kept_planes_light_exactly_what_all_planes_light() {
    gpu_test(|device| {
        for (light, planes) in [(OVERHEAD, 31), (OBLIQUE, 9), (POINT, 9)] {
            let mut parameters = Parameters { planes, ..parameters(light) };
            parameters.smart.placement = SmartPlacement::Kept;
            for receiver in [teapot(), bowl()] {
                let [all, kept] = [Variant::LevelMap, Variant::LevelMapSmart]
                    .map(|variant| Drawing::of(device, variant, &parameters, from_ref(&receiver)));
                for target in ["caustics-map", "combined-map", "underwater-color"] {
                    assert_eq!(all.target(target), kept.target(target), "{target}");
                }
                let oracle = Oracle::of(&parameters, &light, &receiver, &kept.grid);
                let heights = oracle.with_heights(kept.target("position-map"));
                assert_eq!(kept.plane_counts, [keep_occupied(&oracle.cells, &heights).len()]);
                assert_eq!(all.plane_counts, [planes as usize]);
            }
        }
    });
}

#[test]
fn one_pass_or_two_light_the_same() {
    gpu_test(|device| {
        let one = parameters(OBLIQUE);
        let two = Parameters { mrt: false, ..one.clone() };
        let [one, two] = [one, two].map(|p| Drawing::of(device, Variant::LevelMapSmart, &p, &[teapot()]));
        assert!(one.passes.len() < two.passes.len());
        assert_eq!(one.depth_profile, two.depth_profile);
        for target in ["position-map", "diffuse-map", "caustics-map", "combined-map", "underwater-color"] {
            assert_eq!(one.target(target), two.target(target), "{target}");
        }
    });
}

/// A floor and a sphere that floats above it, with nothing between their heights.
fn two_bodies() -> ReceiverInput {
    let mut mesh = shapes::plane(Vec2::splat(2.0), UVec2::splat(4));
    let place = Mat4::from_translation(Vec3::new(0.3, 1.2, -0.2)) * Mat4::from_scale(Vec3::splat(0.3));
    let above = shapes::sphere(24, 24).transformed(&place);
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(&above.positions);
    mesh.normals.extend(&above.normals);
    mesh.indices.extend(above.indices.iter().map(|index| first + index));
    sunk(&Mesh {
        name: "two bodies".to_owned(),
        positions: mesh.positions,
        normals: mesh.normals,
        indices: mesh.indices,
        ..Mesh::default()
    })
}

/// By the host and by the device, with the same light in every bit of every map.
fn by_host_and_device(
    device: &Arc<Device>,
    parameters: &Parameters,
    receivers: &[ReceiverInput],
    case: &str,
) -> [Drawing; 2] {
    let smart = Parameters { culled_smart: true, ..parameters.clone() };
    let by_host = Drawing::of(device, Variant::LevelMapSmart, parameters, receivers);
    let by_device = Drawing::of(device, Variant::Culled, &smart, receivers);
    assert_same(&by_host, &by_device, parameters, receivers, case);
    [by_host, by_device]
}

fn assert_same(one: &Drawing, other: &Drawing, parameters: &Parameters, receivers: &[ReceiverInput], case: &str) {
    for (light, receiver) in (0..parameters.lights.len()).flat_map(|l| (0..receivers.len()).map(move |r| (l, r))) {
        for map in ["position-map", "caustics-map", "combined-map"] {
            let (one, other) = (one.map(map, light, receiver), other.map(map, light, receiver));
            let off = one.iter().zip(other).filter(|(a, b)| a != b).count();
            assert_eq!(off, 0, "{case}: {map} {light} {receiver}, of {}", one.len());
        }
        let lit = one.map("caustics-map", light, receiver).iter().filter(|&&light| light > 0.0).count();
        assert!(lit > 500, "{case}: {lit} texels are lit");
    }
    assert!(one.target("underwater-color") == other.target("underwater-color"), "{case}");
}

/// The cells of `culled`, which the device placed.
fn cells(drawing: &Drawing) -> impl Iterator<Item = &[f32]> {
    drawing.target("plane-cells").chunks_exact(4).take_while(|cell| cell[2] > cell[1])
}

/// `culled` with the planes of smart slicing, placed on the device: where the oracle places them, and where the host does bit for bit.
#[test]
fn the_device_places_the_planes_that_the_host_places() {
    gpu_test(|device| {
        let cases = [
            (OVERHEAD, 31, 100, UNIFORM),
            (OBLIQUE, 101, 100, UNIFORM),
            (POINT, 9, 23, UNIFORM),
            (OVERHEAD, 1, 7, UNIFORM),
            (POINT, 31, 1, UNIFORM),
            (OBLIQUE, 9, 700, SmartPlacement::Fitted { epsilon_m: Some(0.01) }),
            (OVERHEAD, 9, 300, SmartPlacement::Fitted { epsilon_m: Some(1000.0) }),
        ];
        let bunny = MeshSource::File(PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/assets/meshes/bunny.obj")));
        let bunny = Setup { meshes: vec![bunny], ..Setup::default() }.load().unwrap().receivers.swap_remove(0);
        let receivers = [teapot(), sphere(), bowl(), two_bodies(), bunny];
        let mut most_boxes = 0;
        for ((light, planes, levels, placement), receiver) in
            cases.iter().flat_map(|case| receivers.iter().map(move |receiver| (*case, receiver)))
        {
            let smart = SmartParameters { levels, placement };
            let parameters = Parameters { planes, smart, ..parameters(light) };
            let case = format!("{} under {light:?}, {planes} planes, {levels} levels", receiver.mesh.name);
            let [by_host, by_device] = by_host_and_device(device, &parameters, from_ref(receiver), &case);
            let oracle = Oracle::of(&parameters, &light, receiver, &by_host.grid);
            let heights = oracle.with_heights(by_host.target("position-map"));
            let expected = expected_planes(&parameters, oracle.receiver.height, &heights);
            let found: Vec<&[f32]> = cells(&by_device).collect();
            println!("{case}: {} planes", found.len());
            assert_eq!(found.len(), expected.len(), "{case}");
            // The list's heights are from another point than the oracle's.
            let middle_m = f64::from(found[0][0]) - expected[0].plane;
            for (found, cell) in found.iter().zip(&expected) {
                let [plane, lower, upper] = [found[0], found[1], found[2]].map(f64::from);
                let off_m = (plane - middle_m - cell.plane)
                    .abs()
                    .max((lower - cell.lower).abs())
                    .max((upper - cell.upper).abs());
                assert!(off_m < 1e-6, "{case}: {found:?} {cell:?}");
            }
            let boxes = 1 + found.windows(2).filter(|pair| pair[0][1] != pair[1][2]).count();
            most_boxes = most_boxes.max(boxes);
        }
        assert!(most_boxes > 10, "no receiver has more than {most_boxes} sub-boxes");
    });
}

/// Both ends of the ranges: more levels than a workgroup has invocations, most of them empty; more planes than there are levels.
#[test]
fn the_device_slices_at_the_ends_of_the_ranges() {
    gpu_test(|device| {
        let tiny = SmartPlacement::Fitted { epsilon_m: Some(f32::MIN_POSITIVE) };
        for (receiver, planes, levels, placement) in [
            (sphere(), 2, 65_536, UNIFORM),
            (two_bodies(), 1, 4097, UNIFORM),
            (two_bodies(), 9, 1, tiny),
            (teapot(), 9, 100, tiny),
            (sphere(), 4096, 23, UNIFORM),
        ] {
            let smart = SmartParameters { levels, placement };
            let parameters = Parameters { planes, smart, water_triangles: 200, map_size: 64, ..parameters(OBLIQUE) };
            let case = format!("{}, {planes} planes, {levels} levels", receiver.mesh.name);
            let [by_host, by_device] = by_host_and_device(device, &parameters, from_ref(&receiver), &case);
            println!("{case}: {:?} planes", by_host.plane_counts);
            assert_eq!(cells(&by_device).count(), by_host.plane_counts[0], "{case}");
            let oracle = Oracle::of(&parameters, &OBLIQUE, &receiver, &by_host.grid);
            let heights = oracle.with_heights(by_host.target("position-map"));
            assert_eq!(
                by_host.plane_counts[0],
                expected_planes(&parameters, oracle.receiver.height, &heights).len(),
                "{case}"
            );
        }
    });
}

/// Several receivers and lights, steep water, options, the other compiler, each step of culling, and uniform planes where they are
/// kept.
#[test]
fn planes_of_the_device_light_what_those_of_the_host_light() {
    gpu_test(|device| {
        let receivers = [teapot(), two_bodies()];
        let steep = WaveParameters { count: 8, amplitude_m: 0.2, wavelength_m: 1.2 };
        let low = Light::Parallel { direction: Vec3::new(1.0, -0.2, 0.1), intensity: Vec3::ONE };
        let of_levels = |levels| SmartParameters { levels, ..parameters(low).smart };
        let cases = [
            Parameters {
                lights: vec![OBLIQUE, POINT],
                planes: 75,
                map_size: 97,
                water_triangles: 777,
                ..parameters(low)
            },
            Parameters { waves: steep, planes: 31, smart: of_levels(300), ..parameters(low) },
            Parameters { coverage: 3, intensity: IntensityRule::Vertex, smart: of_levels(23), ..parameters(OBLIQUE) },
            Parameters { shadows: true, planes: 200, ..parameters(POINT) },
            Parameters {
                mrt: false,
                smart: SmartParameters { placement: SmartPlacement::Kept, levels: 1 },
                ..parameters(OBLIQUE)
            },
            Parameters { planes_within_m: Some(0.5), planes: 40, ..parameters(OBLIQUE) },
            Parameters {
                planes_within_m: Some(0.5),
                smart: SmartParameters { placement: SmartPlacement::Kept, levels: 1 },
                ..parameters(OBLIQUE)
            },
        ];
        for (number, parameters) in cases.iter().enumerate() {
            let [_, by_device] = by_host_and_device(device, parameters, &receivers, &format!("case {number}"));
            if parameters.smart.placement == SmartPlacement::Kept {
                // All of them, however far away: culling drops those without a texel.
                assert_eq!(by_device.plane_counts, [parameters.planes as usize; 2], "case {number}");
            }
            let smart = Parameters { culled_smart: true, ..parameters.clone() };
            let [by_host, by_device] = [(Variant::LevelMapSmart, parameters), (Variant::Culled, &smart)]
                .map(|(variant, p)| Drawing::compiled_by(Compiler::Naga, device, variant, p, &receivers));
            assert_same(&by_host, &by_device, parameters, &receivers, &format!("case {number} by naga"));
        }
        for &cull in CullSteps::ALL {
            by_host_and_device(device, &Parameters { cull, ..cases[0].clone() }, &receivers, cull.name());
        }
    });
}

/// Nothing of the frames before adds up.
#[test]
fn planes_of_the_device_are_those_of_one_frame() {
    gpu_test(|device| {
        let smart = Parameters { culled_smart: true, ..parameters(OBLIQUE) };
        let receivers = [two_bodies()];
        let [one, three] = [FRAME, FRAME - 2]
            .map(|first| Drawing::after(first..=FRAME, Compiler::Glslang, device, Variant::Culled, &smart, &receivers));
        assert_eq!(one.target("plane-cells"), three.target("plane-cells"));
        assert!(cells(&one).count() > 1);
        assert_same(&one, &three, &smart, &receivers, "three frames");
    });
}
