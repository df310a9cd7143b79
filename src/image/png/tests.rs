use super::*;

fn sample() -> Rgba8 {
    let pixels = (0..7 * 5 * 4).map(|i| (i * 37 % 251) as u8).collect();
    Rgba8::new(7, 5, pixels).unwrap()
}

/// The size, colour type, depth and samples of the file that a raster becomes.
fn written(raster: &Raster) -> ((u32, u32), ColorType, BitDepth, Vec<u8>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.png");
    super::super::write(&path, raster).unwrap();
    let mut reader = Decoder::new(BufReader::new(File::open(path).unwrap())).read_info().unwrap();
    let mut samples = vec![0; reader.output_buffer_size().unwrap()];
    let frame = reader.next_frame(&mut samples).unwrap();
    ((frame.width, frame.height), frame.color_type, frame.bit_depth, samples)
}

/// Reads `bytes` as a picture file.
fn read(bytes: &[u8]) -> Result<Rgba8, Error> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.png");
    std::fs::write(&path, bytes).unwrap();
    read_png(&path)
}

fn encoded(picture: &Rgba8) -> Vec<u8> {
    let mut bytes = Vec::new();
    let size = (picture.width(), picture.height());
    store(&mut bytes, picture.pixels(), size, (ColorType::Rgba, BitDepth::Eight), None).unwrap();
    bytes
}

#[test]
fn a_picture_comes_back_unchanged() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.png");
    write_png(&path, &sample()).unwrap();
    assert_eq!(read_png(&path).unwrap(), sample());
    let plain = std::fs::read(&path).unwrap();
    let sha256 = write_png_hashed(&path, &sample()).unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), plain);
    assert_eq!(content::file_sha256(&path).unwrap(), sha256);
    let none = Rgba8::new(0, 5, Vec::new()).unwrap();
    assert!(matches!(write_png(&path, &none), Err(Error::Empty { .. })));
    assert!(matches!(write_png_hashed(&path, &none), Err(Error::Empty { .. })));
    assert_eq!(read_png(&path).unwrap(), sample());
}

#[test]
fn grey_and_rgb_files_are_expanded() {
    let mut bytes = Vec::new();
    store(&mut bytes, &[5, 250], (2, 1), (ColorType::Grayscale, BitDepth::Eight), None).unwrap();
    assert_eq!(read(&bytes).unwrap().pixels(), [5, 5, 5, 255, 250, 250, 250, 255]);
    let mut bytes = Vec::new();
    store(&mut bytes, &[1, 2, 3], (1, 1), (ColorType::Rgb, BitDepth::Eight), None).unwrap();
    assert_eq!(read(&bytes).unwrap().pixels(), [1, 2, 3, 255]);
}

#[test]
fn wide_samples_alpha_and_palettes_are_read_to_the_nearest_eight_bits() {
    let pixels = |color, depth, samples: &[u8], size| {
        let mut bytes = Vec::new();
        store(&mut bytes, samples, size, (color, depth), None).unwrap();
        read(&bytes).unwrap().pixels().to_vec()
    };
    let wide = [0u16, 128, 129, 65_406, 65_407, 65_535].map(u16::to_be_bytes).concat();
    let grey = pixels(ColorType::Grayscale, BitDepth::Sixteen, &wide, (6, 1));
    assert_eq!(grey.iter().step_by(4).copied().collect::<Vec<u8>>(), [0, 0, 1, 254, 255, 255]);
    assert!(grey.chunks(4).all(|pixel| pixel[3] == 255 && pixel[1] == pixel[0] && pixel[2] == pixel[0]));
    assert_eq!(pixels(ColorType::GrayscaleAlpha, BitDepth::Eight, &[7, 9], (1, 1)), [7, 7, 7, 9]);
    assert_eq!(pixels(ColorType::Grayscale, BitDepth::Two, &[0b0001_1011], (4, 1))[4..8], [85, 85, 85, 255]);
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, 2, 1);
    encoder.set_color(ColorType::Indexed);
    encoder.set_palette(vec![1, 2, 3, 4, 5, 6]);
    encoder.set_trns(vec![255, 100]);
    encoder.write_header().unwrap().write_image_data(&[1, 0]).unwrap();
    assert_eq!(read(&bytes).unwrap().pixels(), [4, 5, 6, 100, 1, 2, 3, 255]);
}

/// The library would read beyond its end.
#[test]
fn a_palette_of_another_length_than_colours_have_is_refused() {
    for palette in [vec![1, 2, 3, 4], vec![1], vec![]] {
        let mut bytes = Vec::new();
        let mut encoder = Encoder::new(&mut bytes, 2, 1);
        encoder.set_color(ColorType::Indexed);
        encoder.set_palette(palette);
        encoder.write_header().unwrap().write_image_data(&[1, 0]).unwrap();
        let error = read(&bytes).unwrap_err().to_string();
        // The library knows one without a colour.
        assert!(error.contains("palette") || error.contains("PLTE"), "{error}");
    }
}

#[test]
fn small_integers_are_stored_unchanged() {
    use BitDepth::{Eight, Sixteen};
    use ColorType::{Grayscale, Rgb, Rgba};
    let image = written(&Raster::image(1, 2, 1, 1, vec![3u8, 200]).unwrap());
    assert_eq!(image, ((1, 2), Grayscale, Eight, vec![3, 200]));
    let image = written(&Raster::image(1, 1, 2, 1, vec![3u8, 200]).unwrap());
    assert_eq!(image, ((1, 1), Rgb, Eight, vec![3, 200, 0]));
    let image = written(&Raster::image(1, 1, 4, 2, vec![1u8, 2, 3, 0, 5, 6, 7, 8]).unwrap());
    assert_eq!(image, ((1, 2), Rgba, Eight, vec![1, 2, 3, 0, 5, 6, 7, 8]));
    let image = written(&Raster::table(1, 2, vec![258u16, 65_535]).unwrap());
    assert_eq!(image, ((2, 1), Grayscale, Sixteen, vec![1, 2, 255, 255]));
    let image = written(&Raster::image(1, 1, 2, 1, vec![258u16, 4]).unwrap());
    assert_eq!(image, ((1, 1), Rgb, Sixteen, vec![1, 2, 0, 4, 0, 0]));
}

#[test]
fn other_data_becomes_a_view() {
    let samples = |raster: &Raster| {
        let (_, color, depth, samples) = written(raster);
        assert_eq!((color, depth), (ColorType::Rgb, BitDepth::Eight));
        samples
    };
    let colour = [0.0, 0.214_041_14, 1.0, 0.0, f32::NAN, 0.0, 0.0, 1.0];
    let image = Raster::image(2, 1, 4, 1, colour.to_vec()).unwrap();
    assert_eq!(samples(&image), [0, 128, 255, 255, 0, 255]);
    let depth = Raster::image(3, 1, 1, 1, vec![-1.0f32, 0.0, 4.0]).unwrap();
    assert_eq!(samples(&depth), [0, 0, 0, 51, 51, 51, 255, 255, 255]);
    let counts = Raster::table(1, 2, vec![0u32, u32::MAX]).unwrap();
    assert_eq!(samples(&counts), [0, 0, 0, 255, 255, 255]);
}

#[test]
fn truncated_and_damaged_files_are_errors_and_never_panic() {
    let whole = encoded(&sample());
    for length in 0..whole.len() {
        match read(&whole[..length]) {
            Err(error) => assert!(!error.to_string().contains('\n'), "{error}"),
            // Only the end chunk may be missing: every pixel is there.
            Ok(picture) => assert!(picture == sample() && length >= whole.len() - 12),
        }
    }
    let mut state = 1u32;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        state >> 24
    };
    for position in 0..whole.len() {
        let mut bytes = whole.clone();
        bytes[position] ^= random() as u8 | 1;
        // Damage in the end chunk may pass; what is read then must be the picture.
        assert!(read(&bytes).map_or(true, |picture| picture == sample()));
    }
    for length in [1usize, 8, 60, 1000] {
        let noise: Vec<u8> = (0..length).map(|_| random() as u8).collect();
        assert!(read(&noise).is_err());
        assert!(read(&[&whole[..8], &noise].concat()).is_err());
        assert!(read(&[&whole[..33], &noise].concat()).is_err());
    }
    assert!(matches!(read_png(Path::new("no/such.png")), Err(Error::Open { .. })));
    assert!(read_png(&std::env::temp_dir()).is_err());
}

/// A file whose header promises a size and whose data never comes.
fn promise(width: u32, height: u32) -> Vec<u8> {
    let mut header = b"IHDR".to_vec();
    header.extend(width.to_be_bytes());
    header.extend(height.to_be_bytes());
    header.extend([8, 0, 0, 0, 0]);
    let crc = !header.iter().fold(!0u32, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| (crc >> 1) ^ (0xedb8_8320 & (crc & 1).wrapping_neg()))
    });
    let mut bytes = b"\x89PNG\r\n\x1a\n\0\0\0\x0d".to_vec();
    bytes.extend(header);
    bytes.extend(crc.to_be_bytes());
    bytes.extend(b"\0\0\0\x08IDAT");
    bytes
}

#[test]
fn an_absurd_size_is_refused_before_it_is_allocated() {
    for (width, height) in [(16_385, 1), (1, 16_385), (16_384, 4_097), (1 << 30, 1 << 30)] {
        let error = read(&promise(width, height)).unwrap_err();
        assert!(matches!(error, Error::TooLarge { .. }), "{error}");
    }
    assert!(matches!(read(&promise(4, 4)), Err(Error::Png { .. })));
}

/// 8,192 pixels a side in some ten kilobytes, whole and without its last row.
#[test]
fn a_damaged_picture_of_one_colour_is_refused_before_it_is_kept() {
    let side = 8_192;
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, side, side);
    encoder.set_color(ColorType::Grayscale);
    encoder.set_depth(BitDepth::One);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&vec![0; (side * side / 8) as usize]).unwrap();
    writer.finish().unwrap();
    assert!(bytes.len() < 30_000, "{}", bytes.len());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("black.png");
    let open = |bytes: &[u8], max_side: u32| {
        std::fs::write(&path, bytes).unwrap();
        CheckedPng::open(&path, max_side, None)
    };
    let whole = open(&bytes, MAX_SIDE).unwrap();
    assert!(whole.picture.is_none());
    assert_eq!(whole.size(), (side, side));
    let pixels = whole.into_picture().unwrap().into_pixels();
    assert!(pixels.len() == 1 << 26 && pixels.iter().all(|pixel| *pixel == [0, 0, 0, 255]));
    let cut = &bytes[..bytes.len() - 40];
    assert!(matches!(open(cut, MAX_SIDE), Err(Error::Png { .. })));
    let too_large = open(&bytes, side - 1);
    assert!(matches!(too_large, Err(Error::TooLarge { .. })));
}
