//! The interface as it is drawn where it has changed, against all of it drawn anew: the same picture, bit for bit.

use ash::vk;
use egui::{Event, Key, Modifiers, PointerButton, Pos2, RawInput, Rect};
use fumarole::gpu::transfer::read_image;
use fumarole::window::interface::Interface;
use fumarole::window::layout::Layout;
use fumarole::window::painter::Painter;

use super::interface::{built, frame, ready, setup};
use crate::common::gpu_test;

const EXTENT: (u32, u32) = (1000, 640);
const FORMAT: vk::Format = vk::Format::B8G8R8A8_UNORM;

/// A user's next action: keys that open and close panels, lists and colours, and a pointer that goes everywhere.
fn events(random: &mut impl FnMut(u32) -> u32) -> Vec<Event> {
    const KEYS: [Key; 14] = [
        Key::F1,
        Key::F1,
        Key::F2,
        Key::F3,
        Key::F4,
        Key::L,
        Key::M,
        Key::Space,
        Key::Tab,
        Key::Tab,
        Key::CloseBracket,
        Key::B,
        Key::Num1,
        Key::Num0,
    ];
    let pos = Pos2::new(random(EXTENT.0) as f32 + 0.5, random(EXTENT.1) as f32);
    let button = |pressed| {
        let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
        Event::PointerButton { pos, button, pressed, modifiers }
    };
    match random(6) {
        0 => {
            let key = KEYS[random(KEYS.len() as u32) as usize];
            let (physical_key, repeat, modifiers) = (None, false, Modifiers::NONE);
            [true, false].map(|pressed| Event::Key { key, physical_key, pressed, repeat, modifiers }).to_vec()
        }
        1 => vec![Event::PointerMoved(pos), button(true)],
        2 => vec![button(false)],
        3 => vec![Event::PointerMoved(pos)],
        _ => Vec::new(),
    }
}

#[test]
fn what_is_drawn_where_it_changed_is_what_is_drawn_anew() {
    gpu_test(|device| {
        let context = egui::Context::default();
        let mut face = Interface::new(&context, vec!["lava", "caustics"], "caustics", Layout::default());
        for event in [ready(), setup(&["level-map"]), built(1)] {
            face.take(event);
        }
        let (mut parts, mut wholes) = (Painter::new(device).unwrap(), Painter::new(device).unwrap());
        let mut seed = 1_u32;
        let mut random = |most: u32| {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 8) % most
        };
        let mut unchanged = 0;
        for step in 0..120_u32 {
            let sides = if step < 60 { 1 } else { 2 };
            // Now and then a new picture comes alone, and the panels stay as they are.
            let is_picture_alone = step % 6 == 1;
            match step {
                60 => [setup(&["level-map", "volumetric"]), built(2)].into_iter().for_each(|event| face.take(event)),
                _ if step % 3 == 0 || is_picture_alone => face.take(frame(step, sides)),
                _ => {}
            }
            if step % 40 == 39 {
                context.set_zoom_factor([1.25, 0.8, 1.0][step as usize / 40]);
            }
            let size = egui::vec2(EXTENT.0 as f32, EXTENT.1 as f32) / context.zoom_factor();
            let (changes, shapes) = if is_picture_alone {
                face.update_pictures(&context);
                (context.tex_manager().write().take_delta(), None)
            } else {
                let input = RawInput {
                    screen_rect: Some(Rect::from_min_size(Pos2::ZERO, size)),
                    time: Some(f64::from(step) * 0.4),
                    events: events(&mut random),
                    ..RawInput::default()
                };
                let output = context.run(input, |context| face.show(context));
                (output.textures_delta, Some((output.pixels_per_point, output.shapes)))
            };
            let tessellate = |shapes| context.tessellate(shapes, context.pixels_per_point());
            for painter in [&mut parts, &mut wholes] {
                painter.update(&changes.set).unwrap();
                match &shapes {
                    Some((pixels_per_point, shapes)) => painter.take(*pixels_per_point, shapes.clone()),
                    None => painter.take_textures(),
                }
            }
            let (width, height) = EXTENT;
            unchanged += u32::from(parts.paint((width, height, FORMAT), tessellate).unwrap().is_none());
            // A picture of another size is drawn whole.
            for height in [height + 1, height] {
                wholes.paint((width, height, FORMAT), tessellate).unwrap();
            }
            let [a, b] = [&parts, &wholes].map(|painter| read_image(device, &painter.picture().unwrap()).unwrap());
            if let Some(at) = a.iter().zip(&b).position(|(a, b)| a != b) {
                let (pixel, differing) = (at / 4, a.iter().zip(&b).filter(|(a, b)| a != b).count());
                let place = (pixel % width as usize, pixel / width as usize);
                panic!("step {step}: {} and {} at {place:?}, {differing} bytes differ", a[at], b[at]);
            }
            [&mut parts, &mut wholes].into_iter().for_each(|painter| painter.free(&changes.free));
            face.wishes();
        }
        assert!(unchanged > 5, "{unchanged} of 120 frames were drawn not at all");
    });
}
