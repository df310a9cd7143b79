//! Costs of a refusal of a shader folder that the compilers never see, and folders at which they come to their end.

use std::fs;
use std::os::unix::fs::symlink;

use super::hostile_cost::refused_of;
use super::program::{Program, caustics, folder};
use super::shaders::own_shaders;

/// Shaders that are refused within the rule, before a device is opened.
fn refused(files: &[(&str, &[u8])], parts: &[&str]) {
    let program: fn() -> Program = || caustics("render --device none --shader-dir");
    refused_of(program, files, parts);
}

/// As [`refused`], of one.
fn refused_one(text: &str, parts: &[&str]) {
    refused(&[("s/zz.comp", format!("#version 450\n{text}\nvoid main() {{}}\n").as_bytes())], parts);
}

#[test]
fn long_files_and_many_variants() {
    let letters = "a,b,c,d,e,f,g,h,i,j,k,l,m,n,o,p";
    let variants =
        |lines: usize| format!("#pragma variants AA={letters} BB={letters}\n{}#error here", "\n".repeat(lines));
    refused_one(&variants(1 << 20), &["zz.comp", "262144 bytes"]);
    refused_one(&variants(200_000), &["after their includes", "take out variants"]);
    refused_one(&"\n".repeat(16 << 20), &["zz.comp", "262144 bytes"]);
    let shader =
        b"#version 450\n#pragma variants AA=a,b,c,d,e,f,g,h,i,j,k,l,m,n,o,p BB=a,b,c,d,e,f,g,h,i,j,k,l,m,n,o,p\n";
    let names: Vec<String> = (0..17).map(|i| format!("s/{i}.comp")).collect();
    refused(&names.iter().map(|name| (&name[..], &shader[..])).collect::<Vec<_>>(), &["4096 shaders"]);
}

#[test]
fn long_lists_of_variants() {
    let list = |list: &str| refused_one(&format!("#pragma variants {list}"), &["zz.comp:2", "256 combinations"]);
    list(&format!("A=a{}", ",a".repeat(100_000)));
    list(&(0..20).map(|i| format!("{}=a ", "A".repeat(1 + i))).collect::<String>());
    list(&format!("A={}\n#include \"{}\"", "a".repeat(100_000), "{A}".repeat(40_000)));
}

#[test]
fn includes_without_an_end() {
    refused_one("#include \"zz.comp\"", &["zz.comp:2", "include cycle"]);
    let names: Vec<String> = (0..600).map(|i| format!("s/{i}.glsl")).collect();
    let all: String = (0..600).map(|i| format!("#include \"{i}.glsl\"\n")).collect();
    let wide = format!("#version 450\n{all}");
    let empty = names.iter().map(|name| (&name[..], &b""[..]));
    refused(&[("s/zz.comp", wide.as_bytes())].into_iter().chain(empty).collect::<Vec<_>>(), &["511 files"]);
    let texts: Vec<String> = (1..=600).map(|i| format!("#include \"{i}.glsl\"\n")).collect();
    let each = names.iter().zip(&texts).map(|(name, text)| (&name[..], text.as_bytes()));
    let deep = ("s/zz.comp", &b"#version 450\n#include \"0.glsl\"\n"[..]);
    refused(&[deep].into_iter().chain(each).collect::<Vec<_>>(), &["64 files"]);
    let long = "\n".repeat(200_000);
    let three = "#version 450\n#include \"a.glsl\"\n#include \"b.glsl\"\n#include \"c.glsl\"\n";
    let parts = ["s/a.glsl", "s/b.glsl", "s/c.glsl"].map(|name| (name, long.as_bytes()));
    refused(&[&[("s/zz.comp", three.as_bytes())][..], &parts].concat(), &["c.glsl:", "524288 bytes"]);
}

/// Each is short, and asks glslang for more memory, time or stack than there is.
#[test]
fn a_text_that_ends_a_compiler_ends_its_own_process() {
    let doubled = |first: &str, next: fn(usize) -> String| {
        format!("{first}\n{}", (1..40).map(|i| next(i) + "\n").collect::<String>())
    };
    let macros = doubled("#define A0 a+=1;", |i| format!("#define A{i} A{0} A{0}", i - 1));
    let structures = doubled("struct S0 { float a, b; };", |i| format!("struct S{i} {{ S{} a, b; }};", i - 1));
    let chain = "+a".repeat(120_000);
    for (declarations, statements) in [
        (&macros[..], "int a = 1; A39"),
        (&structures, "S39 s; S39 t; t = s; if (s == t) { t = s; }"),
        ("", &format!("int a = 1; int b = a{chain};")),
    ] {
        let out = folder();
        let shaders = own_shaders(out.path());
        let text = format!("#version 450\n{declarations}\nvoid main() {{ {statements} }}\n");
        fs::write(shaders.join("caustics/zz.comp"), text).unwrap();
        let program = caustics("render --quiet --device none --shader-dir").arg(&shaders);
        program.run().refused(2, &["caustics/zz.comp brought a compiler to its end", "make it simpler"]);
    }
}

/// Else the edits in it would be ignored in silence.
#[test]
fn a_linked_folder_is_refused() {
    let out = folder();
    let shaders = own_shaders(out.path());
    fs::rename(shaders.join("caustics"), out.path().join("elsewhere")).unwrap();
    symlink("../elsewhere", shaders.join("caustics")).unwrap();
    let program = caustics("render --shader-dir").arg(&shaders).tiny();
    program.run().refused(2, &["my-shaders/caustics is a link to a folder", "put the folder itself there"]);
}
