//! The display's events, or why there are none.

use winit::event_loop::EventLoop;

use super::error::Error;

/// The loop, which hears of `T` beside the display's own events. A library of the display that is missing is the loop's
/// error as well: winit panics there.
///
/// # Errors
/// [`Error::NoDisplay`].
pub fn event_loop<T: 'static>() -> Result<EventLoop<T>, Error> {
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(|_| {}));
    let built = std::panic::catch_unwind(|| EventLoop::<T>::with_user_event().build());
    std::panic::set_hook(hook);
    match built {
        Ok(Ok(events)) => Ok(events),
        Ok(Err(error)) => {
            let text = error.to_string();
            // Behind the place in winit's source.
            let reason = text.rsplit_once(".rs:").and_then(|(_, rest)| rest.split_once(": "));
            let reason = reason.map_or(text.as_str(), |(_, reason)| reason).trim_end_matches('.').to_owned();
            Err(Error::NoDisplay { reason })
        }
        Err(panic) => {
            let words = panic.downcast_ref::<String>().cloned();
            let reason = words.or_else(|| panic.downcast_ref::<&str>().map(|text| (*text).to_owned()));
            let reason = reason.unwrap_or_else(|| "a library of the display is missing".to_owned());
            Err(Error::NoDisplay { reason })
        }
    }
}
