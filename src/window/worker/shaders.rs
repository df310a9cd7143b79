//! Shaders of both compilers, those of a folder compiled anew when one is saved.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use notify::{EventKind, RecommendedWatcher, RecursiveMode, Watcher};

use super::inbox::Inbox;
use crate::gpu::{Compiler, Device, ShaderLibrary};
use crate::measure::Error;
use crate::measure::machine::Machine;

/// Libraries that were replaced.
pub struct Libraries(Vec<(Compiler, Arc<ShaderLibrary>)>);

/// The libraries of the compilers that were asked for.
pub struct Shaders {
    device: Arc<Device>,
    folder: Option<PathBuf>,
    try_folder: fn(&Path) -> Result<(), Error>,
    made: Vec<(Compiler, Arc<ShaderLibrary>)>,
    /// Watches as long as it is there.
    _watcher: Option<RecommendedWatcher>,
    /// Why saving a shader does nothing.
    pub trouble: Option<String>,
}

impl Shaders {
    /// Watches the folder, and puts [`saved`](super::saved) into the inbox when a file in it changes. Before it is compiled anew it
    /// is tried.
    pub fn open(
        machine: &Machine,
        folder: Option<PathBuf>,
        try_folder: fn(&Path) -> Result<(), Error>,
        inbox: &Inbox,
    ) -> Self {
        let watching = folder.as_deref().map(|folder| watch(folder, inbox.clone()));
        let (watcher, trouble) = match watching {
            None => (None, None),
            Some(Ok(watcher)) => (Some(watcher), None),
            Some(Err(error)) => (None, Some(format!("watching the shaders: {error}; ask for a reload instead"))),
        };
        Shaders { device: machine.device.clone(), folder, try_folder, made: Vec::new(), _watcher: watcher, trouble }
    }

    /// The library of a compiler.
    ///
    /// # Errors
    /// With file and line for a shader of the folder that does not compile.
    pub fn of(&mut self, compiler: Compiler) -> Result<Arc<ShaderLibrary>, Error> {
        if let Some((_, library)) = self.made.iter().find(|(made, _)| *made == compiler) {
            return Ok(library.clone());
        }
        if !self.made.is_empty() {
            self.try_folder()?;
        }
        let library = Arc::new(ShaderLibrary::new(&self.device, compiler, self.folder.as_deref())?);
        self.made.push((compiler, library.clone()));
        Ok(library)
    }

    /// Tries the folder, which was tried when the worker was started.
    fn try_folder(&self) -> Result<(), Error> {
        self.folder.as_deref().map_or(Ok(()), self.try_folder)
    }

    /// Compiles the libraries anew, and gives the ones that they take the place of.
    ///
    /// # Errors
    /// As [`Shaders::of`]; the libraries are then as they were.
    pub fn reload(&mut self) -> Result<Libraries, Error> {
        self.try_folder()?;
        let compiled = |(compiler, _): &(Compiler, _)| {
            let library = ShaderLibrary::new(&self.device, *compiler, self.folder.as_deref())?;
            Ok::<_, Error>((*compiler, Arc::new(library)))
        };
        let made = self.made.iter().map(compiled).collect::<Result<_, _>>()?;
        Ok(Libraries(std::mem::replace(&mut self.made, made)))
    }

    /// Puts libraries back that others took the place of.
    pub fn restore(&mut self, libraries: Libraries) {
        self.made = libraries.0;
    }
}

fn watch(folder: &Path, inbox: Inbox) -> notify::Result<RecommendedWatcher> {
    let mut watcher = notify::recommended_watcher(move |event: notify::Result<notify::Event>| {
        // Looking at a file is an event too.
        if event.is_ok_and(|event| !matches!(event.kind, EventKind::Access(_))) {
            inbox.push(super::saved());
        }
    })?;
    watcher.watch(folder, RecursiveMode::Recursive)?;
    Ok(watcher)
}
