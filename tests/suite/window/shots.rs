use super::display::{Display, Window};
use crate::cli::program::fumarole;
use fumarole::image::write_png;
use std::thread::sleep;
use std::time::Duration;

const SCENES: [(&str, &str); 5] = [
    ("lava", "--size 480x360 --particles 2000"),
    ("gas", "--size 480x360 --steps 12 --table 16"),
    ("caustics", "--size 600x375"),
    ("burning", "--size 480x320"),
    ("terrain", "--size 600x375 --resolution 257"),
];

#[test]
fn shots() {
    let folder = std::path::PathBuf::from(std::env::var("SHOTS").unwrap());
    let only = std::env::var("SHOTS_OF").unwrap_or_default();
    for (paper, scene) in SCENES {
        if !only.is_empty() && !only.split(',').any(|one| one == paper) {
            continue;
        }
        let display = Display::start();
        let mut window = Window::start(&display, fumarole(&format!("view {paper} {scene}")).on_test_device());
        window.resize(1280, 800);
        window.wait_for_frame(0);
        let shot = |name: &str| {
            sleep(Duration::from_millis(700));
            let whole = display.screenshot();
            write_png(&folder.join(format!("{paper}-{name}.png")), &whole).unwrap();
        };
        display.key('m' as u32);
        sleep(Duration::from_millis(3000));
        shot("1280-dark");
        display.key(']' as u32);
        display.key(']' as u32);
        sleep(Duration::from_millis(1500));
        shot("1280-dark-pass");
        display.key('l' as u32);
        shot("1280-light-pass");
        display.key('t' as u32);
        shot("1280-light");
        window.resize(800, 600);
        shot("800-light");
        display.key(']' as u32);
        sleep(Duration::from_millis(700));
        display.key('l' as u32);
        shot("800-dark-pass");
        display.key('t' as u32);
        if paper == "caustics" {
            window.resize(1280, 800);
            display.key('c' as u32);
            sleep(Duration::from_millis(2500));
            shot("1280-compare");
            display.key('b' as u32);
            display.key('b' as u32);
            sleep(Duration::from_millis(1000));
            shot("1280-difference");
            for tab in ["Memory", "Device", "Messages", "Keep", "Bench"] {
                window.click(tab);
                shot(&format!("1280-{tab}"));
            }
            display.key(0xffbe);
            shot("1280-keys");
        }
        window.close().succeeded();
    }
}
