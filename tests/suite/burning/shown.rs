//! Normals and colours are made anew where something has changed since the last picture, and the stream where a triangle
//! has left; they are what a first picture of the same state has.

use std::sync::Arc;

use fumarole::gpu::Device;
use fumarole::measure::Paper;
use fumarole::papers::burning::model::with_triangles;
use fumarole::papers::burning::{Look, Parameters, Variant};
use fumarole::scene::{Mesh, MeshSource, shapes};

use super::fire::{Fire, ball, quick};
use crate::common::gpu_test;

/// Places, normals, colours and drawn triangles of a picture, as bits.
fn picture(fire: &Fire) -> [Vec<u32>; 4] {
    let buffers = fire.paper.buffers();
    let mut picture = [&buffers.mapped, &buffers.normals, &buffers.colors, &buffers.stream].map(|list| fire.read(list));
    picture[3].truncate(3 * fire.state().counts.drawn_triangles as usize);
    picture
}

fn check(device: &Arc<Device>, variant: Variant, parameters: &Parameters, mesh: &Mesh, frames: [u32; 3]) {
    let mut steps = Fire::new(device, variant, parameters, mesh);
    let mut jump = Fire::new(device, variant, parameters, mesh);
    let mut number = 0;
    for last in frames {
        (number..=last).for_each(|number| steps.frame(number));
        number = last + 1;
        jump.paper.restart().unwrap();
        jump.frame(last);
        for (own, first) in picture(&steps).iter().zip(picture(&jump)) {
            assert!(*own == first, "{variant:?}, frame {last}");
        }
    }
    assert!(steps.state().counts.live_vertices < jump.paper.model().vertex_count(), "the case is too tame");
    steps.paper.restart().unwrap();
    steps.frame(frames[2]);
    assert!(picture(&steps) == picture(&jump), "{variant:?}, after a restart");
}

#[test]
fn a_picture_of_a_shell_does_not_depend_on_those_before_it() {
    gpu_test(|device| {
        let bunny = with_triangles(&MeshSource::Bunny.load().unwrap(), 2000);
        for keep_connected in [false, true] {
            check(device, Variant::Shell, &Parameters { keep_connected, ..quick() }, &bunny, [40, 63, 90]);
        }
        let natural = Parameters { look: Look::Natural, ..quick() };
        check(device, Variant::Shell, &natural, &with_triangles(&shapes::teapot(), 2000), [50, 80, 110]);
    });
}

#[test]
fn nor_does_one_of_solids_wax_and_refined_objects() {
    gpu_test(|device| {
        check(device, Variant::Solid, &quick(), &ball(), [40, 63, 90]);
        check(device, Variant::Melting, &quick(), &ball(), [40, 63, 90]);
        let levels = Parameters { levels: Some(3), ..quick() };
        check(device, Variant::LowPoly, &levels, &shapes::cuboid(), [40, 80, 120]);
        // A picture in the middle of a tick has the colours of the radius then, if none was made at the tick's end.
        let divided = Parameters { time_division: 3, ..levels };
        check(device, Variant::FullySubdivided, &divided, &shapes::cuboid(), [119, 239, 359]);
    });
}

#[test]
fn what_is_touched_follows_the_fire() {
    gpu_test(|device| {
        let bunny = with_triangles(&MeshSource::Bunny.load().unwrap(), 20_000);
        // What turns with its block is touched too: small blocks.
        let parameters = Parameters { speed_per_s: 0.1, flammability: 12, blocks: [40; 3], ..quick() };
        let mut fire = Fire::new(device, Variant::Shell, &parameters, &bunny);
        (0..200).for_each(|number| fire.frame(number));
        let (model, counts) = (fire.paper.model(), fire.state().counts);
        let touched: Vec<u32> = fire.read(&fire.paper.buffers().touched);
        let now = touched.iter().filter(|tick| **tick == counts.tick).count();
        let active = counts.active_vertices as usize;
        assert!(active > 50 && now >= active && now < model.rest.len() / 3, "{active} active, {now} touched");
    });
}
