//! The papers, one folder each. They know no option's spelling, no window and no terminal.

mod device_mesh;
#[cfg(test)]
mod layout;
mod texels;
mod tone;
mod triangle_tree;

use crate::measure::study::Visitor;

/// The list of papers: a new one is one line below.
macro_rules! papers {
    ($($paper:ident)+) => {
        $(pub mod $paper;)+

        /// Shows every paper to `visitor`, in the order of the list.
        ///
        /// # Errors
        /// The error that ends the visits.
        pub fn each<V: Visitor>(visitor: &mut V) -> Result<(), V::Error> {
            $(visitor.visit::<$paper::setup::Setup>()?;)+
            Ok(())
        }
    };
}

papers! {
    lava
    gas
    caustics
    burning
    terrain
}
