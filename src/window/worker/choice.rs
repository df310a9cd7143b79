//! The choice that is set: a preset, the values set by hand over it, and the sides.

use std::ffi::{OsStr, OsString};

use crate::gpu::Compiler;
use crate::measure::parameter::{self, Given, Parameter};
use crate::measure::study::{Preset, Study, check_one};
use crate::measure::{Error, Variant};
use crate::scene::Camera;
use crate::window::protocol::{Assignment, Lens, SideChoice, SideSetup};

/// A value set by hand.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Typed {
    /// Name of the parameter.
    pub name: String,
    /// As it was typed: of a flag `true` or `false`.
    pub values: Vec<OsString>,
}

/// Everything that is set, before it is resolved.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Choice {
    /// Preset of the whole.
    pub preset: Option<String>,
    /// Values set by hand, each parameter once.
    pub typed: Vec<Typed>,
    /// One side or two.
    pub sides: Vec<SideChoice>,
}

/// A side, resolved.
#[derive(Clone)]
pub struct Resolved<S: Study> {
    /// The set-up.
    pub study: S,
    /// Variant of the paper.
    pub variant: S::Variant,
    /// Whose binaries it runs.
    pub compiler: Compiler,
    /// Preset of the side.
    pub preset: Option<String>,
}

impl Choice {
    /// Sets or takes back a value. Parameters that must not be given beside it are taken back.
    ///
    /// # Errors
    /// For a name or a value that is none.
    pub fn set<S: Study>(&mut self, assignment: &Assignment) -> Result<(), Error> {
        let parameters = S::parameters();
        let name = &assignment.name;
        let Some(parameter) = parameters.iter().find(|parameter| parameter.name == *name) else {
            return Err(Error::Input(format!("{} has no parameter {name}", S::PAPER)));
        };
        self.typed.retain(|typed| typed.name != *name);
        if assignment.values.is_empty() {
            return Ok(());
        }
        let values: Vec<OsString> = assignment.values.iter().map(OsString::from).collect();
        let texts: Vec<&OsStr> = values.iter().map(OsString::as_os_str).collect();
        parameter.parser()(&texts).map_err(|reason| Error::Input(format!("`{name}`: {reason}")))?;
        let excludes = |a: &Parameter<S>, b: &str| a.excludes.contains(&b);
        let is_excluded = |other: &str| {
            let other = parameters.iter().find(|parameter| parameter.name == other);
            other.is_some_and(|other| excludes(parameter, other.name) || excludes(other, parameter.name))
        };
        self.typed.retain(|typed| !is_excluded(&typed.name));
        self.typed.push(Typed { name: name.clone(), values });
        Ok(())
    }

    /// Every side with its set-up.
    ///
    /// # Errors
    /// The first that cannot be.
    pub fn resolve<S: Study>(&self) -> Result<Vec<Resolved<S>>, Error> {
        self.sides.iter().map(|side| self.resolve_side(side)).collect()
    }

    fn resolve_side<S: Study>(&self, side: &SideChoice) -> Result<Resolved<S>, Error> {
        let name = side.preset.as_ref().or(self.preset.as_ref());
        let preset = name.map(|name| preset::<S>(name)).transpose()?;
        let mut study = preset.as_ref().map_or_else(S::default, Preset::setup);
        let parameters = S::parameters();
        for parameter in &parameters {
            let Some(typed) = self.typed.iter().find(|typed| typed.name == parameter.name) else { continue };
            let texts: Vec<&OsStr> = typed.values.iter().map(OsString::as_os_str).collect();
            let set = parameter.set(&mut study, &texts);
            set.map_err(|reason| Error::Input(format!("`{}`: {reason}", parameter.name)))?;
        }
        study.resolve(&self.given())?;
        parameter::check(&parameters, &study)?;
        check_one(&study)?;
        let named = side.variant.as_ref().map(|name| variant::<S>(name)).transpose()?;
        let variant = named.unwrap_or_else(|| study.rendered(preset.and_then(|preset| preset.variant)));
        let compiler = match side.compiler.as_deref() {
            None | Some("glslang") => Compiler::Glslang,
            Some("naga") => Compiler::Naga,
            Some(other) => return Err(Error::Input(format!("{other:?} is neither glslang nor naga"))),
        };
        Ok(Resolved { study, variant, compiler, preset: name.cloned() })
    }

    /// Names of the values set by hand.
    pub fn given(&self) -> Given {
        self.typed.iter().map(|typed| typed.name.clone()).collect()
    }
}

fn preset<S: Study>(name: &str) -> Result<Preset<S>, Error> {
    let found = S::presets().into_iter().find(|preset| preset.name == name);
    found.ok_or_else(|| Error::Input(format!("{} has no preset {name}", S::PAPER)))
}

fn variant<S: Study>(name: &str) -> Result<S::Variant, Error> {
    let found = S::Variant::ALL.iter().copied().find(|variant| variant.as_str() == name);
    found.ok_or_else(|| Error::Input(format!("{} has no variant {name}", S::PAPER)))
}

impl<S: Study> Resolved<S> {
    /// Text of every parameter, in the order of their declaration.
    pub fn values(&self) -> Vec<String> {
        S::parameters().iter().map(|parameter| parameter.text(&self.study)).collect()
    }

    /// As the window has it.
    pub fn describe(&self, choice: &Choice, camera: Option<Camera>) -> SideSetup {
        SideSetup {
            choice: SideChoice {
                variant: Some(self.variant.as_str().to_owned()),
                compiler: Some(self.compiler.to_string()),
                preset: self.preset.clone(),
            },
            values: self.values(),
            set: choice.typed.iter().map(|typed| typed.name.clone()).collect(),
            camera: camera.map(|camera| {
                let [eye, target] = [camera.eye, camera.target].map(|point| point.as_dvec3());
                [eye.x, eye.y, eye.z, target.x, target.y, target.z]
            }),
            lens: camera.map(|camera| Lens {
                up: camera.up.as_dvec3().to_array(),
                vertical_fov_rad: camera.vertical_fov_rad.into(),
                near: camera.near_m.into(),
                far: camera.far_m.into(),
            }),
        }
    }
}
