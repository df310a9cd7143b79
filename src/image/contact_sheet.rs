//! Pictures in rows, as figures show them.

use super::{Error, Rgba8};

/// Pictures of one size, the first on the left.
///
/// # Errors
/// [`Error::SizeMismatch`].
pub fn side_by_side(pictures: &[Rgba8]) -> Result<Rgba8, Error> {
    let size = |p: &Rgba8| (p.width(), p.height());
    let (width, height) = pictures.first().map_or((0, 0), size);
    if let Some(other) = pictures.iter().find(|p| size(p) != (width, height)) {
        return Err(Error::SizeMismatch { left: (width, height), right: size(other) });
    }
    let row = 4 * width as usize;
    let rows =
        (0..height as usize).flat_map(|y| pictures.iter().flat_map(move |p| &p.pixels()[y * row..(y + 1) * row]));
    Rgba8::new(width * pictures.len() as u32, height, rows.copied().collect())
}

/// Pictures of one width, the first on top.
///
/// # Errors
/// [`Error::SizeMismatch`] where the widths differ.
pub fn below_each_other(pictures: &[Rgba8]) -> Result<Rgba8, Error> {
    let size = |p: &Rgba8| (p.width(), p.height());
    let (width, first) = pictures.first().map_or((0, 0), size);
    if let Some(other) = pictures.iter().find(|p| p.width() != width) {
        return Err(Error::SizeMismatch { left: (width, first), right: size(other) });
    }
    let height = pictures.iter().map(Rgba8::height).sum();
    let pixels = pictures.iter().flat_map(Rgba8::pixels).copied().collect();
    Rgba8::new(width, height, pixels)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_stand_in_rows() {
        let plain = |value: u8| Rgba8::new(2, 1, vec![value; 8]).unwrap();
        let row = side_by_side(&[plain(1), plain(2)]).unwrap();
        assert_eq!((row.width(), row.height(), row.pixels()[7], row.pixels()[8]), (4, 1, 1, 2));
        let other = Rgba8::new(1, 2, vec![0; 8]).unwrap();
        assert!(matches!(side_by_side(&[plain(1), other]), Err(Error::SizeMismatch { .. })));
        assert!(matches!(below_each_other(&[row.clone(), plain(1)]), Err(Error::SizeMismatch { .. })));
        let column = below_each_other(&[row.clone(), row]).unwrap();
        assert_eq!((column.width(), column.height(), column.pixels()[16]), (4, 2, 1));
    }
}
