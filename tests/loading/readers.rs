//! The readers against each other, and that of OBJ files against another program's.

use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use fumarole::scene::loading::{Conditions, Watch};
use fumarole::scene::{Error, Mesh, MeshOptions, MeshSource};

use crate::files;

fn load(path: &Path, options: &MeshOptions) -> Mesh {
    let mesh = MeshSource::File(path.to_owned()).load_under(options, &Conditions::plain()).unwrap();
    mesh.validate().unwrap();
    mesh
}

/// The places of each triangle's corners, beginning with the least, in order.
fn triangles(mesh: &Mesh) -> Vec<[[u32; 3]; 3]> {
    let place = |index: u32| (mesh.positions[index as usize] + 0.0).to_array().map(f32::to_bits);
    let mut all: Vec<_> = mesh
        .indices
        .chunks_exact(3)
        .map(|t| {
            let mut corners = [place(t[0]), place(t[1]), place(t[2])];
            let least = (0..3).min_by_key(|&k| corners[k]).unwrap();
            corners.rotate_left(least);
            corners
        })
        .collect();
    all.sort_unstable();
    all
}

#[test]
fn every_format_gives_the_same_mesh_in_either_order() {
    let _alone = crate::alone();
    let folder = tempfile::tempdir().unwrap();
    let ball = files::ball(200);
    let expected = triangles(&ball);
    for kind in files::KINDS {
        let path = files::write(folder.path(), kind, &ball);
        for options in [MeshOptions::default(), MeshOptions::to_draw(30.0)] {
            let mesh = load(&path, &options);
            assert!(triangles(&mesh) == expected, "{kind} {options:?}");
            // A fine ball is smooth: no vertex was doubled but where the shape has seams of its own.
            assert!(mesh.positions.len() <= ball.positions.len(), "{kind}: {}", mesh.positions.len());
        }
    }
}

/// The meshes that are shipped, and made ones of every kind of corner, as `tobj` has them.
#[test]
fn objs_are_those_of_another_reader() {
    let _alone = crate::alone();
    let folder = tempfile::tempdir().unwrap();
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/meshes");
    let shipped = ["bunny.obj", "teapot.obj", "spider.obj"].map(|name| fs::read_to_string(assets.join(name)).unwrap());
    let places = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\nvn 0 1 0\n";
    let made = [
        "f 1/1/1 2/2/1 3/3/2 4/4/1\nf 1/2/1 3/1/2 2/2/1\n",
        "f 1//1 2//1 3//2\nf -1//-2 -2//-1 -3//-1\n",
        "f 4/1 3/2 2/3\nf 1/1 4/1 2/2\n",
        "f 3 2 1\nf 1 4 3\n",
    ];
    let made = made.map(|faces| format!("{places}{faces}"));
    for (number, text) in shipped.iter().chain(&made).enumerate() {
        let path = folder.path().join("a.obj");
        fs::write(&path, text).unwrap();
        let mesh = load(&path, &MeshOptions { crease_deg: 180.0, ..MeshOptions::default() });
        let options = tobj::LoadOptions { single_index: true, triangulate: true, ..tobj::LoadOptions::default() };
        let plain: String = text
            .lines()
            .filter(|line| ["v ", "vt ", "vn ", "f "].iter().any(|keyword| line.starts_with(keyword)))
            .map(|line| format!("{line}\n"))
            .collect();
        let (models, _) = tobj::load_obj_buf(&mut plain.as_bytes(), &options, |_| Ok(Default::default())).unwrap();
        let other = &models[0].mesh;
        let positions: Vec<f32> = mesh.positions.iter().flat_map(|p| p.to_array()).collect();
        assert_eq!(positions[..other.positions.len()], other.positions, "{number}");
        // Polygons that are not convex are cut otherwise; none of these is.
        if number != 2 {
            assert_eq!(mesh.indices, other.indices, "{number}");
        }
        let coordinates: Vec<f32> = mesh.texture_coordinates.iter().flat_map(|uv| uv.to_array()).collect();
        assert_eq!(coordinates, other.texcoords, "{number}");
    }
}

/// Large enough that its pieces are parsed by several threads; faces count back over their borders.
#[test]
fn pieces_of_an_obj_are_joined() {
    let _alone = crate::alone();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("strip.obj");
    let mut text = "v 0 0 0\nv 0 1 0\n".to_owned();
    let columns = 150_000_u32;
    for i in 1..=columns {
        text.push_str(&format!("v {i} 0 0\nv {i} 1 0\nf -4 -2 -3\nf -2 -1 -3\n"));
        if i % 1000 == 0 {
            text.push_str("# a line that \\\n goes on\n");
        }
    }
    fs::write(&path, &text).unwrap();
    let mesh = load(&path, &MeshOptions::default());
    assert_eq!((mesh.triangle_count() as u32, mesh.positions.len() as u32), (2 * columns, 2 * columns + 2));
    assert!(mesh.indices.chunks_exact(3).all(|t| t.iter().max().unwrap() - t.iter().min().unwrap() <= 3));
    let lines = text.lines().count();
    for (more, line, part) in [
        ("f 1 2 999999999\n", lines + 1, "300002 positions"),
        ("f 1 2 x\n", lines + 1, "not an index"),
        ("v 1 2\n", lines + 1, "needs 3 numbers"),
        ("f -300003 -1 -2\n", lines + 1, "300002 positions precede it"),
    ] {
        fs::write(&path, format!("{text}{more}")).unwrap();
        let error = MeshSource::File(path.clone()).load().unwrap_err().to_string();
        assert!(error.contains(&format!("line {line}: ")) && error.contains(part), "{error}");
    }
}

#[test]
fn a_load_that_nobody_waits_for_ends() {
    let _alone = crate::alone();
    static STOPPED: AtomicBool = AtomicBool::new(false);
    let folder = tempfile::tempdir().unwrap();
    let ball = files::ball(500);
    for kind in files::KINDS {
        let source = MeshSource::File(files::write(folder.path(), kind, &ball));
        STOPPED.store(false, Ordering::Relaxed);
        // After its first bytes.
        let watch = Watch { interrupted: &STOPPED, progress: &|done, _| STOPPED.store(done > 0, Ordering::Relaxed) };
        let started = Instant::now();
        let result = source.load_under(&MeshOptions::default(), &Conditions { watch, cache: None });
        assert!(matches!(result, Err(Error::Interrupted { .. })), "{kind}: {result:.100?}");
        assert!(started.elapsed().as_secs_f64() < 2.0, "{kind}: {:?}", started.elapsed());
    }
}

#[test]
fn progress_counts_the_bytes_of_the_file() {
    let _alone = crate::alone();
    static SEEN: std::sync::Mutex<Vec<(u64, u64)>> = std::sync::Mutex::new(Vec::new());
    let folder = tempfile::tempdir().unwrap();
    let ball = files::ball(400);
    for kind in files::KINDS {
        let path = files::write(folder.path(), kind, &ball);
        let size = fs::metadata(&path).unwrap().len();
        SEEN.lock().unwrap().clear();
        let watch = Watch { progress: &|done, of| SEEN.lock().unwrap().push((done, of)), ..Watch::default() };
        MeshSource::File(path).load_under(&MeshOptions::default(), &Conditions { watch, cache: None }).unwrap();
        let seen = SEEN.lock().unwrap();
        assert!(seen.iter().all(|&(done, of)| of == size && done <= of), "{kind}");
        assert!(seen.is_sorted() && seen.last() == Some(&(size, size)), "{kind}: {:?}", seen.last());
    }
}

#[test]
fn a_cache_is_filled_and_used_and_mends_itself() {
    let _alone = crate::alone();
    let folder = tempfile::tempdir().unwrap();
    let path = files::write(folder.path(), "binary.stl", &files::ball(200));
    let source = MeshSource::File(path.clone());
    let cache = folder.path().join("cache");
    let conditions = Conditions { watch: Watch::default(), cache: Some(cache.clone()) };
    let options = MeshOptions::to_draw(30.0);
    let entries = || fs::read_dir(&cache).map_or(0, |entries| entries.count());
    let load = || {
        fumarole::scene::loading::LoadParts::take();
        let mesh = source.load_under(&options, &conditions).unwrap();
        (mesh, fumarole::scene::loading::LoadParts::take())
    };
    let (first, read) = load();
    assert_eq!((read.from_cache, entries()), (0, 1));
    assert!(read.read_ms > 0.0 && read.weld_ms > 0.0 && read.normals_ms > 0.0 && read.optimise_ms > 0.0, "{read:?}");
    let (second, found) = load();
    assert_eq!((found.from_cache, found.read_ms, found.bytes), (1, 0.0, 0));
    assert!(first == second);
    let entry = fs::read_dir(&cache).unwrap().next().unwrap().unwrap().path();
    let mut bytes = fs::read(&entry).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(&entry, bytes).unwrap();
    let (third, read) = load();
    assert!(third == first && read.from_cache == 0);
    assert_eq!(load().1.from_cache, 1, "it was made anew");
    // Another file of the same name is another mesh.
    files::write(folder.path(), "binary.stl", &files::ball(201));
    assert!(load().0 != first);
    assert_eq!(entries(), 2);
}
