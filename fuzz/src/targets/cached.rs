//! Readers of the files that the program keeps in the user's folders.

use std::fs::{self, File};

use fumarole::papers::terrain::{Interpolation, read_tile_file};
#[cfg(feature = "window")]
use fumarole::report::json;
use fumarole::scene::read_kept_mesh;
#[cfg(feature = "window")]
use fumarole::window::layout::Layout;

use super::{is_one_line, written};

/// The same bytes as each kind of file, as they are and with the checksum that they ought to have.
pub fn cached(data: &[u8]) {
    mesh(data);
    if let Some(data) = with_checksum(data, 40, &[data.get(48..).unwrap_or_default()]) {
        mesh(&data);
    }
    tiles(data);
    #[cfg(feature = "window")]
    layout(data);
}

/// The data with the CRC-32 of some of it at a place.
fn with_checksum(data: &[u8], place: usize, of: &[&[u8]]) -> Option<Vec<u8>> {
    let mut data = data.to_vec();
    let mut checksum = u32::MAX;
    for byte in of.iter().copied().flatten() {
        checksum ^= u32::from(*byte);
        for _ in 0..8 {
            checksum = checksum >> 1 ^ if checksum & 1 == 1 { 0xedb8_8320 } else { 0 };
        }
    }
    data.get_mut(place..place + 4)?.copy_from_slice(&(!checksum).to_ne_bytes());
    Some(data)
}

fn mesh(data: &[u8]) {
    let mut file = File::open(written(&[("a.mesh", data)])).expect("it was written");
    if let Some(mesh) = read_kept_mesh(&mut file) {
        assert!(mesh.validate().is_ok() && mesh.name.is_empty());
        assert!(mesh.positions.len() * 24 + mesh.indices.len() * 4 <= data.len());
    }
}

/// As they are; and with zeros for all that a head without its checksums and tiles lacks.
fn tiles(data: &[u8]) {
    const HEAD: usize = 4096;
    const MOST_TILES: usize = 64;
    let length = data.len() as u64;
    tile_file(data, length);
    let number = |at: usize| {
        let bytes = data.get(at..at + 8)?.try_into().ok()?;
        usize::try_from(u64::from_ne_bytes(bytes)).ok()
    };
    let (Some(tiles), Some(record)) = (number(16), number(24)) else { return };
    if tiles > MOST_TILES || record > HEAD {
        return;
    }
    let first_tile = HEAD + 4 * tiles;
    let mut head = data.to_vec();
    head.resize(first_tile, 0);
    let of = [&head[40..(40 + record).min(HEAD)], &head[HEAD..]];
    let Some(head) = with_checksum(&head, 32, &of) else { return };
    // Tiles of 16-bit steps, and of floats.
    for texel in [2, 4] {
        tile_file(&head, (first_tile + tiles * 128 * 128 * texel) as u64);
    }
}

fn tile_file(data: &[u8], length: u64) {
    for interpolation in [Interpolation::Bilinear, Interpolation::Bicubic] {
        // One with a wrong tile is removed.
        let path = written(&[("a.tiles", data)]);
        let file = fs::OpenOptions::new().read(true).write(true).open(&path).expect("it was written");
        file.set_len(length).expect("room for a hole");
        let Some(opened) = read_tile_file(file, &path, interpolation) else { continue };
        assert!(opened.map().samples().is_empty() && opened.map().width() > 0 && opened.map().height() > 0);
        for number in 0..3 {
            match opened.read(number) {
                Ok(texels) => assert!([1 << 15, 1 << 16].contains(&texels.len())),
                Err(reason) => is_one_line(&reason),
            }
        }
    }
}

/// A layout within its bounds, that is written and read again.
#[cfg(feature = "window")]
fn layout(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    let layout = Layout::parsed(text);
    let Layout { window_size: (width, height), passes_width, parameters_width, drawer_height, .. } = layout;
    for (size, most) in
        [(width, 16_384.0), (height, 16_384.0), (passes_width, 2e3), (parameters_width, 2e3), (drawer_height, 2e3)]
    {
        assert!((60.0..=most).contains(&size), "{text:?}");
    }
    assert!((1..=100).contains(&layout.samples), "{text:?}");
    assert_eq!(Layout::parsed(&json::to_string(&layout).expect("a layout is JSON")), layout);
}
