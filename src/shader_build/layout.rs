//! Structures of the host checked against the GLSL blocks that they fill.

use super::interface::{Block, Member};

/// A `#[repr(C)]` structure that fills a GLSL block. Made by [`host_block!`](crate::host_block).
pub trait HostBlock: Sized {
    /// Name of the structure.
    const NAME: &'static str;

    /// Name, offset and size in bytes of every field.
    fn fields() -> &'static [(&'static str, usize, usize)];
}

/// Declares a `#[repr(C)]`, [`bytemuck::Pod`] structure and its [`HostBlock`].
///
/// Fields carry the names of the GLSL members; those that begin with `_` are padding.
/// The caller's crate needs `bytemuck` with `derive`.
#[macro_export]
macro_rules! host_block {
    (
        $(#[$attribute:meta])*
        $visibility:vis struct $name:ident {
            $($(#[$field_attribute:meta])* $field_visibility:vis $field:ident: $ty:ty),* $(,)?
        }
    ) => {
        $(#[$attribute])*
        #[repr(C)]
        #[derive(Clone, Copy, Debug, PartialEq, ::bytemuck::Pod, ::bytemuck::Zeroable)]
        $visibility struct $name {
            $($(#[$field_attribute])* $field_visibility $field: $ty),*
        }

        impl $crate::shader_build::HostBlock for $name {
            const NAME: &'static str = ::core::stringify!($name);

            fn fields() -> &'static [(&'static str, usize, usize)] {
                &[$((
                    ::core::stringify!($field),
                    ::core::mem::offset_of!($name, $field),
                    ::core::mem::size_of::<$ty>(),
                )),*]
            }
        }
    };
}

/// Difference between a structure of the host and its GLSL block.
#[derive(Debug, thiserror::Error, PartialEq, Eq)]
#[error("`{host}` does not fill the GLSL block `{block}`: {difference}; change one to match the other")]
pub struct LayoutMismatch {
    /// Name of the host's structure.
    pub host: String,
    /// Name of the GLSL block.
    pub block: String,
    /// The first difference, in words.
    pub difference: String,
}

impl Block {
    /// Checks a structure of `host_size` bytes with `(name, offset, size)` fields: every member has its field
    /// at the same offset with the same size, every other field is padding (its name begins with `_`), and
    /// the structure ends with the block or within the 16 bytes that alignment may add.
    ///
    /// # Errors
    /// The first difference.
    pub fn check_layout(
        &self,
        host_name: &str,
        host_size: usize,
        fields: &[(&str, usize, usize)],
    ) -> Result<(), LayoutMismatch> {
        let mismatch = |difference| LayoutMismatch { host: host_name.to_owned(), block: self.name.clone(), difference };
        for member in &self.members {
            let Some(&(name, offset, size)) = fields.iter().find(|field| field.0 == member.name) else {
                return Err(mismatch(format!("the member `{}` has no field", member.name)));
            };
            if offset != member.offset_bytes as usize || !member.admits_size(size) {
                return Err(mismatch(format!(
                    "`{name}` takes {size} bytes at {offset} on the host and {} at {} in GLSL",
                    member.size_bytes, member.offset_bytes
                )));
            }
        }
        let unknown = |name: &str| !name.starts_with('_') && self.member(name).is_none();
        if let Some((name, ..)) = fields.iter().find(|field| unknown(field.0)) {
            return Err(mismatch(format!("the field `{name}` has no member")));
        }
        if !admits_tail_padding(self.size_bytes, host_size) {
            return Err(mismatch(format!("it is {host_size} bytes long on the host and {} in GLSL", self.size_bytes)));
        }
        Ok(())
    }

    /// [`Block::check_layout`] for a structure declared with [`host_block!`](crate::host_block).
    ///
    /// # Errors
    /// The first difference.
    pub fn check_host<H: HostBlock>(&self) -> Result<(), LayoutMismatch> {
        self.check_layout(H::NAME, size_of::<H>(), H::fields())
    }
}

impl Member {
    /// Checks `H` as the element of this array of structures, which it must fill from stride to stride.
    ///
    /// # Errors
    /// The first difference, or a member that is no array of structures.
    pub fn check_elements<H: HostBlock>(&self) -> Result<(), LayoutMismatch> {
        let mismatch = |difference| LayoutMismatch { host: H::NAME.to_owned(), block: self.name.clone(), difference };
        let (Some(block), Some(stride)) = (&self.block, self.array_stride_bytes) else {
            return Err(mismatch("the member is no array of structures".to_owned()));
        };
        if size_of::<H>() != stride as usize {
            return Err(mismatch(format!(
                "it is {} bytes long on the host and elements lie {stride} bytes apart in GLSL",
                size_of::<H>()
            )));
        }
        block.check_host::<H>()
    }

    /// True when a field of that size fills the member; a structure may carry its alignment's padding.
    fn admits_size(&self, host_size: usize) -> bool {
        match (&self.block, self.array_stride_bytes) {
            (Some(_), None) => admits_tail_padding(self.size_bytes, host_size),
            _ => host_size == self.size_bytes as usize,
        }
    }
}

/// True when a structure of the host is as long as its block, or longer by no more than alignment to 16 bytes adds.
fn admits_tail_padding(block_size: u32, host_size: usize) -> bool {
    let block_size = block_size as usize;
    (block_size..=block_size.next_multiple_of(16)).contains(&host_size)
}

#[cfg(test)]
mod tests {
    use super::*;

    crate::host_block! {
        /// As a shader would declare `mat4 transform; vec3 eye; float weights[2];` in std430.
        struct Camera {
            transform: [[f32; 4]; 4],
            eye: [f32; 3],
            weights: [f32; 2],
            _pad: [f32; 3],
        }
    }

    fn member(name: &str, offset_bytes: u32, size_bytes: u32) -> Member {
        Member { name: name.to_owned(), offset_bytes, size_bytes, array_stride_bytes: None, block: None }
    }

    fn camera_block() -> Block {
        Block {
            name: "CameraBlock".to_owned(),
            size_bytes: 84,
            members: vec![member("transform", 0, 64), member("eye", 64, 12), member("weights", 76, 8)],
        }
    }

    fn difference(block: &Block) -> String {
        block.check_host::<Camera>().unwrap_err().difference
    }

    #[test]
    fn a_matching_structure_passes() {
        assert_eq!(camera_block().check_host::<Camera>(), Ok(()));
        assert_eq!(Camera::NAME, "Camera");
        assert_eq!(Camera::fields()[2], ("weights", 76, 8));
    }

    #[test]
    fn each_difference_is_named() {
        let mut moved = camera_block();
        moved.members[1].offset_bytes = 80;
        assert!(difference(&moved).contains("`eye` takes 12 bytes at 64"));

        let mut grown = camera_block();
        grown.members[2].size_bytes = 32;
        assert!(difference(&grown).contains("`weights` takes 8 bytes"));

        let mut renamed = camera_block();
        renamed.members[1].name = "position".to_owned();
        assert!(difference(&renamed).contains("`position` has no field"));

        let mut removed = camera_block();
        removed.members.pop();
        assert!(difference(&removed).contains("`weights` has no member"));

        for size_bytes in [79, 97] {
            let mut resized = camera_block();
            resized.size_bytes = size_bytes;
            assert!(difference(&resized).contains("96 bytes long on the host"));
        }
    }

    #[test]
    fn elements_fill_their_stride() {
        let array = |stride| Member {
            array_stride_bytes: Some(stride),
            block: Some(Block { size_bytes: stride, ..camera_block() }),
            ..member("cameras", 0, 0)
        };
        assert_eq!(array(96).check_elements::<Camera>(), Ok(()));
        let error = array(112).check_elements::<Camera>().unwrap_err();
        assert!(error.difference.contains("112 bytes apart"));
        assert!(member("eye", 0, 12).check_elements::<Camera>().is_err());
    }
}
