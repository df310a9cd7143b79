use crate::scene::Mesh;
use crate::scene::error::{Fault, Place};
use crate::scene::normals::Weld;
use glam::Vec3;
use std::io::{self, Cursor, Read, Seek, SeekFrom};

/// Header and triangle count of a binary file.
const PREFIX_BYTES: usize = 84;
const TRIANGLE_BYTES: usize = 50;

/// Reads an STL file, binary or text. Vertices at the same position become one; normals are computed anew, since an STL
/// file has only those of its facets.
///
/// The size tells the kinds apart, because many binary files start with `solid` as well.
pub(super) fn parse(mut bytes: Vec<u8>) -> Result<Mesh, Fault> {
    let claimed = claimed_bytes(&bytes);
    let is_text = bytes
        .trim_ascii_start()
        .get(..5)
        .is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    if is_text && claimed != Some(bytes.len() as u64) {
        let mut text = Text::new(&bytes);
        return read(&mut text).map_err(|error| Fault::foreign(Place::Line(text.line), &error));
    }
    match claimed {
        Some(claimed) if claimed <= bytes.len() as u64 => {
            // stl_io takes a file that starts like this for text.
            bytes[..5].fill(b' ');
            read(&mut Cursor::new(bytes)).map_err(|error| Fault::foreign(Place::Whole, &error))
        }
        Some(claimed) => {
            let reason = format!(
                "its header claims {claimed} bytes of triangles and header, but the file has {}; it is cut off or not \
                 an STL file",
                bytes.len()
            );
            Err(Fault::new(Place::Byte(80), reason))
        }
        None => {
            let reason = "it is neither text that starts with \"solid\" nor long enough for a binary STL file";
            Err(Fault::new(Place::Whole, reason))
        }
    }?
    .into_mesh()
}
