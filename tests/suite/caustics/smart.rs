//! Smart slicing: the depth profile, the planes that follow from it, and what they light.

use std::slice::from_ref;

use fumarole::papers::caustics::reference::{
    Cell, PositionMap, caustics_map, depth_profile, keep_occupied, smart_planes, smart_sub_boxes, uniform_epsilon,
};
use fumarole::papers::caustics::{Parameters, SmartParameters, SmartPlacement, Variant};

use super::drawing::{Drawing, planes_drawn};
use super::level_map::assert_meets;
use super::oracle::Oracle;
use super::scene::{OBLIQUE, OVERHEAD, POINT, bowl, floor, parameters, sphere, teapot, tilted_plane};
use crate::common::gpu_test;

const UNIFORM: SmartPlacement = SmartPlacement::Fitted { epsilon_m: None };

/// The oracle's planes for the heights that the device found.
fn expected_planes(parameters: &Parameters, height_m: f64, heights: &PositionMap) -> Vec<Cell> {
    let SmartParameters { levels, placement } = parameters.smart;
    let epsilon = match placement {
        SmartPlacement::Fitted { epsilon_m: Some(epsilon) } => f64::from(epsilon),
        _ => uniform_epsilon(height_m, parameters.planes as usize),
    };
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
