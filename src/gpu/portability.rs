//! Devices that offer a subset of Vulkan, as MoltenVK's on Apple's systems do (`VK_KHR_portability_subset`).

use ash::{khr, vk};

use super::error::{Context, Error};
use super::instance::Instance;

/// Features of whole Vulkan that a device of the subset lacks; `None` for a device of whole Vulkan.
///
/// # Errors
/// [`Error::NoDevice`] where the device's extensions cannot be listed.
pub(super) fn lacks(instance: &Instance, raw: vk::PhysicalDevice) -> Result<Option<Vec<&'static str>>, Error> {
    // SAFETY: `raw` comes from this instance.
    let extensions = unsafe { instance.raw.enumerate_device_extension_properties(raw) }
        .before_a_device("listing", "the extensions of a device")?;
    if !extensions.iter().any(|e| e.extension_name_as_c_str() == Ok(khr::portability_subset::NAME)) {
        return Ok(None);
    }
    let mut subset = vk::PhysicalDevicePortabilitySubsetFeaturesKHR::default();
    let mut features = vk::PhysicalDeviceFeatures2::default().push_next(&mut subset);
    // SAFETY: as above, and the chained structure outlives the call.
    unsafe { instance.raw.get_physical_device_features2(raw, &mut features) };
    let found = [
        ("constant-alpha-color-blend-factors", subset.constant_alpha_color_blend_factors),
        ("events", subset.events),
        ("image-view-format-reinterpretation", subset.image_view_format_reinterpretation),
        ("image-view-format-swizzle", subset.image_view_format_swizzle),
        ("image-view-2d-on-3d-image", subset.image_view2_d_on3_d_image),
        ("multisample-array-image", subset.multisample_array_image),
        ("mutable-comparison-samplers", subset.mutable_comparison_samplers),
        ("point-polygons", subset.point_polygons),
        ("sampler-mip-lod-bias", subset.sampler_mip_lod_bias),
        ("separate-stencil-mask-ref", subset.separate_stencil_mask_ref),
        ("shader-sample-rate-interpolation-functions", subset.shader_sample_rate_interpolation_functions),
        ("tessellation-isolines", subset.tessellation_isolines),
        ("tessellation-point-mode", subset.tessellation_point_mode),
        ("triangle-fans", subset.triangle_fans),
        ("vertex-attribute-access-beyond-stride", subset.vertex_attribute_access_beyond_stride),
    ];
    Ok(Some(found.into_iter().filter(|(_, has)| *has == vk::FALSE).map(|(name, _)| name).collect()))
}
