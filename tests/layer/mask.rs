//! Features and limits that a device is said to lack.

use std::env;
use std::ffi::{CStr, CString, c_char, c_void};
use std::sync::atomic::{AtomicUsize, Ordering};

use ash::vk;

const NAMES: [&str; 8] = [
    "vkGetPhysicalDeviceFeatures",
    "vkGetPhysicalDeviceFeatures2",
    "vkGetPhysicalDeviceProperties",
    "vkGetPhysicalDeviceProperties2",
    "vkGetPhysicalDeviceFormatProperties",
    "vkGetPhysicalDeviceFormatProperties2",
    "vkGetPhysicalDeviceQueueFamilyProperties",
    "vkEnumerateDeviceExtensionProperties",
];

static NEXT: [AtomicUsize; NAMES.len()] = [const { AtomicUsize::new(0) }; NAMES.len()];

/// Finds the next functions of all that is hooked.
pub fn resolve(next: &dyn Fn(&CStr) -> vk::PFN_vkVoidFunction) {
    for (name, slot) in NAMES.iter().zip(&NEXT) {
        if let Some(found) = CString::new(*name).ok().and_then(|name| next(&name)) {
            slot.store(found as usize, Ordering::Release);
        }
    }
}

/// The hook before a command, if it has one.
pub fn hook(name: &str) -> Option<*const c_void> {
    let hooks: [*const c_void; NAMES.len()] = [
        features as *const c_void,
        features2 as *const c_void,
        properties as *const c_void,
        properties2 as *const c_void,
        format_properties as *const c_void,
        format_properties2 as *const c_void,
        queue_families as *const c_void,
        extensions as *const c_void,
    ];
    let is_hooked = |hooked: &str| hooked != "vkEnumerateDeviceExtensionProperties" || is_subset();
    NAMES.iter().position(|&hooked| hooked == name && is_hooked(hooked)).map(|index| hooks[index])
}

/// Set to play a device of the portability subset, which lacks all that it may.
pub fn is_subset() -> bool {
    lacks("whole-vulkan")
}

fn lacks(feature: &str) -> bool {
    env::var("FUMAROLE_LAYER_LACKS").is_ok_and(|list| list.split(',').any(|lacking| lacking == feature))
}

/// The limit that is set by this name.
fn limit(name: &str) -> Option<u64> {
    let list = env::var("FUMAROLE_LAYER_LIMITS").ok()?;
    list.split(',').find_map(|entry| entry.strip_prefix(name)?.strip_prefix('=')?.parse().ok())
}

fn clear(feature: &str, value: &mut vk::Bool32) {
    if lacks(feature) {
        *value = vk::FALSE;
    }
}

fn lower(name: &str, value: &mut u32) {
    let limit = limit(name).and_then(|limit| u32::try_from(limit).ok());
    *value = (*value).min(limit.unwrap_or(u32::MAX));
}

fn mask_features(core: &mut vk::PhysicalDeviceFeatures) {
    clear("independent-blend", &mut core.independent_blend);
    clear("geometry-shader", &mut core.geometry_shader);
    clear("large-points", &mut core.large_points);
    clear("fragment-stores", &mut core.fragment_stores_and_atomics);
    clear("pipeline-statistics", &mut core.pipeline_statistics_query);
    clear("precise-occlusion", &mut core.occlusion_query_precise);
    clear("full-draw-index", &mut core.full_draw_index_uint32);
}

/// The version of Vulkan that the device is to have, of 1.0 to 1.2.
fn older_version() -> Option<u32> {
    let minor = env::var("FUMAROLE_LAYER_VULKAN").ok()?.strip_prefix("1.")?.parse().ok()?;
    Some(vk::make_api_version(0, 1, minor, 0))
}

fn mask_properties(properties: &mut vk::PhysicalDeviceProperties) {
    mask_limits(&mut properties.limits);
    properties.api_version = properties.api_version.min(older_version().unwrap_or(u32::MAX));
    if env::var_os("FUMAROLE_LAYER_DISCRETE").is_some() {
        properties.device_type = vk::PhysicalDeviceType::DISCRETE_GPU;
    }
    if let Ok(name) = env::var("FUMAROLE_LAYER_NAME") {
        properties.device_name = [0; vk::MAX_PHYSICAL_DEVICE_NAME_SIZE];
        let last = properties.device_name.len() - 1;
        for (to, from) in properties.device_name[..last].iter_mut().zip(name.bytes()) {
            *to = from as c_char;
        }
    }
}

fn mask_limits(limits: &mut vk::PhysicalDeviceLimits) {
    let counts = [
        ("max-image-dimension-2d", &mut limits.max_image_dimension2_d),
        ("max-image-dimension-3d", &mut limits.max_image_dimension3_d),
        ("max-image-array-layers", &mut limits.max_image_array_layers),
        ("max-framebuffer-size", &mut limits.max_framebuffer_width),
        ("max-framebuffer-size", &mut limits.max_framebuffer_height),
        ("max-color-attachments", &mut limits.max_color_attachments),
        ("max-storage-buffer-range", &mut limits.max_storage_buffer_range),
        ("max-uniform-buffer-range", &mut limits.max_uniform_buffer_range),
        ("max-push-constants-size", &mut limits.max_push_constants_size),
        ("max-sampler-allocation-count", &mut limits.max_sampler_allocation_count),
        ("max-memory-allocation-count", &mut limits.max_memory_allocation_count),
        ("max-compute-work-group-invocations", &mut limits.max_compute_work_group_invocations),
        ("max-compute-shared-memory-size", &mut limits.max_compute_shared_memory_size),
        ("max-draw-indexed-index-value", &mut limits.max_draw_indexed_index_value),
        ("max-vertex-input-attributes", &mut limits.max_vertex_input_attributes),
        ("max-vertex-input-bindings", &mut limits.max_vertex_input_bindings),
        ("max-vertex-input-attribute-offset", &mut limits.max_vertex_input_attribute_offset),
        ("max-vertex-input-binding-stride", &mut limits.max_vertex_input_binding_stride),
        ("max-vertex-output-components", &mut limits.max_vertex_output_components),
        ("max-geometry-shader-invocations", &mut limits.max_geometry_shader_invocations),
        ("max-geometry-input-components", &mut limits.max_geometry_input_components),
        ("max-geometry-output-components", &mut limits.max_geometry_output_components),
        ("max-geometry-output-vertices", &mut limits.max_geometry_output_vertices),
        ("max-geometry-total-output-components", &mut limits.max_geometry_total_output_components),
        ("max-fragment-input-components", &mut limits.max_fragment_input_components),
        ("max-fragment-output-attachments", &mut limits.max_fragment_output_attachments),
        ("max-fragment-combined-output-resources", &mut limits.max_fragment_combined_output_resources),
        ("max-bound-descriptor-sets", &mut limits.max_bound_descriptor_sets),
        ("max-per-stage-resources", &mut limits.max_per_stage_resources),
        ("max-per-stage-descriptor-samplers", &mut limits.max_per_stage_descriptor_samplers),
        ("max-per-stage-descriptor-uniform-buffers", &mut limits.max_per_stage_descriptor_uniform_buffers),
        ("max-per-stage-descriptor-storage-buffers", &mut limits.max_per_stage_descriptor_storage_buffers),
        ("max-per-stage-descriptor-sampled-images", &mut limits.max_per_stage_descriptor_sampled_images),
        ("max-per-stage-descriptor-storage-images", &mut limits.max_per_stage_descriptor_storage_images),
        ("max-descriptor-set-samplers", &mut limits.max_descriptor_set_samplers),
        ("max-descriptor-set-uniform-buffers", &mut limits.max_descriptor_set_uniform_buffers),
        ("max-descriptor-set-storage-buffers", &mut limits.max_descriptor_set_storage_buffers),
        ("max-descriptor-set-sampled-images", &mut limits.max_descriptor_set_sampled_images),
        ("max-descriptor-set-storage-images", &mut limits.max_descriptor_set_storage_images),
    ];
    counts.into_iter().for_each(|(name, count)| lower(name, count));
    for (name, of_axes) in [
        ("max-compute-work-group-count", &mut limits.max_compute_work_group_count[..]),
        ("max-compute-work-group-size", &mut limits.max_compute_work_group_size[..]),
        ("max-viewport-dimensions", &mut limits.max_viewport_dimensions[..]),
    ] {
        of_axes.iter_mut().for_each(|count| lower(name, count));
    }
    for (name, bytes) in [
        ("min-uniform-buffer-offset-alignment", &mut limits.min_uniform_buffer_offset_alignment),
        ("min-storage-buffer-offset-alignment", &mut limits.min_storage_buffer_offset_alignment),
        ("buffer-image-granularity", &mut limits.buffer_image_granularity),
        ("non-coherent-atom-size", &mut limits.non_coherent_atom_size),
    ] {
        *bytes = (*bytes).max(limit(name).unwrap_or(0));
    }
    if let Some(size) = limit("max-point-size") {
        limits.point_size_range[1] = limits.point_size_range[1].min(size as f32);
    }
    if lacks("timestamps") {
        limits.timestamp_compute_and_graphics = vk::FALSE;
    }
}

fn mask_format(format: vk::Format, properties: &mut vk::FormatProperties) {
    let blend = match format {
        vk::Format::R32_SFLOAT => "blend-r32f",
        vk::Format::R16G16B16A16_SFLOAT => "blend-rgba16f",
        vk::Format::R32G32B32A32_SFLOAT => "blend-rgba32f",
        vk::Format::D32_SFLOAT_S8_UINT if lacks("depth-stencil-d32s8") => {
            properties.optimal_tiling_features = vk::FormatFeatureFlags::empty();
            return;
        }
        _ => return,
    };
    if lacks(blend) {
        properties.optimal_tiling_features &= !vk::FormatFeatureFlags::COLOR_ATTACHMENT_BLEND;
    }
}

/// Calls `change` on the structure of a type in a chain.
///
/// # Safety
/// The chain is Vulkan's, and `T` has this type.
pub unsafe fn change_in_chain<T>(mut chain: *mut c_void, s_type: vk::StructureType, mut change: impl FnMut(&mut T)) {
    // SAFETY: see above; every structure of a chain begins as this one does.
    unsafe {
        while let Some(found) = chain.cast::<vk::BaseOutStructure<'_>>().as_mut() {
            if found.s_type == s_type {
                change(&mut *chain.cast::<T>());
            }
            chain = found.p_next.cast();
        }
    }
}

/// The next function of this signature.
///
/// # Safety
/// `F` is the type of a pointer to the command of this index in `NAMES`.
unsafe fn next<F: Copy>(index: usize) -> F {
    let address = NEXT[index].load(Ordering::Acquire);
    // SAFETY: a function pointer has the size of an address, and its type is right by the caller.
    unsafe { std::mem::transmute_copy(&address) }
}

unsafe extern "system" fn features(physical: vk::PhysicalDevice, found: *mut vk::PhysicalDeviceFeatures) {
    // SAFETY: here and below, the caller's arguments go through, and what it gives to be filled lives for the call.
    unsafe {
        next::<vk::PFN_vkGetPhysicalDeviceFeatures>(0)(physical, found);
        mask_features(&mut *found);
    }
}

unsafe extern "system" fn features2(physical: vk::PhysicalDevice, found: *mut vk::PhysicalDeviceFeatures2<'_>) {
    // SAFETY: as above; the types are those of their structures.
    unsafe {
        next::<vk::PFN_vkGetPhysicalDeviceFeatures2>(1)(physical, found.cast());
        mask_features(&mut (*found).features);
        let chain = (*found).p_next;
        crate::lend::features(chain);
        change_in_chain(
            chain,
            vk::StructureType::PHYSICAL_DEVICE_VULKAN_1_2_FEATURES,
            |v12: &mut vk::PhysicalDeviceVulkan12Features<'_>| clear("host-query-reset", &mut v12.host_query_reset),
        );
        change_in_chain(
            chain,
            vk::StructureType::PHYSICAL_DEVICE_VULKAN_1_3_FEATURES,
            |v13: &mut vk::PhysicalDeviceVulkan13Features<'_>| {
                clear("synchronization2", &mut v13.synchronization2);
                clear("maintenance4", &mut v13.maintenance4);
            },
        );
    }
}

/// One extension, or its number: the papers use none of those that a driver has.
unsafe extern "system" fn extensions(
    _physical: vk::PhysicalDevice,
    _layer: *const c_char,
    count: *mut u32,
    found: *mut vk::ExtensionProperties,
) -> vk::Result {
    // SAFETY: as above.
    unsafe {
        *count = 1;
        if let Some(found) = found.as_mut() {
            *found = vk::ExtensionProperties::default();
            let name = ash::khr::portability_subset::NAME.to_bytes();
            for (to, from) in found.extension_name.iter_mut().zip(name) {
                *to = *from as c_char;
            }
        }
    }
    vk::Result::SUCCESS
}

unsafe extern "system" fn properties(physical: vk::PhysicalDevice, found: *mut vk::PhysicalDeviceProperties) {
    // SAFETY: as above.
    unsafe {
        next::<vk::PFN_vkGetPhysicalDeviceProperties>(2)(physical, found);
        mask_properties(&mut *found);
    }
}

unsafe extern "system" fn properties2(physical: vk::PhysicalDevice, found: *mut vk::PhysicalDeviceProperties2<'_>) {
    // SAFETY: as above.
    unsafe {
        next::<vk::PFN_vkGetPhysicalDeviceProperties2>(3)(physical, found.cast());
        mask_properties(&mut (*found).properties);
        change_in_chain(
            (*found).p_next,
            vk::StructureType::PHYSICAL_DEVICE_VULKAN_1_3_PROPERTIES,
            |v13: &mut vk::PhysicalDeviceVulkan13Properties<'_>| {
                v13.max_buffer_size = v13.max_buffer_size.min(limit("max-buffer-size").unwrap_or(u64::MAX));
            },
        );
    }
}

unsafe extern "system" fn format_properties(
    physical: vk::PhysicalDevice,
    format: vk::Format,
    found: *mut vk::FormatProperties,
) {
    // SAFETY: as above.
    unsafe {
        next::<vk::PFN_vkGetPhysicalDeviceFormatProperties>(4)(physical, format, found);
        mask_format(format, &mut *found);
    }
}

unsafe extern "system" fn format_properties2(
    physical: vk::PhysicalDevice,
    format: vk::Format,
    found: *mut vk::FormatProperties2<'_>,
) {
    // SAFETY: as above.
    unsafe {
        next::<vk::PFN_vkGetPhysicalDeviceFormatProperties2>(5)(physical, format, found.cast());
        mask_format(format, &mut (*found).format_properties);
    }
}

unsafe extern "system" fn queue_families(
    physical: vk::PhysicalDevice,
    count: *mut u32,
    found: *mut vk::QueueFamilyProperties,
) {
    // SAFETY: as above; the driver has filled so many.
    unsafe {
        next::<vk::PFN_vkGetPhysicalDeviceQueueFamilyProperties>(6)(physical, count, found);
        if found.is_null() {
            return;
        }
        for family in std::slice::from_raw_parts_mut(found, *count as usize) {
            if lacks("compute-queue") {
                family.queue_flags &= !vk::QueueFlags::COMPUTE;
            }
            lower("timestamp-valid-bits", &mut family.timestamp_valid_bits);
            if lacks("timestamps") {
                family.timestamp_valid_bits = 0;
            }
        }
    }
}
