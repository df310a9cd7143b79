//! Requests to the worker that are shown as if they were done already, until the worker says what is: a worker that draws
//! a frame of seconds answers late.

use std::collections::HashMap;

use super::protocol::{Event, Request};

/// Values on their way.
#[derive(Debug, Default)]
pub struct Sent {
    /// None for one that goes back to what it is without a hand.
    parameters: HashMap<String, Underway<Option<String>>>,
    is_playing: Option<Underway<bool>>,
    speed: Option<Underway<f64>>,
}

#[derive(Debug)]
struct Underway<T> {
    value: T,
    /// Number of the request, once it has one.
    id: Option<u64>,
}

impl<T> Underway<T> {
    fn new(value: T) -> Self {
        Underway { value, id: None }
    }

    /// The worker has heard of it when it had heard of request `heeds`.
    fn is_heard(&self, heeds: u64) -> bool {
        self.id.is_some_and(|id| id <= heeds)
    }

    fn number(&mut self, id: u64) {
        self.id.get_or_insert(id);
    }
}

impl Sent {
    /// Takes over what a request sets.
    pub fn ask(&mut self, request: &Request) {
        match request {
            Request::Set(assignments) => {
                for assignment in assignments {
                    let (name, text) = (assignment.name.clone(), assignment.values.join(" "));
                    // What a value goes back to is the worker's to say.
                    self.parameters.insert(name, Underway::new((!text.is_empty()).then_some(text)));
                }
            }
            Request::Play | Request::Pause => self.is_playing = Some(Underway::new(*request == Request::Play)),
            Request::Speed(speed) => self.speed = Some(Underway::new(*speed)),
            _ => {}
        }
    }

    /// Notes that all requests so far have gone to the worker as request `id`, or before it.
    pub fn number(&mut self, id: u64) {
        self.parameters.values_mut().for_each(|one| one.number(id));
        self.is_playing.iter_mut().for_each(|one| one.number(id));
        self.speed.iter_mut().for_each(|one| one.number(id));
    }

    /// Forgets what the worker says itself by now.
    pub fn hear(&mut self, event: &Event) {
        match event {
            Event::Setup(setup) => self.parameters.retain(|_, one| !one.is_heard(setup.heeds)),
            Event::Frame(frame) => self.forget_clock(frame.heeds),
            Event::Failed { id, .. } => self.forget_clock(*id),
            _ => {}
        }
    }

    fn forget_clock(&mut self, heeds: u64) {
        self.is_playing.take_if(|one| one.is_heard(heeds));
        self.speed.take_if(|one| one.is_heard(heeds));
    }

    /// Text of a parameter.
    pub fn parameter(&self, name: &str) -> Option<&str> {
        self.parameters.get(name)?.value.as_deref()
    }

    /// True while the worker has yet to hear of a parameter's last change.
    pub fn is_underway(&self, name: &str) -> bool {
        self.parameters.contains_key(name)
    }

    /// True when the clock was asked to play, false to pause; `None` when the worker's own word holds.
    pub fn is_playing(&self) -> Option<bool> {
        self.is_playing.as_ref().map(|one| one.value)
    }

    /// Frames that the clock goes on by.
    pub fn speed(&self) -> Option<f64> {
        self.speed.as_ref().map(|one| one.value)
    }
}
