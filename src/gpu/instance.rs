//! The Vulkan instance: loader, validation layer, debug messenger. Extensions of surfaces are asked for by
//! [`Instance::for_display`] alone.

use std::ffi::{CStr, c_void};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use ash::{ext, vk};

use super::error::{Context, Error};
use super::live::{Kind, LiveObjects};
use super::messages::{Message, Messages, collect};

const VALIDATION_LAYER: &CStr = c"VK_LAYER_KHRONOS_validation";

/// A Vulkan instance and what belongs to it alone.
pub struct Instance {
    /// Handle with the calls of the instance.
    pub(crate) raw: ash::Instance,
    messenger: Option<(ext::debug_utils::Instance, vk::DebugUtilsMessengerEXT)>,
    messages: Arc<Messages>,
    live: Arc<LiveObjects>,
    layers: Vec<String>,
    /// Every extension that was asked for.
    extensions: Vec<String>,
    loader_version: u32,
    has_debug_utils: bool,
    id: u64,
    // Last: the loader's library must outlive every function pointer above.
    /// Calls of the loader, whose library it keeps loaded.
    pub(super) entry: ash::Entry,
}

impl Instance {
    /// Loads the loader and creates an instance of Vulkan 1.3; with `validate`, under the Khronos layer with
    /// synchronization validation.
    ///
    /// Under that layer a process makes and drops its instances and devices while no other thread calls Vulkan: 1.3.239
    /// keeps them in a table without a lock, and a call that meets the change jumps to nowhere (9 of 9 trials with a
    /// third device). Every verb of the program opens one.
    ///
    /// # Errors
    /// [`Error::NoLoader`], [`Error::NoValidationLayer`], or [`Error::NoInstance`] when no driver answers.
    pub fn new(validate: bool) -> Result<Arc<Self>, Error> {
        Self::with_extensions(validate, &[], &[])
    }

    /// As [`Instance::new`], for surfaces of the display's windows.
    ///
    /// # Errors
    /// Those of [`Instance::new`]; [`Error::NoInstance`] where the loader knows no surfaces of this kind of display.
    #[cfg(feature = "window")]
    pub fn for_display(validate: bool, display: &super::surface::Display) -> Result<Arc<Self>, Error> {
        Self::with_extensions(validate, display.required(), &super::surface::OPTIONAL_EXTENSIONS)
    }

    /// Enables the `required` extensions, and the `optional` ones where all of them are there.
    fn with_extensions(
        validate: bool,
        required: &[&'static CStr],
        optional: &[&'static CStr],
    ) -> Result<Arc<Self>, Error> {
        // SAFETY: loading the system's Vulkan loader runs its initialisers, which is what the caller asks for.
        let entry = unsafe { ash::Entry::load() }.map_err(|error| Error::NoLoader { reason: error.to_string() })?;
        // SAFETY: the entry's function pointers are valid while `entry` lives; no other precondition.
        let (loader_version, layers, extensions) = unsafe {
            (
                entry
                    .try_enumerate_instance_version()
                    .context("asking for", "the loader's version")?
                    .unwrap_or(vk::API_VERSION_1_0),
                entry.enumerate_instance_layer_properties().context("listing", "the instance layers")?,
                entry.enumerate_instance_extension_properties(None).context("listing", "the instance extensions")?,
            )
        };
        if loader_version < vk::API_VERSION_1_3 {
            return Err(Error::NoInstance {
                reason: format!("the loader offers Vulkan {}, 1.3 is needed", version_text(loader_version)),
            });
        }
        let has_layer = layers.iter().any(|l| l.layer_name_as_c_str() == Ok(VALIDATION_LAYER));
        if validate && !has_layer {
            return Err(Error::NoValidationLayer);
        }
        let offers = |name: &CStr| extensions.iter().any(|e| e.extension_name_as_c_str() == Ok(name));
        let has_debug_utils = validate || offers(ext::debug_utils::NAME);

        if let Some(missing) = required.iter().find(|name| !offers(name)) {
            let reason = format!("no driver here has {}, which windows need", missing.to_string_lossy());
            return Err(Error::NoInstance { reason });
        }
        let mut enabled: Vec<&CStr> = required.to_vec();
        if optional.iter().all(|name| offers(name)) {
            enabled.extend(optional);
        }
        let mut flags = vk::InstanceCreateFlags::empty();
        if has_debug_utils {
            enabled.push(ext::debug_utils::NAME);
        }
        if offers(ash::khr::portability_enumeration::NAME) {
            enabled.push(ash::khr::portability_enumeration::NAME);
            flags |= vk::InstanceCreateFlags::ENUMERATE_PORTABILITY_KHR;
        }
        let mut enabled_layers = Vec::new();
        if validate {
            enabled_layers.push(VALIDATION_LAYER.as_ptr());
            enabled.push(ext::validation_features::NAME);
        }
        let enabled_extensions: Vec<_> = enabled.iter().map(|name| name.as_ptr()).collect();

        let messages = Arc::new(Messages::default());
        let application = vk::ApplicationInfo::default()
            .application_name(c"fumarole")
            .engine_name(c"fumarole")
            .api_version(vk::API_VERSION_1_3);
        let enables = [vk::ValidationFeatureEnableEXT::SYNCHRONIZATION_VALIDATION];
        let mut validation = vk::ValidationFeaturesEXT::default().enabled_validation_features(&enables);
        let mut messenger_info = messenger_info(&messages);
        let mut info = vk::InstanceCreateInfo::default()
            .flags(flags)
            .application_info(&application)
            .enabled_layer_names(&enabled_layers)
            .enabled_extension_names(&enabled_extensions);
        if validate {
            info = info.push_next(&mut validation).push_next(&mut messenger_info);
        }
        // SAFETY: every pointer in `info` refers to locals that outlive the call.
        let raw = unsafe { entry.create_instance(&info, None) }
            .map_err(|result| Error::NoInstance { reason: result.to_string() })?;
        static NEXT: AtomicU64 = AtomicU64::new(0);
        let live = Arc::new(LiveObjects::default());
        live.add(Kind::Instance);
        let mut instance = Instance {
            raw,
            messenger: None,
            messages,
            live,
            layers: if validate { vec![VALIDATION_LAYER.to_string_lossy().into_owned()] } else { Vec::new() },
            extensions: enabled.iter().map(|name| name.to_string_lossy().into_owned()).collect(),
            loader_version,
            has_debug_utils,
            id: NEXT.fetch_add(1, Ordering::Relaxed),
            entry,
        };
        if validate {
            let utils = ext::debug_utils::Instance::new(&instance.entry, &instance.raw);
            let info = self::messenger_info(&instance.messages);
            // SAFETY: the user data is owned by `instance`, which destroys the messenger before dropping it.
            let messenger = unsafe { utils.create_debug_utils_messenger(&info, None) }
                .before_a_device("creating", "the debug messenger")?;
            instance.messenger = Some((utils, messenger));
        }
        Ok(Arc::new(instance))
    }

    /// True when the validation layer is on.
    pub fn validates(&self) -> bool {
        self.messenger.is_some()
    }

    /// Removes and returns the messages of the validation layer since the last call.
    pub fn take_messages(&self) -> Vec<Message> {
        self.messages.take()
    }

    /// Fails with the first message if the validation layer said anything.
    ///
    /// # Errors
    /// [`Error::Validation`].
    pub fn check_messages(&self) -> Result<(), Error> {
        let messages = self.take_messages();
        match messages.first() {
            None => Ok(()),
            Some(first) => Err(Error::Validation { count: messages.len(), first: first.to_string() }),
        }
    }

    /// The counts of live objects and memory.
    pub fn live(&self) -> &Arc<LiveObjects> {
        &self.live
    }

    /// The layers that this program switched on.
    pub fn layers(&self) -> &[String] {
        &self.layers
    }

    /// Every extension that was asked for.
    pub fn extensions(&self) -> &[String] {
        &self.extensions
    }

    /// The loader's version, as `major.minor.patch`.
    pub fn loader_version(&self) -> String {
        version_text(self.loader_version)
    }

    /// Unique in the process.
    pub(crate) fn id(&self) -> u64 {
        self.id
    }

    pub(crate) fn has_debug_utils(&self) -> bool {
        self.has_debug_utils
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        // SAFETY: devices hold an `Arc` of this instance, so none is left; the messenger goes first.
        unsafe {
            if let Some((utils, messenger)) = self.messenger.take() {
                utils.destroy_debug_utils_messenger(messenger, None);
            }
            self.raw.destroy_instance(None);
        }
        self.live.remove(Kind::Instance);
    }
}

fn messenger_info(messages: &Arc<Messages>) -> vk::DebugUtilsMessengerCreateInfoEXT<'static> {
    vk::DebugUtilsMessengerCreateInfoEXT::default()
        .message_severity(vk::DebugUtilsMessageSeverityFlagsEXT::ERROR | vk::DebugUtilsMessageSeverityFlagsEXT::WARNING)
        .message_type(vk::DebugUtilsMessageTypeFlagsEXT::VALIDATION | vk::DebugUtilsMessageTypeFlagsEXT::PERFORMANCE)
        .pfn_user_callback(Some(collect))
        .user_data(Arc::as_ptr(messages).cast_mut().cast::<c_void>())
}

/// `major.minor.patch` of a packed version.
pub(crate) fn version_text(version: u32) -> String {
    format!("{}.{}.{}", vk::api_version_major(version), vk::api_version_minor(version), vk::api_version_patch(version))
}
