//! Own allocations while a mesh is loaded, against what goes to the device of it.

use fumarole::measure::bench::{build, load};
use fumarole::measure::machine::{Machine, MachineOptions};
use fumarole::measure::study::Study;
use fumarole::papers::gas::Variant;
use fumarole::papers::gas::setup::Setup;
use fumarole::scene::loading::{Conditions, LoadParts};
use fumarole::scene::{Mesh, MeshOptions, MeshSource};
use peak_alloc::PeakAlloc;

use crate::files;

#[global_allocator]
static ALLOCATED: PeakAlloc = PeakAlloc;

/// Bytes of a mesh on the device: position and normal of each vertex, three indices a triangle.
fn device_bytes(mesh: &Mesh) -> usize {
    24 * mesh.positions.len() + 4 * mesh.indices.len()
}

#[test]
fn no_format_takes_more_than_three_times_what_goes_to_the_device() {
    let _alone = crate::alone();
    let folder = tempfile::tempdir().unwrap();
    let ball = files::ball(700);
    let mut beyond = Vec::new();
    for kind in files::KINDS {
        let source = MeshSource::File(files::write(folder.path(), kind, &ball));
        let before = ALLOCATED.current_usage();
        ALLOCATED.reset_peak_usage();
        let mesh = source.load_under(&MeshOptions::to_draw(30.0), &Conditions::plain()).unwrap();
        let taken = ALLOCATED.peak_usage() - before;
        let ratio = taken as f64 / device_bytes(&mesh) as f64;
        println!("{kind}: {taken} bytes, {ratio:.2} times {}", device_bytes(&mesh));
        assert!(mesh.triangle_count() > 900_000, "{kind}");
        if ratio > 3.0 {
            beyond.push((kind, ratio));
        }
    }
    assert!(beyond.is_empty(), "{beyond:?}");
}

/// A mesh from the cache is read to where it stays: nothing of it is in memory twice.
#[test]
fn a_mesh_from_the_cache_takes_its_own_size() {
    let _alone = crate::alone();
    let folder = tempfile::tempdir().unwrap();
    let source = MeshSource::File(files::write(folder.path(), "binary.stl", &files::ball(700)));
    let conditions = Conditions { cache: Some(folder.path().join("cache")), ..Conditions::plain() };
    let load = || {
        LoadParts::take();
        let before = ALLOCATED.current_usage();
        ALLOCATED.reset_peak_usage();
        let mesh = source.load_under(&MeshOptions::to_draw(30.0), &conditions).unwrap();
        let ratio = (ALLOCATED.peak_usage() - before) as f64 / device_bytes(&mesh) as f64;
        (mesh, ratio, LoadParts::take().from_cache)
    };
    let (first, read, kept) = load();
    let (second, found, from_cache) = load();
    println!("{read:.2} times its size from the file, {found:.2} from the cache");
    assert!(first == second && (kept, from_cache) == (0, 1));
    assert!(found <= 1.05, "{found}");
}

/// From the file to the passes of `gas`; what the driver keeps is none of ours.
#[test]
fn gas_takes_at_most_100_bytes_a_triangle() {
    let _alone = crate::alone();
    let folder = tempfile::tempdir().unwrap();
    let path = files::write(folder.path(), "binary.stl", &files::ball(700));
    let device = std::env::var("FUMAROLE_TEST_DEVICE").unwrap_or_else(|_| "llvmpipe".to_owned());
    let options = MachineOptions { device: Some(device), ..MachineOptions::default() };
    let machine = Machine::open(&options, Setup::NEEDS).unwrap();
    let mut setup = Setup::default();
    let object = Setup::parameters().into_iter().find(|parameter| parameter.name == "object").unwrap();
    object.set(&mut setup, &[path.as_os_str()]).unwrap();
    (setup.parameters.width, setup.parameters.height) = (32, 24);
    let before = ALLOCATED.current_usage();
    ALLOCATED.reset_peak_usage();
    let loaded = load(&setup).unwrap();
    let built = build(&machine, &setup, &loaded.scene, Variant::NoVolume).unwrap();
    let taken = ALLOCATED.peak_usage() - before;
    let triangles: usize = loaded.scene.objects.iter().map(|object| object.mesh.triangle_count()).sum();
    assert!(triangles > 900_000);
    let each = taken as f64 / triangles as f64;
    println!("{each:.1} bytes a triangle, {} on the device", built.peak_bytes / triangles as u64);
    assert!(each <= 100.0, "{each} bytes a triangle");
}
