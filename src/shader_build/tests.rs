//! The module as a whole, on the real shaders and on broken ones.

use std::fs;
use std::path::Path;

use super::reflection::SPIRV_MAGIC;
use super::*;

const SHADERS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/shaders");

/// Compiles `a.frag`, which includes `b.glsl`.
fn compile_pair(shader: &str, included: &str) -> Result<CompiledShader, Error> {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.frag"), shader).unwrap();
    fs::write(folder.path().join("b.glsl"), included).unwrap();
    compile_dir(folder.path(), &[]).map(|mut shaders| shaders.remove(0))
}

fn compile_fragment(declarations: &str, body: &str) -> CompiledShader {
    let main = format!("{declarations}\nvoid main() {{\n{body}\n}}\n");
    compile_pair("#version 450\nlayout(location = 0) out vec4 target;\n#include \"b.glsl\"\n", &main).unwrap()
}

fn reflect_embedded(name: &str) -> Interface {
    let shader = EMBEDDED.iter().find(|shader| shader.name == name).unwrap();
    Interface::reflect(shader.glslang).unwrap()
}

#[test]
fn the_embedded_shaders_are_those_of_the_folder() {
    let compiled = compile_dir(Path::new(SHADERS), &[]).unwrap();
    assert!(compiled.len() >= 10);
    assert_eq!(compiled.len(), EMBEDDED.len());
    for (compiled, embedded) in compiled.iter().zip(EMBEDDED) {
        assert_eq!(compiled.name, embedded.name);
        assert_eq!(compiled.stage, embedded.stage);
        assert_eq!(compiled.text_sha256, embedded.text_sha256);
        assert_eq!(compiled.glslang, embedded.glslang);
        assert_eq!(compiled.naga.as_deref().ok(), embedded.naga.ok());
    }
    check_exceptions(&compiled, NAGA_EXCEPTIONS).unwrap();
}

#[test]
fn what_is_unchanged_is_taken_and_all_else_compiled() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, color: &str| {
        let text =
            format!("#version 450\nlayout(location = 0) out vec4 color;\nvoid main() {{ color = vec4({color}); }}\n");
        fs::write(folder.path().join(name), text).unwrap();
    };
    ["a.frag", "b.frag", "c.frag"].into_iter().for_each(|name| write(name, "1.0"));
    let compiled = compile_dir(folder.path(), &[]).unwrap();
    // Binaries that no compiler makes, by which they are known again.
    let known = [&compiled[0], &compiled[2]].map(|shader| EmbeddedShader {
        name: Box::leak(shader.name.clone().into_boxed_str()),
        stage: shader.stage,
        text_sha256: shader.text_sha256,
        glslang: &[1],
        naga: Err("known"),
    });
    write("c.frag", "0.5");
    let again = compile_dir(folder.path(), &known).unwrap();
    assert_eq!(again[0].glslang, [1]);
    assert_eq!(again[0].naga.as_ref().unwrap_err(), "known");
    assert_eq!(again[1].glslang, compiled[1].glslang);
    assert!(again[2].glslang.len() > 1 && again[2].glslang != compiled[2].glslang, "its text is another");
}

#[test]
fn every_naga_binary_fits_the_interface_of_glslang() {
    for shader in EMBEDDED {
        if let Ok(naga) = shader.naga {
            let glslang = Interface::reflect(shader.glslang).unwrap();
            let naga = Interface::reflect(naga).unwrap();
            assert_eq!(check_same_interface(&glslang, &naga), Ok(()), "{}", shader.name);
        }
    }
}

#[test]
fn a_glslang_error_names_the_included_file_and_line() {
    let error =
        compile_pair("#version 450\n\n#include \"b.glsl\"\nvoid main() {}\n", "\n\nfloat f() { return missing; }\n");
    let Err(Error::Compile { compiler, path, line, message, .. }) = &error else {
        panic!("expected a compile error, got {error:?}");
    };
    assert_eq!(*compiler, Compiler::Glslang);
    assert!(path.ends_with("b.glsl"));
    assert_eq!(*line, Some(3));
    assert!(message.contains("'missing' : undeclared identifier"), "{message}");
}

#[test]
fn an_error_after_an_include_names_the_shader_and_its_line() {
    let error =
        compile_pair("#version 450\n#include \"b.glsl\"\nvoid main() {\n  missing();\n}\n", "int a;\nint b;\nint c;\n");
    let Err(Error::Compile { path, line, .. }) = error else {
        panic!("expected a compile error, got {error:?}");
    };
    assert!(path.ends_with("a.frag"));
    assert_eq!(line, Some(4));
}

#[test]
fn a_link_error_has_no_line() {
    let error = compile_pair("#version 450\n", "").unwrap_err();
    assert!(matches!(error, Error::Compile { line: None, .. }));
    assert!(error.to_string().contains("a.frag: glslang refuses the shader"), "{error}");
    assert!(!error.to_string().contains('\n'));
}

#[test]
fn a_naga_error_names_the_included_file_and_line() {
    let shader = compile_fragment(
        "layout(set = 0, binding = 0) buffer Count { uint count; };",
        "target = vec4(0.0);\natomicAdd(count, 1u);",
    );
    let reason = shader.naga.unwrap_err();
    assert!(reason.contains("b.glsl:4: naga refuses the shader `a.frag`"), "{reason}");
    assert!(reason.contains("atomicAdd"), "{reason}");
}

#[test]
fn naga_refuses_what_it_would_miscompile() {
    let cases = [
        ("float grid[2][3];", "target = vec4(grid[1][2]);", "nested arrays"),
        ("", "int i = 0;\ndo {\n if (i++ == 1) {\n continue;\n }\n} while (i < 3);\ntarget = vec4(i);", "do-while"),
        ("void f(inout float a) {}", "vec2 v = vec2(1.0);\nf(v.y);\ntarget = v.xyxy;", "panicked"),
        (
            "layout(push_constant) uniform P { float a[3]; } p;",
            "target = vec4(p.a[1]);",
            "disagree on member 0 (`a`) of the push constants: (0, 12, Some(4)) against (0, 48, Some(16))",
        ),
    ];
    for (declarations, body, expected) in cases {
        let reason = compile_fragment(declarations, body).naga.unwrap_err();
        assert!(reason.contains(expected), "{reason}");
    }
    let asked_last =
        "int i = 0;\ndo {\n i++;\n} while (i < 3);\nfor (; i < 9; i++) {\n continue;\n}\ntarget = vec4(i);";
    assert!(compile_fragment("", asked_last).naga.is_ok());
}

/// Compiles `a.frag`, beside which stand `b-red.glsl` and `b-blue.glsl`.
fn compile_variants(shader: &str) -> Result<Vec<CompiledShader>, Error> {
    let folder = tempfile::tempdir().unwrap();
    let shader = format!("#version 450\n#pragma variants COLOR=red,blue LOD=0,1\n{shader}");
    fs::write(folder.path().join("a.frag"), shader).unwrap();
    fs::write(folder.path().join("b-red.glsl"), "float color() {\n    return 1.0;\n}\n").unwrap();
    fs::write(folder.path().join("b-blue.glsl"), "\nfloat color() {\n    return level;\n}\n").unwrap();
    compile_dir(folder.path(), &[])
}

#[test]
fn each_combination_of_variants_is_a_shader_of_its_own() {
    let main = "layout(location = 0) out vec4 target;\nvoid main() {\n    target = vec4(color());\n}\n";
    let levels = "#ifdef LOD_0\nfloat level = 0.0;\n#else\nfloat level = 1.0;\n#endif\n";
    let shaders = compile_variants(&format!("{levels}#include \"b-{{COLOR}}.glsl\"\n{main}")).unwrap();
    let names: Vec<&str> = shaders.iter().map(|shader| shader.name.as_str()).collect();
    assert_eq!(names, ["a-blue-0.frag", "a-blue-1.frag", "a-red-0.frag", "a-red-1.frag"]);
    for (i, shader) in shaders.iter().enumerate() {
        assert!(shader.naga.is_ok(), "{:?}", shader.naga);
        assert!(shaders[..i].iter().all(|other| other.glslang != shader.glslang), "{}", shader.name);
    }
}

#[test]
fn an_error_in_a_variant_names_the_file_and_line_that_were_written() {
    let Err(Error::Compile { shader, path, line, .. }) = compile_variants("\n#include \"b-{COLOR}.glsl\"\n") else {
        panic!("expected a compile error");
    };
    assert_eq!((shader.as_str(), line), ("a-blue-0.frag", Some(3)));
    assert!(path.ends_with("b-blue.glsl"));
    let Err(Error::Compile { shader, path, line, .. }) = compile_variants("\nvoid main() {\n    missing();\n}\n")
    else {
        panic!("expected a compile error");
    };
    assert_eq!((shader.as_str(), line), ("a-blue-0.frag", Some(5)));
    assert!(path.ends_with("a.frag"));
}

#[test]
fn a_name_that_two_files_make_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.comp"), "#version 450\n#pragma variants B=c\nvoid main() {}\n").unwrap();
    fs::write(folder.path().join("a-c.comp"), "#version 450\nvoid main() {}\n").unwrap();
    let message = compile_dir(folder.path(), &[]).unwrap_err().to_string();
    assert!(message.contains("both make the shader `a-c.comp`"), "{message}");
    assert!(message.contains("`a.comp`"), "{message}");
}

#[test]
fn vertex_inputs_outputs_and_buffers_reflect() {
    let interface = reflect_embedded("test/sprites.vert");
    assert_eq!(interface.stage, Stage::Vertex);
    assert_eq!(interface.local_size, None);
    let places = |locations: &[Location]| {
        let place = |at: &Location| (at.location, at.name.clone(), at.format, at.count);
        locations.iter().map(place).collect::<Vec<_>>()
    };
    let vec4 = Format { scalar: Scalar::Float, components: 4 };
    let uint = Format { scalar: Scalar::Uint, components: 1 };
    assert_eq!(places(&interface.inputs), [(0, "tint".to_owned(), vec4, 1)]);
    assert_eq!(
        places(&interface.outputs),
        [(0, "colour".to_owned(), vec4, 1), (1, "sprite_index".to_owned(), uint, 1)]
    );
    let [sprites] = interface.bindings.as_slice() else {
        panic!("expected one binding, got {:?}", interface.bindings);
    };
    assert_eq!((sprites.set, sprites.binding, sprites.count), (0, 0, 1));
    assert_eq!(sprites.kind, BindingKind::StorageBuffer { readonly: true });
    let block = sprites.block.as_ref().unwrap();
    assert_eq!((block.name.as_str(), block.size_bytes), ("Sprites", 0));
    let array = block.member("sprites").unwrap();
    assert_eq!((array.offset_bytes, array.size_bytes, array.array_stride_bytes), (0, 0, Some(16)));
    let radius = array.block.as_ref().unwrap().member("radius_px").unwrap();
    assert_eq!((radius.offset_bytes, radius.size_bytes), (12, 4));
}

#[test]
fn uniform_blocks_textures_and_samplers_reflect() {
    let interface = reflect_embedded("test/sprites.frag");
    let kinds: Vec<_> = interface.bindings.iter().map(|at| (at.name.as_str(), at.kind)).collect();
    assert_eq!(
        kinds,
        [
            ("scene", BindingKind::UniformBuffer),
            ("palette", BindingKind::SampledImage),
            ("nearest", BindingKind::Sampler),
        ]
    );
    let scene = interface.binding(1, 0).unwrap().block.as_ref().unwrap();
    let members: Vec<_> = scene
        .members
        .iter()
        .map(|at| (at.name.as_str(), at.offset_bytes, at.size_bytes, at.array_stride_bytes))
        .collect();
    assert_eq!(
        members,
        [
            ("view_projection", 0, 64, None),
            ("lights", 64, 32, Some(16)),
            ("weights", 96, 48, Some(16)),
            ("ambient", 144, 12, None),
            ("light_count", 156, 4, None),
        ]
    );
    assert_eq!((scene.name.as_str(), scene.size_bytes), ("Scene", 160));
    assert_eq!(interface.outputs.len(), 2);
}

#[test]
fn compute_shaders_reflect() {
    let filter = reflect_embedded("test/filter.comp");
    assert_eq!(filter.local_size, Some([8, 8, 1]));
    assert!(!filter.lies_in_rows);
    let result = filter.binding(1, 0).unwrap();
    assert_eq!(result.kind, BindingKind::StorageImage { format: ImageFormat::Rgba32f, readonly: false });
    let patches = reflect_embedded("lava/march-free.frag").binding(0, 5).unwrap().kind;
    assert_eq!(patches, BindingKind::StorageImage { format: ImageFormat::Rgba32f, readonly: true });

    let sum = reflect_embedded("test/sum.comp");
    assert_eq!(sum.local_size, Some([64, 1, 1]));
    // It reads gl_NumWorkGroups, and numbers its threads by gl_GlobalInvocationID.
    assert!(!sum.lies_in_rows);
    assert!(reflect_embedded("lava/cell-keys.comp").lies_in_rows);
    let sums = sum.binding(0, 1).unwrap();
    assert_eq!(sums.name, "Sums");
    assert_eq!(sums.kind, BindingKind::StorageBuffer { readonly: false });
    let range = sum.push_constants.unwrap();
    assert_eq!((range.name.as_str(), range.size_bytes), ("Range", 4));
}

#[test]
fn geometry_inputs_reflect_for_one_vertex() {
    let strip = EMBEDDED.iter().find(|shader| shader.name == "test/strip.geom").unwrap();
    assert!(strip.naga.unwrap_err().contains("no geometry stage"));
    let interface = Interface::reflect(strip.glslang).unwrap();
    assert_eq!(interface.stage, Stage::Geometry);
    assert_eq!((interface.inputs[0].name.as_str(), interface.inputs[0].count), ("colour", 1));
}

/// Execution scope, memory scope and semantics of every barrier, as the constants that they are.
fn barriers(words: &[u32]) -> Vec<Vec<u32>> {
    let instructions = explicit_layout::split(words).unwrap();
    let constant = |id: &u32| instructions.iter().find(|i| explicit_layout::opcode(i) == 43 && i[2] == *id).unwrap()[3];
    let barriers = instructions.iter().filter(|i| explicit_layout::opcode(i) == 224);
    barriers.map(|barrier| barrier[1..].iter().map(constant).collect()).collect()
}

#[test]
fn barriers_hold_the_whole_workgroup_with_both_compilers() {
    // Workgroup, workgroup, acquire-release of workgroup memory.
    let whole = [2, 2, 0x108];
    let with_barriers = EMBEDDED.iter().filter(|shader| !barriers(shader.glslang).is_empty());
    let mut compared = 0;
    for shader in with_barriers {
        let naga = shader.naga.map(barriers).unwrap_or_default();
        assert!(barriers(shader.glslang).iter().chain(&naga).all(|barrier| *barrier == whole), "{}", shader.name);
        assert!(!naga.is_empty() || shader.naga.is_err(), "{}", shader.name);
        compared += usize::from(!naga.is_empty());
    }
    assert!(compared >= 3);
}

#[test]
fn each_difference_of_interfaces_is_found() {
    let original = reflect_embedded("test/sprites.frag");
    let push = reflect_embedded("test/heavy.frag").push_constants;
    let differs = |change: &dyn Fn(&mut Interface)| {
        let mut changed = original.clone();
        change(&mut changed);
        check_same_interface(&original, &changed).unwrap_err().what
    };
    assert_eq!(differs(&|at| at.bindings[1].kind = BindingKind::Sampler), "set 1 binding 1");
    assert_eq!(differs(&|at| at.bindings[1].binding = 7), "set 1 binding 7");
    assert_eq!(differs(&|at| at.bindings[2].count = 2), "set 1 binding 2");
    assert_eq!(differs(&|at| at.stage = Stage::Vertex), "the stage");
    assert_eq!(differs(&|at| at.local_size = Some([8, 1, 1])), "the workgroup size");
    assert_eq!(differs(&|at| at.push_constants = push.clone()), "the push constants");
    assert_eq!(differs(&|at| at.outputs[0].format.components = 3), "the output locations");
    assert_eq!(
        differs(&|at| at.bindings[0].block.as_mut().unwrap().members[3].offset_bytes = 148),
        "member 3 (`ambient`) of set 1 binding 0"
    );
    assert_eq!(
        differs(&|at| {
            let lights = &mut at.bindings[0].block.as_mut().unwrap().members[1];
            lights.block.as_mut().unwrap().members[1].offset_bytes = 8;
        }),
        "member 1 (`power`) of member 1 (`lights`) of set 1 binding 0"
    );
}

#[test]
fn an_unused_binding_may_be_missing_from_naga() {
    let original = reflect_embedded("test/sprites.frag");
    let mut fewer = original.clone();
    fewer.bindings.pop();
    assert_eq!(check_same_interface(&original, &fewer), Ok(()));
    assert!(check_same_interface(&fewer, &original).is_err());
}

#[test]
fn what_is_no_spirv_is_refused() {
    let fullscreen = EMBEDDED.iter().find(|shader| shader.name == "common/fullscreen.vert").unwrap();
    let mut words = fullscreen.glslang.to_vec();
    assert!(Interface::reflect(&words).is_ok());
    words[0] = words[0].swap_bytes();
    assert!(Interface::reflect(&words).is_err());
    assert!(Interface::reflect(&[]).is_err());
    assert!(Interface::reflect(&[SPIRV_MAGIC; 5]).is_err());
}

#[test]
fn a_missing_folder_is_named() {
    let error = compile_dir(Path::new("no/such/folder"), &[]).unwrap_err();
    assert!(error.to_string().starts_with("reading no/such/folder: "), "{error}");
}

#[test]
fn what_a_workgroup_shares_is_counted_as_std430_lays_it_out() {
    let folder = tempfile::tempdir().unwrap();
    let text = "#version 450\nlayout(local_size_x = 1) in;\n\
                struct Pair { vec2 place; bool is_set; };\nconst int COUNT = 3;\n\
                shared float a;\nshared vec3 b;\nshared Pair c[COUNT];\nshared mat3 d;\n\
                layout(set = 0, binding = 0) buffer Values { float values[]; };\n\
                void main() { a = values[0]; b = vec3(a); c[1].place = b.xy; d = mat3(a);\n\
                values[1] = d[0].x + b.x + c[2].place.x; }\n";
    fs::write(folder.path().join("a.comp"), text).unwrap();
    let shader = compile_dir(folder.path(), &[]).unwrap().remove(0);
    // b at 0, d's columns at 16, 32 and 48, pairs of 16 bytes from 64 on, a at 112.
    assert_eq!(Interface::reflect(&shader.glslang).unwrap().shared_bytes, 116);
    assert_eq!(reflect_embedded("test/sum.comp").shared_bytes, 4 * 64);
    assert_eq!(reflect_embedded("test/sprites.vert").shared_bytes, 0);
}

#[test]
fn textures_with_samplers_and_sizes_of_points_are_told() {
    let between = |texture, sampler| Sampling { texture: Some(texture), sampler: Some(sampler), compares: false };
    assert_eq!(reflect_embedded("test/filter.comp").samplings, [between(0, 1)]);
    assert_eq!(reflect_embedded("caustics/coverage.frag").samplings, [between(0, 1)]);
    // Its texture is fetched from without a sampler.
    assert_eq!(reflect_embedded("test/layers.frag").samplings, []);
    for (name, writes) in [("test/splat-point.vert", true), ("test/asymmetric.vert", false), ("test/strip.geom", false)]
    {
        assert_eq!(reflect_embedded(name).writes_point_size, writes, "{name}");
    }
    // Blocks of seven components: place, size and two distances.
    for (name, components) in [
        ("test/splat-point.vert", [0, 7]),
        ("test/strip.geom", [7, 7]),
        ("test/splat.frag", [0, 0]),
        ("terrain/show.frag", [4, 0]),
    ] {
        assert_eq!(reflect_embedded(name).built_in_components, components, "{name}");
    }
    let strip = reflect_embedded("test/strip.geom");
    assert_eq!((strip.primitive_vertices, strip.emitted_vertices), (Some(1), Some(4)));
}
