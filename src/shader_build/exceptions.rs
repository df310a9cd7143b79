//! The shaders that naga need not compile.

use super::{CompiledShader, Error, Stage};

/// Vertex, fragment and compute shaders outside naga's GLSL subset, each with the reason.
/// Geometry shaders are excluded by their kind and do not belong here.
pub const NAGA_EXCEPTIONS: &[(&str, &str)] = &[
    ("burning/bending-loads.comp", "atomics: loads and strengths are summed"),
    ("burning/block-weights-placed.comp", "atomics: vertices are counted by block"),
    ("burning/block-weights-random.comp", "atomics: vertices are counted by block"),
    ("burning/connection-pieces.comp", "an atomic: pieces are counted"),
    ("burning/connection.comp", "an atomic: removed triangles are counted"),
    ("burning/draw-fire-lines-flames.comp", "atomics: particles are marked by line of tiles"),
    ("burning/draw-fire-lines-sun.comp", "atomics: particles are marked by line of tiles"),
    ("burning/falling-contacts-heights.comp", "atomics: the lowest and the farthest vertex are found"),
    ("burning/falling-contacts-vertices.comp", "an atomic: the first of several vertices is found"),
    ("burning/falling-balls.comp", "an atomic: the first vertex of a cell is found"),
    ("burning/flame-lights.comp", "atomics: the light of particles is summed"),
    ("burning/flames-parts.comp", "an atomic: particles are counted"),
    ("burning/flames-ready.comp", "an atomic: ready vertices are listed by block"),
    ("burning/flames-whole.comp", "an atomic: particles are counted"),
    ("burning/heat-boundary-triangles.comp", "an atomic: active triangles are counted"),
    ("burning/heat-boundary-vertices.comp", "an atomic: active vertices are counted"),
    ("burning/parts-check.comp", "atomics: vertices and roots are marked"),
    ("burning/parts-flatten.comp", "an atomic: roots are lowered"),
    ("burning/parts-moments.comp", "atomics: moments are summed"),
    ("burning/parts-unite.comp", "atomics: trees are joined"),
    ("burning/puddle-volume.comp", "an atomic: volumes are summed"),
    ("burning/puddle-weights.comp", "atomics: weights are summed"),
    ("burning/puddle.comp", "atomics: volumes are summed"),
    ("burning/smoke-box.comp", "atomics: the lowest and the highest place are found"),
    ("burning/smoke-density.comp", "an atomic: densities are summed"),
    ("burning/surface-removal-mark-free.comp", "an atomic: removed triangles are counted"),
    ("burning/surface-removal-mark-parts.comp", "an atomic: removed triangles are counted"),
    ("caustics/depth-profile.comp", "an atomic: levels that hold the receiver are marked"),
    ("caustics/land-one.comp", "atomics: the light of triangles is summed"),
    ("caustics/land-several.comp", "atomics: the light of triangles is summed"),
    ("caustics/straddle-off-one.comp", "atomics: the light of triangles is summed"),
    ("caustics/straddle-off-several.comp", "atomics: the light of triangles is summed"),
    ("caustics/straddle-on-one.comp", "atomics: the light of triangles is summed"),
    ("caustics/straddle-on-several.comp", "atomics: the light of triangles is summed"),
    ("gas/fragments-gas.frag", "atomics: fragments take their slots and their places in the lists"),
    ("gas/fragments-nearest-gas.comp", "an atomic: pixels that lose fragments are counted"),
    ("gas/fragments-nearest-plain.comp", "an atomic: pixels that lose fragments are counted"),
    ("gas/fragments-plain.frag", "atomics: fragments take their slots and their places in the lists"),
    ("gas/fragments-tiles-gas.comp", "an atomic: tiles take slots for their fragments"),
    ("gas/fragments-tiles-plain.comp", "an atomic: tiles take slots for their fragments"),
    ("gas/sort-one.comp", "an atomic: pixels reserve the slots of their sections"),
    ("gas/sort-several.comp", "an atomic: pixels reserve the slots of their sections"),
    ("gas/tiles-count.comp", "an atomic: the triangles of tiles are counted"),
    ("gas/tiles-fill.comp", "an atomic: triangles take their places in tiles"),
    ("lava/point.vert", "it feeds a geometry stage and writes no gl_Position, which naga demands"),
    ("lava/splat.vert", "it feeds a geometry stage and writes no gl_Position, which naga demands"),
];

/// Checks that `exceptions` lists exactly the vertex, fragment and compute shaders that naga refuses.
///
/// # Errors
/// A refused shader that is not listed, and a listed one that naga accepts, that does not exist or that is
/// excluded by its kind.
pub fn check_exceptions(shaders: &[CompiledShader], exceptions: &[(&str, &str)]) -> Result<(), Error> {
    for shader in shaders {
        let listed = exceptions.iter().any(|(name, _)| *name == shader.name);
        match &shader.naga {
            Err(reason) if !listed && shader.stage != Stage::Geometry => {
                return Err(Error::NagaRefused { shader: shader.name.clone(), reason: reason.clone() });
            }
            Ok(_) if listed => return Err(stale(&shader.name, "which naga accepts")),
            _ => {}
        }
    }
    for (name, _) in exceptions {
        match shaders.iter().find(|shader| shader.name == *name) {
            None => return Err(stale(name, "which does not exist")),
            Some(shader) if shader.stage == Stage::Geometry => {
                return Err(stale(name, "whose stage naga never compiles"));
            }
            Some(_) => {}
        }
    }
    Ok(())
}

fn stale(shader: &str, problem: &'static str) -> Error {
    Error::StaleException { shader: shader.to_owned(), problem }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shader(name: &str, stage: Stage, accepted: bool) -> CompiledShader {
        CompiledShader {
            name: name.to_owned(),
            stage,
            text_sha256: [0; 32],
            glslang: Vec::new(),
            naga: accepted.then(Vec::new).ok_or_else(|| "atomics".to_owned()),
        }
    }

    fn check(exceptions: &[&str]) -> Result<(), String> {
        let shaders = [
            shader("plain.frag", Stage::Fragment, true),
            shader("atomic.comp", Stage::Compute, false),
            shader("strip.geom", Stage::Geometry, false),
        ];
        let exceptions: Vec<_> = exceptions.iter().map(|name| (*name, "reason")).collect();
        check_exceptions(&shaders, &exceptions).map_err(|error| error.to_string())
    }

    #[test]
    fn exactly_the_refused_shaders_are_listed() {
        assert_eq!(check(&["atomic.comp"]), Ok(()));
    }

    #[test]
    fn unlisted_and_stale_entries_fail() {
        let cases: [(&[&str], &str); 4] = [
            (&[], "`atomic.comp` must build with naga too, but: atomics"),
            (&["atomic.comp", "plain.frag"], "`plain.frag`, which naga accepts"),
            (&["atomic.comp", "gone.vert"], "`gone.vert`, which does not exist"),
            (&["atomic.comp", "strip.geom"], "`strip.geom`, whose stage naga never compiles"),
        ];
        for (exceptions, expected) in cases {
            let message = check(exceptions).unwrap_err();
            assert!(message.contains(expected), "{message}");
        }
    }
}
