use fumarole::gpu::*;
use fumarole::papers::{Paper, caustics::*};
use fumarole::{image, scene};
use glam::{Mat4, Vec3};
fn main() {
    let instance = Instance::new(true).unwrap();
    let physical = gpu_choose(&instance);
    let device = Device::open(&instance, physical).unwrap();
    let shaders = ShaderLibrary::new(&device, Compiler::Glslang, None).unwrap();
    let mut mesh = scene::shapes::teapot();
    let b = mesh.bounds();
    let s = 2.0 / b.diagonal().max_element();
    let m = Mat4::from_scale(Vec3::splat(s));
    mesh = mesh.transformed(&m);
    let b = mesh.bounds();
    let t = Mat4::from_translation(Vec3::new(-b.center().x, -3.0 - b.min.y, -b.center().z));
    mesh = mesh.transformed(&t);
    let mut p = Parameters::default();
    p.planes = 31; p.mrt = std::env::args().count() < 2;
    for v in Variant::ALL {
        let mut c = Caustics::new(&shaders, v.word(), v, &p, &[ReceiverInput { mesh: mesh.clone(), albedo: Vec3::splat(0.8) }]).unwrap();
        let mut r = Recorder::new(&device).unwrap();
        println!("floor {:?}", r.stamp_floor_ms().unwrap());
        for (i, mode) in [Mode::Plain, Mode::Plain, Mode::Bracketed, Mode::Stamped, Mode::Counted].into_iter().enumerate() {
            let s = r.run(mode, |f| c.record(f, i as u32)).unwrap();
            println!("{mode:?} {:.2} {:?}", s.frame_ms, s.bracket_ms);
            if mode == Mode::Stamped || mode == Mode::Counted {
                for x in &s.passes { println!("  {:24} {:3} {:?} {:?} {:?}", x.info.name, x.calls, x.gpu_ms, x.host_ms, x.counts); }
            }
        }
        let pic = c.picture();
        let bytes = transfer::read_image(&device, pic).unwrap();
        let rgba = image::Rgba8::new(pic.width(), pic.height(), bytes).unwrap();
        image::write_png(std::path::Path::new(&format!("/tmp/{}.png", v.word())), &rgba).unwrap();
        for m in instance.take_messages().iter().take(3) { println!("VALIDATION {m}"); }
    }
    println!("{:?}", instance.live().alive());
}
fn gpu_choose(i: &std::sync::Arc<Instance>) -> PhysicalDevice {
    physical::choose(PhysicalDevice::enumerate(i).unwrap(), None, &NEEDS).unwrap()
}
