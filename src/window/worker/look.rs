//! Values of targets for the window.

use super::outbox::Exchange;
use crate::image::{Raster, Rgba8, Samples, Shape, Statistics as Counted};
use crate::measure::Error;
use crate::window::protocol::{
    BINS, Block, PERCENTILES, Picture, Statistics, TABLE_VALUES, TargetChoice, TargetValues, ValueKind,
};

/// Lays a picture into the common file.
///
/// # Errors
/// Of a file that cannot grow.
pub fn picture(exchange: &mut Exchange, serial: u64, picture: &Rgba8) -> Result<Picture, Error> {
    let block = put(exchange, serial, picture.pixels())?;
    Ok(Picture { width: picture.width(), height: picture.height(), block })
}

fn put(exchange: &mut Exchange, serial: u64, bytes: &[u8]) -> Result<Block, Error> {
    exchange.put(serial, bytes).map_err(|error| {
        let problem = format!("handing {} bytes to the window: {error}", bytes.len());
        Error::Input(format!("{problem}; free memory in /dev/shm, or set TMPDIR to a folder with more space"))
    })
}

/// The layer or rows of `raster` that are wanted, with statistics.
///
/// # Errors
/// For a layer or a row that is not there; of a file that cannot grow.
pub fn target(
    exchange: &mut Exchange,
    serial: u64,
    choice: &TargetChoice,
    raster: &Raster,
    is_written: bool,
) -> Result<TargetValues, Error> {
    let (first, width, height, channels) = match raster.shape() {
        Shape::Image { layers, height, width, channels } => {
            if choice.layer >= layers {
                return Err(Error::Input(format!("{}: it has layers 0 to {}", choice.name, layers.saturating_sub(1))));
            }
            let layer = u64::from(width) * u64::from(height) * u64::from(channels);
            (u64::from(choice.layer) * layer, width, height, channels)
        }
        Shape::Table { rows, columns } => {
            let (rows, columns) = (rows as u64, columns as u64);
            if choice.first_row >= rows {
                return Err(Error::Input(format!("{}: it has rows 0 to {}", choice.name, rows.saturating_sub(1))));
            }
            let shown = (TABLE_VALUES / columns.max(1)).clamp(1, rows - choice.first_row);
            (choice.first_row * columns, columns as u32, shown as u32, 1)
        }
    };
    let (first, count) = (first as usize, width as usize * height as usize * channels as usize);
    let (kind, bytes, of): (_, &[u8], Box<dyn Fn(usize) -> f64>) = match raster.samples() {
        Samples::F32(values) => {
            let values = &values[first..first + count];
            (ValueKind::F32, bytemuck::cast_slice(values), Box::new(|at| f64::from(values[at])))
        }
        Samples::U32(values) => {
            let values = &values[first..first + count];
            (ValueKind::U32, bytemuck::cast_slice(values), Box::new(|at| f64::from(values[at])))
        }
        Samples::I32(values) => {
            let values = &values[first..first + count];
            (ValueKind::I32, bytemuck::cast_slice(values), Box::new(|at| f64::from(values[at])))
        }
        Samples::U8(values) => {
            let values = &values[first..first + count];
            (ValueKind::U8, values, Box::new(|at| f64::from(values[at])))
        }
        Samples::U16(_) => return Err(Error::Input(format!("{}: no target has 16-bit integers", choice.name))),
    };
    // The columns of a table are different things, as channels are.
    let series = if channels > 1 { channels as usize } else { column_count(raster) };
    let each = |index: usize| Counted::of((index..count).step_by(series).map(&of), &PERCENTILES, BINS);
    let statistics = (0..series).map(|index| statistics(each(index))).collect();
    let block = put(exchange, serial, bytes)?;
    Ok(TargetValues { choice: choice.clone(), kind, width, height, channels, block, statistics, is_written })
}

/// Most columns of a table that statistics tell apart; a wider one is a grid of one kind of value.
const MOST_COLUMNS: usize = 16;

fn column_count(raster: &Raster) -> usize {
    match raster.shape() {
        Shape::Table { columns, .. } if (1..=MOST_COLUMNS).contains(&columns) => columns,
        _ => 1,
    }
}

fn statistics(counted: Counted) -> Statistics {
    Statistics {
        count: counted.count,
        not_finite: counted.not_finite,
        masked: counted.masked,
        sentinels: counted.sentinels,
        min: counted.range_and_mean.map(|(min, ..)| min),
        max: counted.range_and_mean.map(|(_, max, _)| max),
        mean: counted.range_and_mean.map(|(.., mean)| mean),
        percentiles: counted.percentiles,
        histogram: counted.histogram,
    }
}
