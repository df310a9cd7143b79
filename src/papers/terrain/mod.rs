//! `terrain`: S. I. Vyatkin's terrain from a shape texture, ray-cast without triangles.
//!
//! ```text
//! geometric-transformation (host) ─► depth ─► normal (─► shadow) ─► illumination
//!                                                    (─► object-depth (─► object-hits ─► object-shadow) ─► objects)
//! geometric-transformation (host) ─► base ─► mesh ─► normal (─► shadow) ─► illumination (...)   (mesh)
//! ```

mod blocks;
mod caster;
mod collision;
mod cpu;
mod curve;
mod drape;
pub mod experiments;
mod ground;
mod hit;
mod interpolation;
#[cfg(test)]
mod layouts;
mod levels;
mod lighting;
mod mesh;
mod nearest;
mod objects;
mod parameters;

mod placement;
mod pyramid;
mod ray_cast;
pub mod reference;
mod relief;
mod scene;
pub mod setup;
mod shading;
mod shadows;
mod solid;
mod stage;

mod way;

use std::sync::Arc;

pub use self::collision::{Collider, Contact, Touch};
use self::cpu::Cpu;
pub use self::drape::Drape;
pub use self::ground::{Ground, Origin};
pub use self::hit::{Hit, NO_DEPTH, Surface};
pub use self::levels::Levels;
use self::lighting::Lighting;
pub use self::mesh::MESH_SIDE;
use self::mesh::Mesh;
use self::objects::Objects;
pub use self::parameters::{Base, Interpolation, Lod, Parameters, Sun, Variant, View};
pub use self::placement::{Extent, Placement, Rays};
pub use self::pyramid::{Bound, Pyramid, Shape, Texel};
use self::ray_cast::RayCast;
use self::scene::{DeviceScene, Scene};
pub use self::scene::{Inputs, MapInput};
use self::stage::Stage;
use crate::gpu::{Error, Feature, Frame, ImageView, PassInfo, ShaderLibrary};
use crate::measure::{Paper, Target};
use crate::scene::HeightMap;

/// What a device must have for this paper, beyond the baseline of the Vulkan layer.
pub const NEEDS: [Feature; 0] = [];

/// The paper under one variant.
pub struct Terrain {
    parameters: Parameters,
    scene: Scene,
    transformation: Arc<PassInfo>,
    technique: Technique,
    objects: Option<Objects>,
}

enum Technique {
    /// With the maps on the device where those throw shadows on objects, which the device draws.
    Cpu(Cpu, Option<DeviceScene>),
    Device(DeviceScene, DepthMethod, Lighting),
}

/// How the device finds what a pixel sees.
enum DepthMethod {
    RayCast(RayCast),
    Mesh(Mesh),
}

impl Terrain {
    /// Makes every resource and pass, and the maps' pyramids; `label` goes before the names of the resources.
    ///
    /// # Errors
    /// [`Error::Limit`] for too many maps and for a map that the device or the variant cannot hold, what the Vulkan layer
    /// answers. The caller has validated `parameters`, and there is a map.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        variant: Variant,
        parameters: &Parameters,
        inputs: &Inputs<'_>,
    ) -> Result<Self, Error> {
        if inputs.maps.len() > Inputs::MAPS {
            return Err(Error::Limit {
                object: format!("{label}/maps"),
                what: "number of maps",
                wanted: inputs.maps.len() as u64,
                limit: Inputs::MAPS as u64,
            });
        }
        let scene = Scene::new(parameters, inputs);
        let technique = match variant {
            Variant::Cpu => {
                let cpu = Cpu::new(shaders, label, parameters, &scene.maps, inputs.drape)?;
                let shades_objects = parameters.shadows && !inputs.objects.is_empty();
                let device_scene =
                    shades_objects.then(|| DeviceScene::new(shaders, label, parameters, &scene.maps, None));
                Technique::Cpu(cpu, device_scene.transpose()?)
            }
            Variant::GpuCompute | Variant::GpuFragment => {
                let stage = if variant == Variant::GpuCompute { Stage::Compute } else { Stage::Fragment };
                let device_scene = DeviceScene::new(shaders, label, parameters, &scene.maps, inputs.drape)?;
                let ray_cast = RayCast::new(shaders, label, stage, parameters, &device_scene)?;
                let lighting = Lighting::new(shaders, label, stage, parameters, &device_scene, &ray_cast.depth)?;
                Technique::Device(device_scene, DepthMethod::RayCast(ray_cast), lighting)
            }
            Variant::Mesh => {
                let device_scene = DeviceScene::new(shaders, label, parameters, &scene.maps, inputs.drape)?;
                let mesh = Mesh::new(shaders, label, parameters, &scene.grounds, &device_scene)?;
                let lighting = Lighting::new(shaders, label, Stage::Fragment, parameters, &device_scene, &mesh.depth)?;
                Technique::Device(device_scene, DepthMethod::Mesh(mesh), lighting)
            }
        };
        let (depth, picture, device_scene) = match &technique {
            Technique::Cpu(cpu, device_scene) => (cpu.depth(), cpu.picture(), device_scene.as_ref()),
            Technique::Device(device_scene, _, lighting) => (lighting.depth(), &lighting.picture, Some(device_scene)),
        };
        let objects = match inputs.objects {
            [] => None,
            meshes => {
                let maps = device_scene.filter(|_| parameters.shadows);
                Some(Objects::new(shaders, label, parameters, meshes, (depth, picture), maps)?)
            }
        };
        let reads = ["camera", "placement"];
        let transformation = PassInfo::host("geometric-transformation", "3, eq. 10", &reads, &["land", "light"]);
        Ok(Terrain { parameters: parameters.clone(), scene, transformation, technique, objects })
    }

    /// Sees the next frames from elsewhere. The caller has validated the view.
    pub fn look(&mut self, view: View) {
        self.parameters.view = view;
    }
}

impl Paper for Terrain {
    fn record(&mut self, frame: &mut Frame<'_>, _number: u32) -> Result<(), Error> {
        let (scene, parameters) = (&self.scene, &self.parameters);
        match &mut self.technique {
            Technique::Cpu(cpu, device_scene) => {
                let seen = frame.host(&self.transformation, || {
                    let seen = scene.transform(parameters);
                    device_scene.as_ref().map_or(Ok(()), |maps| maps.write(&seen)).map(|()| seen)
                })?;
                cpu.record(frame, &seen);
                // Polygons are drawn by the device, so the processor's picture has to be there first.
                if let Some(objects) = &self.objects {
                    cpu.show(frame)?;
                    objects.record(frame, &seen)?;
                }
                Ok(())
            }
            Technique::Device(device_scene, method, lighting) => {
                let seen = frame.host(&self.transformation, || {
                    let seen = scene.transform(parameters);
                    device_scene.write(&seen).map(|()| seen)
                })?;
                match method {
                    DepthMethod::RayCast(ray_cast) => ray_cast.record(frame)?,
                    DepthMethod::Mesh(mesh) => mesh.record(frame, &scene.grounds, &seen)?,
                }
                lighting.record(frame)?;
                self.objects.as_ref().map_or(Ok(()), |objects| objects.record(frame, &seen))
            }
        }
    }

    fn record_picture(&mut self, frame: &mut Frame<'_>, number: u32) -> Result<(), Error> {
        self.record(frame, number)?;
        match &self.technique {
            Technique::Cpu(cpu, _) if self.objects.is_none() => cpu.show(frame),
            _ => Ok(()),
        }
    }

    fn warnings(&self) -> Vec<String> {
        let maps = (1..).zip(&self.scene.maps).filter(|(_, map)| map.voids_filled() > 0);
        let of = self.scene.maps.len();
        let warning = |(number, map): (usize, &Arc<HeightMap>)| {
            let voids = map.voids_filled();
            format!("--map {number} of {of}: voids are filled from their neighbours: {voids}")
        };
        maps.map(warning).collect()
    }

    fn picture(&self) -> &Arc<ImageView> {
        match &self.technique {
            Technique::Cpu(cpu, _) => cpu.picture(),
            Technique::Device(_, _, lighting) => &lighting.picture,
        }
    }

    fn targets(&self) -> Vec<Target> {
        let mut targets = match &self.technique {
            Technique::Cpu(cpu, _) => cpu.targets(),
            Technique::Device(_, _, lighting) => lighting.targets(),
        };
        if let Some(objects) = &self.objects {
            targets.extend(objects.targets());
        }
        targets.push(Target::image("picture", self.picture()));
        targets
    }
}
