use super::gltf_buffer::Buffers;
use ::gltf::Accessor;
use ::gltf::accessor::{DataType, Dimensions};

/// Checks that an accessor has one of the `types` of data and lies inside its buffer, which the
/// `gltf` crate takes for granted.
///
/// The error is what is wrong with the
/// accessor.
pub(super) fn check(
    accessor: &Accessor<'_>,
    types: &[(Dimensions, DataType)],
    buffers: &Buffers<'_>,
) -> Result<(), String> {
    let data = (accessor.dimensions(), accessor.data_type());
    if !types.contains(&data) {
        return Err(format!("data of type {:?} of {:?} is not supported", data.0, data.1));
    }
    let view = match accessor.view() {
        Some(view) if accessor.sparse().is_none() => view,
        _ => {
            return Err("sparse or compressed data is not supported; export the mesh without".to_owned());
        }
    };
    let size_bytes = accessor.size();
    let stride_bytes = view.stride().unwrap_or(size_bytes);
    let end_in_view = accessor
        .count()
        .checked_sub(1)
        .ok_or_else(|| "it has no elements".to_owned())?
        .checked_mul(stride_bytes)
        .and_then(|last| last.checked_add(accessor.offset()))
        .and_then(|last| last.checked_add(size_bytes));
    let end_in_buffer = view.offset().checked_add(view.length());
    let buffer_bytes = buffers.get(view.buffer().index()).map_or(0, <[u8]>::len);
    let fits = |end: Option<usize>, length: usize| end.is_some_and(|end| end <= length);
    if stride_bytes < size_bytes || !fits(end_in_view, view.length()) || !fits(end_in_buffer, buffer_bytes) {
        return Err(format!(
            "its {} elements of {size_bytes} bytes, {stride_bytes} bytes apart, do not fit in buffer view {} of {} \
             bytes or that not in its buffer of {buffer_bytes} bytes",
            accessor.count(),
            view.index(),
            view.length()
        ));
    }
    Ok(())
}
