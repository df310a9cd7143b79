//! Parameters that several papers have.

use super::{Cost, Field, Parameter, Range, Size};

/// The crease angle of mesh files, which every paper that draws meshes has.
pub fn crease_angle<S: 'static>(field: Field<S, f32>) -> Parameter<S> {
    Parameter::new("crease-angle", field)
        .range(Range::from(0.0).to(180.0))
        .unit("degrees")
        .help("Largest angle between two triangles of a mesh file without normals that are lit as one smooth surface")
        .cost(Cost::Buffers)
}

/// The size of the picture, which every paper has; what records hold of it is in [`Identity`](crate::measure::study::Identity).
pub fn size<S: 'static>(field: Field<S, Size>) -> Parameter<S> {
    Parameter::new("size", field)
        .range(Range::from(1.0))
        .unit("pixel")
        .help("Size of the picture")
        .cost(Cost::Buffers)
        .everyday()
        .unrecorded()
}

/// The [`Field`] of a size whose `width` and `height` are fields of a type, as `size_field!(Parameters)`.
#[macro_export]
macro_rules! size_field {
    ($setup:ident) => {
        $crate::measure::parameter::Field {
            get: |setup: &$setup| $crate::measure::parameter::Size { width: setup.width, height: setup.height },
            set: |setup: &mut $setup, size: $crate::measure::parameter::Size| {
                (setup.width, setup.height) = (size.width, size.height)
            },
        }
    };
}

/// An enum that is a [`Choice`](crate::measure::parameter::Choice): each value with its name and its help, declared once.
#[macro_export]
macro_rules! choice {
    (
        $(#[$attribute:meta])*
        $visibility:vis enum $enum:ident {
            $($(#[$value_attribute:meta])* $value:ident = ($name:literal, $help:literal $(,)?)),* $(,)?
        }
    ) => {
        $(#[$attribute])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        $visibility enum $enum {
            $($(#[$value_attribute])* $value),*
        }

        impl $crate::measure::parameter::Choice for $enum {
            const ALL: &'static [Self] = &[$($enum::$value),*];
            const NAMES: &'static [(&'static str, &'static str)] = &[$(($name, $help)),*];
        }
    };
}
