//! Dumps of `burning` as a second program reads them: volumes and topology.

use std::collections::HashMap;
use std::fs;
use std::path::Path;

use super::program::{burning, folder};

/// The words of a dumped buffer, row after row.
fn words(folder: &Path, name: &str) -> Vec<u32> {
    let bytes = fs::read(folder.join(format!("{name}.npy"))).unwrap();
    let start = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    bytes[start..].chunks_exact(4).map(|word| u32::from_le_bytes(word.try_into().unwrap())).collect()
}

/// Rows of four numbers.
fn rows(folder: &Path, name: &str) -> Vec<[f64; 4]> {
    let words = words(folder, name);
    words.chunks_exact(4).map(|row| [0, 1, 2, 3].map(|k| f64::from(f32::from_bits(row[k])))).collect()
}

/// Renders a frame of a fast fire and dumps the targets into `folder`.
fn dump(folder: &Path, options: &str, targets: &[&str]) {
    let fire = "--size 32x24 --blocks 3x3x3 --fire 60 --smoke 30 --speed 0.5 --flammability 20";
    let mut render = burning("render --quiet --image fire.png").args(fire).args(options).on_test_device();
    for target in targets {
        render = render.arg("--dump").arg(format!("{target}={target}.npy"));
    }
    render.inside(folder).run().succeeded();
}

/// By the divergence theorem.
fn enclosed(vertices: &[[f64; 4]], triangles: &[u32]) -> f64 {
    let tetrahedron = |corners: &[u32]| {
        let [[ax, ay, az, _], [bx, by, bz, _], [cx, cy, cz, _]] = [0, 1, 2].map(|k| vertices[corners[k] as usize]);
        (ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)) / 6.0
    };
    triangles.chunks_exact(3).map(tetrahedron).sum()
}

#[test]
fn volumes_of_wax_follow_from_its_dumps() {
    const UNITS: f64 = 4294967296.0;
    let out = folder();
    let targets = ["rest", "state", "triangles", "film", "puddle", "clock"];
    let wax = "--variant melting --mesh sphere --triangles 300 --levels 0 --frame 70";
    dump(out.path(), wax, &targets);
    let triangles = words(out.path(), "triangles");
    let [rest, now] = ["rest", "state"].map(|name| enclosed(&rows(out.path(), name), &triangles));
    let film = words(out.path(), "film");
    let puddle: f64 = words(out.path(), "puddle").iter().map(|v| f64::from(*v)).sum::<f64>() / UNITS;
    // A sphere whose box has a diagonal of 1.
    let ball = 4.0 / 3.0 * std::f64::consts::PI * (0.5 / 3.0_f64.sqrt()).powi(3);
    assert!((rest.abs() / ball - 1.0).abs() < 0.1, "{rest} {ball}");
    assert!(
        (now.abs() - f64::from(film[0] as i32) / UNITS).abs() < 1e-5 && now.abs() < 0.9 * rest.abs(),
        "{now} {film:?}"
    );
    assert!((puddle - f64::from(film[3]) / UNITS).abs() < 1e-9, "{puddle} {film:?}");
    assert!(((now.abs() + puddle) / rest.abs() - 1.0).abs() < 0.05, "{now} {puddle} {rest}");
    assert_eq!(words(out.path(), "clock")[0], 71);
}

#[test]
fn the_pattern_and_what_is_drawn_of_it_follow_from_its_dumps() {
    let out = folder();
    let targets = ["triangles", "corners", "welds", "statuses", "stream", "removed", "alive", "clock"];
    // Before the first triangle is consumed, so that the surface is closed.
    dump(out.path(), "--variant low-poly --mesh box --levels 3 --frame 20", &targets);
    let [triangles, corners, welds, statuses, stream, removed, alive, clock] =
        targets.map(|name| words(out.path(), name));
    let (coarse, nodes) = (12, 1 + 4 + 16 + 64);
    assert_eq!((statuses.len(), triangles.len()), (coarse * nodes, 3 * coarse * 64));
    assert!(corners.iter().map(|corner| welds[*corner as usize]).eq(triangles.iter().copied()));
    // The leaves in use cover each coarse triangle once.
    for pattern in statuses.chunks_exact(nodes) {
        let level = |node: usize| [0, 1, 5, 21].iter().rposition(|first| node >= *first).unwrap() as u32;
        let covered: u32 = (0..nodes).filter(|n| pattern[*n] == 1).map(|n| 4_u32.pow(3 - level(n))).sum();
        assert_eq!(covered, 64, "{pattern:?}");
    }
    let split = statuses.iter().filter(|status| **status as i32 == -1).count();
    assert!(split > 0 && split < coarse * 21, "{split}");
    // Each edge of what is drawn has two triangles that run along it in opposite directions.
    let drawn = clock[8] as usize;
    assert_eq!((removed.iter().sum::<u32>(), clock[7]), (0, 0));
    let mut sides: HashMap<(u32, u32), i32> = HashMap::new();
    for triangle in stream[..3 * drawn].chunks_exact(3) {
        let [a, b, c] = [0, 1, 2].map(|k| welds[triangle[k] as usize]);
        assert!([a, b, c].iter().all(|vertex| alive[*vertex as usize] == 1));
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *sides.entry((from.min(to), from.max(to))).or_default() += if from < to { 1 } else { 1 << 16 };
        }
    }
    assert!(sides.values().all(|count| *count == 1 + (1 << 16)), "{drawn}");
}
