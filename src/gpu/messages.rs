//! Messages of the validation layer. The callback collects and lets the program go on; whoever asked for validation
//! drains the messages and fails.

use std::ffi::{CStr, c_void};
use std::sync::Mutex;

use ash::vk;

/// One message of the validation layer.
#[derive(Debug, Clone)]
pub struct Message {
    /// Error or warning.
    pub severity: vk::DebugUtilsMessageSeverityFlagsEXT,
    /// The VUID or the synchronization hazard's identifier.
    pub id: String,
    /// The layer's own words.
    pub text: String,
    /// The debug names of the objects concerned.
    pub objects: Vec<String>,
}

impl std::fmt::Display for Message {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} [{}]: {}", self.id, self.objects.join(", "), self.text)
    }
}

/// The messages collected since the last [`Messages::take`].
#[derive(Debug, Default)]
pub struct Messages {
    list: Mutex<Vec<Message>>,
}

impl Messages {
    /// Removes and returns all messages.
    pub fn take(&self) -> Vec<Message> {
        std::mem::take(&mut *self.list.lock().unwrap_or_else(|p| p.into_inner()))
    }

    fn push(&self, message: Message) {
        self.list.lock().unwrap_or_else(|p| p.into_inner()).push(message);
    }
}

/// A driver's text up to its zero, or to its end where it forgot that.
pub(super) fn text(bytes: &[std::ffi::c_char]) -> String {
    let bytes: Vec<u8> = bytes.iter().take_while(|&&c| c != 0).map(|&c| c as u8).collect();
    String::from_utf8_lossy(&bytes).into_owned()
}

unsafe fn text_of(pointer: *const std::ffi::c_char) -> String {
    if pointer.is_null() {
        return String::new();
    }
    // SAFETY: the layer hands null-terminated strings that live for the duration of the callback.
    unsafe { CStr::from_ptr(pointer) }.to_string_lossy().into_owned()
}

/// The callback given to the debug messenger.
///
/// # Safety
/// Called by the layer with valid pointers; `user_data` is the `Messages` that the instance keeps alive until after it
/// has destroyed the messenger.
pub(crate) unsafe extern "system" fn collect(
    severity: vk::DebugUtilsMessageSeverityFlagsEXT,
    _kind: vk::DebugUtilsMessageTypeFlagsEXT,
    data: *const vk::DebugUtilsMessengerCallbackDataEXT<'_>,
    user_data: *mut c_void,
) -> vk::Bool32 {
    if data.is_null() || user_data.is_null() {
        return vk::FALSE;
    }
    // SAFETY: see above; both pointers were checked for null and live for this call.
    unsafe {
        let data = &*data;
        let messages = &*user_data.cast::<Messages>();
        let objects = (0..data.object_count as usize)
            .map(|i| text_of((*data.p_objects.add(i)).p_object_name))
            .filter(|name| !name.is_empty())
            .collect();
        messages.push(Message {
            severity,
            id: text_of(data.p_message_id_name),
            text: text_of(data.p_message),
            objects,
        });
    }
    vk::FALSE
}
