//! The shaders that the build script compiled.

use std::sync::OnceLock;

use super::{EmbeddedShader, Interface, ReflectError, Stage};

include!(concat!(env!("OUT_DIR"), "/shaders.rs"));

/// The interface of a built-in shader by its place in [`EMBEDDED`], reflected from glslang's binary when it is first asked for.
///
/// # Errors
/// Those of [`Interface::reflect`].
///
/// # Panics
/// For a place beyond them.
pub fn embedded_interface(place: usize) -> Result<&'static Interface, ReflectError> {
    static REFLECTED: [OnceLock<Interface>; EMBEDDED.len()] = [const { OnceLock::new() }; EMBEDDED.len()];
    match REFLECTED[place].get() {
        Some(interface) => Ok(interface),
        None => {
            let interface = Interface::reflect(EMBEDDED[place].glslang)?;
            Ok(REFLECTED[place].get_or_init(|| interface))
        }
    }
}
