//! Enums whose values have names.

/// An enum with the name of each value, declared once: `ALL` in that order and `as_str`, its own or, as `enum Variant: Trait`, those
/// of a trait.
#[macro_export]
macro_rules! named {
    (
        $(#[$attribute:meta])*
        $visibility:vis enum $enum:ident {
            $($(#[$value_attribute:meta])* $value:ident = $name:literal),* $(,)?
        }
    ) => {
        $(#[$attribute])*
        $visibility enum $enum {
            $($(#[$value_attribute])* $value),*
        }

        impl $enum {
            /// Every value, in the order of their declaration.
            pub const ALL: [Self; [$($name),*].len()] = [$($enum::$value),*];

            /// The name that records, tables, messages and the command line know it by.
            pub fn as_str(self) -> &'static str {
                match self {
                    $($enum::$value => $name),*
                }
            }
        }
    };
    (
        $(#[$attribute:meta])*
        $visibility:vis enum $enum:ident: $trait:path {
            $($(#[$value_attribute:meta])* $value:ident = $name:literal),* $(,)?
        }
    ) => {
        $(#[$attribute])*
        $visibility enum $enum {
            $($(#[$value_attribute])* $value),*
        }

        impl $trait for $enum {
            const ALL: &'static [Self] = &[$($enum::$value),*];

            fn as_str(self) -> &'static str {
                match self {
                    $($enum::$value => $name),*
                }
            }
        }
    };
}
