use std::io::{self, Seek, Write};

use ::exr::image::write::WritableImage;
use ::exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, ImageAttributes, IntegerBounds, Layer, LayerAttributes,
};

use super::raster::{Planes, Raster, Samples};

const CHANNEL_NAMES: [&[&str]; 4] = [&["Y"], &["R", "G"], &["R", "G", "B"], &["R", "G", "B", "A"]];

/// Writes a raster that is not empty as OpenEXR, every value unchanged but signed integers beyond 2^24.
pub(super) fn encode(file: &mut (impl Write + Seek), raster: &Raster) -> io::Result<()> {
    let planes = raster.planes();
    let size = (planes.width, planes.height);
    let layers: Vec<_> = (0..planes.layers)
        .map(|layer| {
            let names = CHANNEL_NAMES[planes.channels - 1].iter().enumerate();
            let channels =
                names.map(|(channel, &name)| AnyChannel::new(name, plane(raster.samples(), &planes, layer, channel)));
            let attributes = if planes.layers == 1 {
                LayerAttributes::default()
            } else {
                LayerAttributes::named(format!("layer{layer}").as_str())
            };
            Layer::new(size, attributes, Encoding::SMALL_FAST_LOSSLESS, AnyChannels::sort(channels.collect()))
        })
        .collect();
    let bounds = IntegerBounds::from_dimensions(size);
    Image::from_layers(ImageAttributes::new(bounds), layers).write().to_buffered(file).map_err(super::encoder_error)
}

/// One channel of one layer, row by row.
fn plane(samples: &Samples, planes: &Planes, layer: usize, channel: usize) -> FlatSamples {
    let pixels = planes.width * planes.height;
    let first = layer * pixels * planes.channels + channel;
    let of = (first, planes.channels, pixels);
    match samples {
        Samples::F32(values) => FlatSamples::F32(every(values, of)),
        Samples::U32(values) => FlatSamples::U32(every(values, of)),
        // The format has no signed integers.
        Samples::I32(values) => {
            FlatSamples::F32(every(values, of).into_iter().map(|value: i32| value as f32).collect())
        }
        Samples::U16(values) => FlatSamples::U32(every(values, of)),
        Samples::U8(values) => FlatSamples::U32(every(values, of)),
    }
}

fn every<T: Copy, U: From<T>>(values: &[T], (first, step, count): (usize, usize, usize)) -> Vec<U> {
    let chosen = values[first..].iter().step_by(step).take(count);
    chosen.copied().map(U::from).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use ::exr::prelude::read_all_flat_layers_from_file;

    type Channels = Vec<(String, FlatSamples)>;

    /// Writes and reads back: (name, (width, height), channels) of every layer.
    fn round_trip(raster: &Raster) -> Vec<(Option<String>, (usize, usize), Channels)> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.exr");
        super::super::write(&path, raster).unwrap();
        let image = read_all_flat_layers_from_file(&path).unwrap();
        let layers = image.layer_data.into_iter();
        layers
            .map(|layer| {
                let channels = layer.channel_data.list.into_iter();
                (
                    layer.attributes.layer_name.map(|name| name.to_string()),
                    (layer.size.x(), layer.size.y()),
                    channels.map(|channel| (channel.name.to_string(), channel.sample_data)).collect(),
                )
            })
            .collect()
    }

    fn bits(samples: &FlatSamples) -> Vec<u32> {
        match samples {
            FlatSamples::F32(values) => values.iter().map(|value| value.to_bits()).collect(),
            FlatSamples::U32(values) => values.clone(),
            FlatSamples::F16(_) => panic!("half floats lose precision"),
        }
    }

    #[test]
    fn floats_come_back_bit_for_bit() {
        let special = [
            f32::NAN,
            f32::from_bits(0xffc0_1234),
            f32::INFINITY,
            f32::NEG_INFINITY,
            -0.0,
            f32::MIN_POSITIVE / 8.0,
            f32::MAX,
            1.0 / 3.0,
        ];
        let mut values: Vec<f32> = (0..5 * 37 * 4).map(|i| i as f32 * 0.37 - 5.0).collect();
        values[40..48].copy_from_slice(&special);
        let raster = Raster::image(5, 37, 4, 1, values.clone()).unwrap();
        let layers = round_trip(&raster);
        assert_eq!(layers.len(), 1);
        let (name, size, channels) = &layers[0];
        assert_eq!((name.as_deref(), *size), (None, (5, 37)));
        for (offset, wanted) in ["R", "G", "B", "A"].into_iter().enumerate() {
            let (_, found) = channels.iter().find(|(name, _)| name == wanted).unwrap();
            let expected = values.iter().skip(offset).step_by(4);
            let expected: Vec<u32> = expected.map(|value| value.to_bits()).collect();
            assert!(matches!(found, FlatSamples::F32(_)));
            assert_eq!(bits(found), expected, "{wanted}");
        }
    }

    #[test]
    fn integers_stay_integers() {
        let values = vec![0, 1, u32::MAX, 16_777_217, 5, 6];
        let layers = round_trip(&Raster::image(3, 2, 1, 1, values.clone()).unwrap());
        assert_eq!(layers[0].2, [("Y".to_owned(), FlatSamples::U32(values))]);
        let layers = round_trip(&Raster::table(2, 3, vec![9u8, 8, 7, 255, 0, 1]).unwrap());
        assert_eq!(layers[0].1, (3, 2));
        assert_eq!(bits(&layers[0].2[0].1), [9, 8, 7, 255, 0, 1]);
        let layers = round_trip(&Raster::image(1, 1, 2, 1, vec![7u16, u16::MAX]).unwrap());
        assert_eq!(
            layers[0].2,
            [("G".to_owned(), FlatSamples::U32(vec![65_535])), ("R".to_owned(), FlatSamples::U32(vec![7])),]
        );
    }

    #[test]
    fn an_array_target_becomes_named_layers() {
        let values: Vec<f32> = (0..3 * 2 * 2 * 2).map(|i| i as f32).collect();
        let layers = round_trip(&Raster::image(2, 2, 2, 3, values).unwrap());
        assert_eq!(layers.len(), 3);
        for (index, (name, size, channels)) in layers.iter().enumerate() {
            assert_eq!(name.as_deref(), Some(format!("layer{index}").as_str()));
            assert_eq!(*size, (2, 2));
            let red = [0.0, 2.0, 4.0, 6.0].map(|value| value + index as f32 * 8.0);
            assert_eq!(channels[1], ("R".to_owned(), FlatSamples::F32(red.to_vec())));
        }
    }
}
