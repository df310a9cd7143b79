//! Shaders of a caller's own that want more than a device has, or something else than what they are bound to: the fourth part
//! of `misuse`.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use ash::vk;
use fumarole::gpu::{
    Blend, Compiler, DepthTest, Device, Error, Feature, Image, ImageDesc, ImageView, Load, Mode, Pass, Sampler,
    ShaderLibrary, Topology,
};

use super::fixtures::{BLACK, Vertex, color_target, paint, paint_pass, run, shaders, storage_buffer, texels};
use super::misuse::message;
use crate::common::gpu_test;

fumarole::host_block! {
    /// `test/splat-point.vert`
    struct Splat {
        place: [f32; 2],
        paint: [f32; 4],
    }
}

/// The shaders that are built in, but for those of these names.
pub fn replaced(device: &Arc<Device>, shaders: &[(&str, &str)]) -> Result<ShaderLibrary, Error> {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in shaders {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap_or(Path::new(""))).unwrap();
        fs::write(path, format!("#version 450\n{text}")).unwrap();
    }
    ShaderLibrary::new(device, Compiler::Glslang, Some(folder.path()))
}

const FULLSCREEN: &str = "common/fullscreen.vert";
const FRAGMENT: &str = "test/constant.frag";
const COUNTING: &str = "common/empty.frag";
const COMPUTE: &str = "test/advance.comp";

/// A 4 x 4 target that holds 256 x row + column.
fn numbers(device: &Arc<Device>) -> Arc<ImageView> {
    let numbers = color_target(device, "numbers", vk::Format::R32_UINT, 4, 4);
    let pass = Pass::graphics("number", "", FULLSCREEN, "test/texels.frag");
    let pass = pass.color(&numbers, Load::Discard, Blend::Replace).build(&shaders(device)).unwrap();
    run(device, Mode::Plain, |frame| frame.graphics(&pass, |draw| draw.vertices(3))).unwrap();
    numbers
}

const UNFILTERED: &str = "pass look: reads numbers through between, and this device does not filter R32_UINT; give a sampler of \
                          the nearest texel";

const READER: &str = "layout(set = 0, binding = 0) uniform utexture2D numbers;\n\
                      layout(set = 0, binding = 1) uniform sampler between;\n";

#[test]
fn textures_are_filtered_where_the_device_does() {
    gpu_test(|device| {
        let (numbers, target) = (numbers(device), color_target(device, "target", vk::Format::R32_UINT, 1, 1));
        let filtered = "void main() { number = texture(usampler2D(numbers, between), vec2(0.9)).x; }";
        let fetched = "void main() { number = texelFetch(usampler2D(numbers, between), ivec2(3), 0).x; }";
        // The names of a function's arguments are no bindings: each stands for all.
        let handed = "uint look(utexture2D t, sampler s) { return texture(usampler2D(t, s), vec2(0.9)).x; }\n\
                      void main() { number = look(numbers, between); }";
        for (main, filter, is_refused) in [
            (filtered, vk::Filter::LINEAR, true),
            (filtered, vk::Filter::NEAREST, false),
            // A fetch is not filtered, and yet joined with the sampler.
            (fetched, vk::Filter::LINEAR, true),
            (fetched, vk::Filter::NEAREST, false),
            (handed, vk::Filter::LINEAR, true),
            (handed, vk::Filter::NEAREST, false),
        ] {
            let text = format!("{READER}layout(location = 0) out uint number;\n{main}\n");
            let library = replaced(device, &[(FRAGMENT, &text)]).unwrap();
            let sampler = Sampler::new(device, "sampler", filter).unwrap();
            let look = Pass::graphics("look", "", FULLSCREEN, FRAGMENT).color(&target, Load::Discard, Blend::Replace);
            let look = look.with("numbers", &numbers).with("between", &sampler).build(&library);
            if is_refused {
                assert_eq!(message(look), UNFILTERED, "{main}");
                continue;
            }
            let look = look.unwrap();
            run(device, Mode::Plain, |frame| frame.graphics(&look, |draw| draw.vertices(3))).unwrap();
            assert_eq!(texels::<u32>(device, &target), [3 + 256 * 3]);
            // Rebinding takes the check along.
            if main == filtered {
                let smooth = Sampler::new(device, "smooth", vk::Filter::LINEAR).unwrap();
                assert_eq!(message(look.rebind().with("between", &smooth).build(&library)), UNFILTERED);
            }
        }
    });
}

#[test]
fn no_sampler_is_taken_for_one_that_compares() {
    gpu_test(|device| {
        let text = "layout(set = 0, binding = 0) uniform texture2D seen;\n\
                    layout(set = 0, binding = 1) uniform samplerShadow nearer;\n\
                    layout(location = 0) out vec4 target;\n\
                    void main() { target = vec4(texture(sampler2DShadow(seen, nearer), vec3(0.5))); }\n";
        let seen = color_target(device, "seen", vk::Format::R32_SFLOAT, 4, 4);
        let target = color_target(device, "target", vk::Format::R32_SFLOAT, 4, 4);
        let sampler = Sampler::new(device, "sampler", vk::Filter::NEAREST).unwrap();
        let look = Pass::graphics("look", "", FULLSCREEN, FRAGMENT).color(&target, BLACK, Blend::Replace);
        let look = look.with("seen", &seen).with("nearer", &sampler);
        let expected = "pass look: compares with texels through nearer, which no sampler does";
        assert_eq!(message(look.build(&replaced(device, &[(FRAGMENT, text)]).unwrap())), expected);
    });
}

#[test]
fn counting_draws_filter_what_the_device_does_and_read_what_the_pass_binds() {
    gpu_test(|device| {
        let (numbers, target) = (numbers(device), color_target(device, "target", vk::Format::R32_UINT, 4, 4));
        let extension = "#extension GL_EXT_samplerless_texture_functions : require\n";
        // It declares the sampler that only the counting draws join with the texture.
        let own = format!(
            "{extension}{READER}layout(location = 0) out uint number;\n\
             void main() {{ number = texelFetch(numbers, ivec2(0), 0).x; }}\n"
        );
        let build = |counting: &str, filter| {
            let library = replaced(device, &[(FRAGMENT, &own), (COUNTING, counting)]).unwrap();
            let sampler = Sampler::new(device, "sampler", filter).unwrap();
            let pass = Pass::graphics("look", "", FULLSCREEN, FRAGMENT).color(&target, Load::Discard, Blend::Replace);
            let pass = pass.with("numbers", &numbers).with("between", &sampler);
            pass.counting(COUNTING, DepthTest::LessReadOnly).build(&library)
        };
        let looks = |at: &str| format!("void main() {{ if ({at} == 0u) {{ discard; }} }}\n");
        let filters = format!("{READER}{}", looks("texture(usampler2D(numbers, between), vec2(0.5)).x"));
        assert_eq!(message(build(&filters, vk::Filter::LINEAR)), UNFILTERED);
        let array = "layout(set = 0, binding = 0) uniform utexture2DArray numbers;\n";
        let layered = format!("{extension}{array}{}", looks("texelFetch(numbers, ivec3(0), 0).x"));
        let expected = "pass look: shader common/empty.frag reads numbers, which the pass's own does not read so";
        assert_eq!(message(build(&layered, vk::Filter::LINEAR)), expected);
        let written = "layout(location = 0) out vec4 color;\nvoid main() { color = vec4(1.0); }\n";
        let expected = "pass look: shader common/empty.frag writes no value of its type to target 0, target";
        assert_eq!(message(build(written, vk::Filter::LINEAR)), expected);
        let look = build(&filters, vk::Filter::NEAREST).unwrap();
        run(device, Mode::Plain, |frame| {
            frame.graphics(&look, |draw| {
                draw.vertices(3);
                draw.counting(true).vertices(3);
            })
        })
        .unwrap();
    });
}

#[test]
fn two_stages_sample_one_image() {
    gpu_test(|device| {
        let vertex = "#extension GL_EXT_samplerless_texture_functions : require\n\
                      layout(set = 0, binding = 0) uniform texture2D early;\n\
                      layout(location = 0) flat out float seen;\n\
                      void main() {\n\
                      vec2 corner = vec2(gl_VertexIndex == 1 ? 2.0 : 0.0, gl_VertexIndex == 2 ? 2.0 : 0.0);\n\
                      seen = texelFetch(early, ivec2(1), 0).x;\n\
                      gl_Position = vec4(2.0 * corner - 1.0, 0.0, 1.0);\n\
                      }\n";
        let fragment = "#extension GL_EXT_samplerless_texture_functions : require\n\
                        layout(set = 0, binding = 1) uniform texture2D late;\n\
                        layout(location = 0) flat in float seen;\n\
                        layout(location = 0) out vec4 target;\n\
                        void main() { target = vec4(seen, texelFetch(late, ivec2(2), 0).x, 0.0, 1.0); }\n";
        let seen = color_target(device, "seen", vk::Format::R32_SFLOAT, 4, 4);
        let target = color_target(device, "target", vk::Format::R32G32_SFLOAT, 2, 2);
        let fill = paint_pass(&shaders(device), "fill", &seen, BLACK, Blend::Replace);
        let library = replaced(device, &[(FULLSCREEN, vertex), (FRAGMENT, fragment)]).unwrap();
        let look = Pass::graphics("look", "", FULLSCREEN, FRAGMENT).color(&target, BLACK, Blend::Replace);
        let look = look.with("early", &seen).with("late", &seen).build(&library).unwrap();
        for value in [0.5, 0.25] {
            run(device, Mode::Plain, |frame| {
                paint(frame, &fill, value)?;
                frame.graphics(&look, |draw| draw.vertices(3))
            })
            .unwrap();
            assert_eq!(texels::<[f32; 2]>(device, &target), [[value; 2]; 4]);
        }
    });
}

#[test]
fn points_have_a_size() {
    gpu_test(|device| {
        let target = color_target(device, "target", vk::Format::R8G8B8A8_UNORM, 4, 4);
        let dots = || {
            let pass = Pass::graphics("dots", "", "test/asymmetric.vert", "test/asymmetric.frag");
            pass.topology(Topology::Points).color(&target, BLACK, Blend::Replace)
        };
        let expected = "pass dots: draws points, and shader test/asymmetric.vert writes no gl_PointSize";
        assert_eq!(message(dots().build(&shaders(device))), expected);
        let text = |body: &str| {
            format!(
                "layout(location = 0) out vec3 colour;\nvoid main() {{\ncolour = vec3(1.0);\ngl_Position = vec4(0.0, 0.0, 0.5, 1.0);\n{body}\n}}\n"
            )
        };
        // It is read and not written.
        let read = replaced(device, &[("test/asymmetric.vert", &text("colour.x = gl_PointSize;"))]).unwrap();
        assert_eq!(message(dots().build(&read)), expected);
        let written = replaced(device, &[("test/asymmetric.vert", &text("gl_PointSize = 1.0;"))]).unwrap();
        let dots = dots().build(&written).unwrap();
        run(device, Mode::Plain, |frame| frame.graphics(&dots, |draw| draw.vertices(1))).unwrap();
        let painted: Vec<[u8; 4]> = texels(device, &target);
        assert_eq!(painted.iter().filter(|texel| texel[0] == 255).count(), 1);
    });
}

#[test]
fn stages_keep_to_the_limits_of_the_device() {
    gpu_test(|device| {
        let limits = &device.physical().limits;
        let beyond = |outcome: Result<Pass, Error>, what: &str, wanted: u64, limit: u32| {
            let error = message(outcome);
            let text = format!("{what} {wanted} is beyond this device's limit of {limit}; lower it");
            assert!(error.contains(&text), "{error}");
        };
        let compute = |text: &str| {
            let library = replaced(device, &[(COMPUTE, text)]).unwrap();
            let values = storage_buffer(device, "numbers", &[0.0; 4]);
            Pass::compute("step", "", COMPUTE).with("Values", &values).build(&library)
        };
        let values = "layout(set = 0, binding = 0, std430) buffer Values { float values[]; };\n";
        // As many along each axis as may be, and too many in all.
        let [x, y, z] = limits.max_compute_work_group_size;
        let (x, y, z) = (x.min(1024), y.min(1024), z.min(64));
        let crowd = format!(
            "layout(local_size_x = {x}, local_size_y = {y}, local_size_z = {z}) in;\n{values}\
             void main() {{ values[0] = 1.0; }}\n"
        );
        let threads = [x, y, z].map(u64::from).iter().product();
        beyond(compute(&crowd), "threads of a workgroup", threads, limits.max_compute_work_group_invocations);
        let count = limits.max_compute_shared_memory_size / 12 + 1;
        let shared = format!(
            "layout(local_size_x = 1) in;\n{values}shared vec3 many[{count}];\n\
             void main() {{ many[gl_WorkGroupID.x] = vec3(values[1]); values[0] = many[1].x; }}\n"
        );
        let most = limits.max_compute_shared_memory_size;
        beyond(compute(&shared), "bytes that a workgroup shares", 16 * u64::from(count), most);

        let [target, other] =
            ["target", "other"].map(|name| color_target(device, name, vk::Format::R8G8B8A8_UNORM, 4, 4));
        let corners = storage_buffer(device, "corners", &[0.0; 15]);
        let draw = |vertex: &str, fragment: &str| {
            let library = replaced(device, &[("test/grid.vert", vertex), (FRAGMENT, fragment)]).unwrap();
            let pass = Pass::graphics("draw", "", "test/grid.vert", FRAGMENT).vertices::<Vertex>(&corners);
            pass.color(&target, BLACK, Blend::Replace).color(&other, BLACK, Blend::Replace).build(&library)
        };
        let vertex = |input: u32, output: u32| {
            format!(
                "layout(location = {input}) in vec2 place;\nlayout(location = {output}) out vec4 colour;\n\
                 void main() {{ colour = vec4(1.0); gl_Position = vec4(place, 0.0, 1.0); }}\n"
            )
        };
        let fragment = |input: u32, output: u32| {
            format!(
                "layout(location = {input}) in vec4 colour;\nlayout(location = 0) out vec4 target;\n\
                 layout(location = {output}) out vec4 more;\nvoid main() {{ target = colour; more = colour; }}\n"
            )
        };
        draw(&vertex(0, 0), &fragment(0, 1)).unwrap();
        let most = limits.max_vertex_input_attributes;
        let what = "count of locations of vertex attributes";
        beyond(draw(&vertex(most, 0), &fragment(0, 1)), what, u64::from(most) + 1, most);
        let most = limits.max_vertex_output_components / 4;
        let what = "count of locations that a stage gives to another";
        beyond(draw(&vertex(0, most), &fragment(most, 1)), what, u64::from(most) + 1, most);
        // All locations but one, and the block of built-ins, which has seven components.
        let count = most - 1;
        let many_out = format!(
            "layout(location = 0) in vec2 place;\nlayout(location = 0) out vec4 colours[{count}];\nvoid main() {{\n\
             for (int i = 0; i < {count}; i++) {{ colours[i] = vec4(1.0); }}\ngl_Position = vec4(place, 0.0, 1.0);\n}}\n"
        );
        let many_in = format!(
            "layout(location = 0) in vec4 colours[{count}];\nlayout(location = 0) out vec4 target;\n\
             layout(location = 1) out vec4 more;\nvoid main() {{ target = colours[0]; more = colours[{count} - 1]; }}\n"
        );
        let what = "count of components that a stage gives, built-ins among them,";
        beyond(draw(&many_out, &many_in), what, u64::from(4 * count + 7), limits.max_vertex_output_components);
        let most = limits.max_fragment_output_attachments;
        let what = "count of locations of colours";
        beyond(draw(&vertex(0, 0), &fragment(0, most)), what, u64::from(most) + 1, most);
    });
}

#[test]
fn inputs_and_outputs_have_locations_of_their_own() {
    gpu_test(|device| {
        let text = "layout(location = 0, component = 1) out vec2 target;\nvoid main() { target = vec2(1.0); }\n";
        let error = message(replaced(device, &[(FRAGMENT, text)]));
        assert!(error.contains("`target` takes a component; give it a location of its own"), "{error}");
    });
}

#[test]
fn geometry_stages_emit_something() {
    gpu_test(|device| {
        let text = "layout(points) in;\nlayout(triangle_strip, max_vertices = 0) out;\n\
                    layout(location = 0) in vec4 colour[];\nlayout(location = 0) out vec4 quad_colour;\n\
                    void main() { quad_colour = colour[0]; }\n";
        let library = replaced(device, &[("test/strip.geom", text)]).unwrap();
        let target = color_target(device, "target", vk::Format::R8G8B8A8_UNORM, 4, 4);
        let splats = storage_buffer(device, "splats", &[0.0; 6]);
        let strip = Pass::graphics("strip", "", "test/splat-point.vert", "test/splat.frag").geometry("test/strip.geom");
        let strip = strip.vertices::<Splat>(&splats).topology(Topology::Points);
        let outcome = strip.color(&target, BLACK, Blend::Replace).build(&library);
        // Without such stages it is refused for the want of them.
        if device.physical().has(Feature::GeometryShader) {
            assert_eq!(message(outcome), "pass strip: its geometry shader test/strip.geom emits no vertices");
        } else {
            assert!(matches!(outcome, Err(Error::MissingFeature { .. })));
        }
    });
}

#[test]
fn samplers_filter_in_two_ways() {
    gpu_test(|device| {
        let cubic = Sampler::new(device, "cubic", vk::Filter::CUBIC_EXT);
        assert_eq!(message(cubic), "cubic: neither this layer nor this device has the filter CUBIC_EXT");
    });
}

#[test]
fn views_of_one_image_are_sampled_by_several_stages() {
    gpu_test(|device| {
        let usage = vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::COLOR_ATTACHMENT;
        let desc = ImageDesc::new_2d("layers", vk::Format::R32_SFLOAT, 4, 4).layers(2).usage(usage);
        let image = Image::new(device, desc).unwrap();
        let vertex = "#extension GL_EXT_samplerless_texture_functions : require\n\
                      layout(set = 0, binding = 0) uniform texture2D lower;\n\
                      layout(location = 0) flat out float seen;\n\
                      void main() {\n\
                      vec2 corner = vec2(gl_VertexIndex == 1 ? 2.0 : 0.0, gl_VertexIndex == 2 ? 2.0 : 0.0);\n\
                      seen = texelFetch(lower, ivec2(0), 0).x;\n\
                      gl_Position = vec4(2.0 * corner - 1.0, 0.0, 1.0);\n\
                      }\n";
        let fragment = "#extension GL_EXT_samplerless_texture_functions : require\n\
                        layout(set = 0, binding = 1) uniform texture2DArray both;\n\
                        layout(location = 0) flat in float seen;\n\
                        layout(location = 0) out vec4 target;\n\
                        void main() { target = vec4(seen, texelFetch(both, ivec3(0, 0, 1), 0).x, 0.0, 1.0); }\n";
        let target = color_target(device, "target", vk::Format::R32G32_SFLOAT, 1, 1);
        let fill = [0, 1].map(|layer| {
            paint_pass(
                &shaders(device),
                ["lower", "upper"][layer],
                &image.layer(layer as u32).unwrap(),
                BLACK,
                Blend::Replace,
            )
        });
        let library = replaced(device, &[(FULLSCREEN, vertex), (FRAGMENT, fragment)]).unwrap();
        let look = Pass::graphics("look", "", FULLSCREEN, FRAGMENT).color(&target, BLACK, Blend::Replace);
        let look = look.with("lower", &image.layer(0).unwrap()).with("both", &image.view().unwrap());
        let look = look.build(&library).unwrap();
        run(device, Mode::Plain, |frame| {
            paint(frame, &fill[0], 0.5)?;
            paint(frame, &fill[1], 0.25)?;
            frame.graphics(&look, |draw| draw.vertices(3))
        })
        .unwrap();
        assert_eq!(texels::<[f32; 2]>(device, &target), [[0.5, 0.25]]);
    });
}
