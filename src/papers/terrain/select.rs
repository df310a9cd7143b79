//! The pass `select` (section 4) of the variant `mesh-lod`, on the host: the patches of each map that the picture needs.

use std::sync::Arc;

use ash::vk;

use super::geometric_transformation::SceneView;
use super::ground::Ground;
use super::parameters::Parameters;
use super::quadtree::Quadtree;
use super::scene::{DeviceScene, Map};
use super::selection::{Patch, Selection, Viewer};
use super::stage::Build;
use crate::gpu::{Buffer, BufferDesc, Error, Frame, Location, PassInfo};

/// The pass, over all maps.
pub struct Select {
    info: Arc<PassInfo>,
    /// Of each map.
    pub maps: Vec<Selected>,
}

/// The patches of a map.
pub struct Selected {
    /// Those of the last frame.
    pub selection: Selection,
    /// A [`Patch`] each.
    pub patches: Arc<Buffer>,
}

impl Select {
    /// Measures the errors of all patches.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(build: &Build<'_>, grounds: &[Ground], scene: &DeviceScene) -> Result<Self, Error> {
        let Build { shaders, label, .. } = *build;
        let of_map = |(index, (ground, map)): (usize, (&Ground, &Map))| {
            let name = format!("{label}/map-{index}");
            let tree = Quadtree::new(shaders, &name, &map.levels, ground.base)?;
            let bytes = (tree.most() * size_of::<Patch>()) as u64;
            let desc = BufferDesc::new(format!("{name}/patches"), bytes).usage(vk::BufferUsageFlags::VERTEX_BUFFER);
            let patches = Buffer::new(shaders.device(), desc.location(Location::Upload))?;
            // A frame writes those that it draws alone; the rest is bound as well.
            patches.write(0, &vec![0; bytes as usize])?;
            Ok(Selected { selection: Selection::new(tree), patches })
        };
        let maps = grounds.iter().zip(&scene.maps).enumerate().map(of_map).collect::<Result<_, Error>>()?;
        Ok(Select { info: PassInfo::host("select", "4", &["camera", "bounds"], &["patches"]), maps })
    }

    /// Chooses the patches whose error is at most that of the parameters, in pixels.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(
        &mut self,
        frame: &mut Frame<'_>,
        grounds: &[Ground],
        view: &SceneView,
        parameters: &Parameters,
    ) -> Result<(), Error> {
        let Select { info, maps } = self;
        frame.host(info, || {
            maps.iter_mut().zip(grounds).try_for_each(|(Selected { selection, patches }, ground)| {
                let viewer = Viewer::new(ground, &view.rays, (parameters.width, parameters.height));
                selection.choose(&viewer, parameters.mesh_error_px.into());
                patches.write(0, bytemuck::cast_slice(&selection.patches))
            })
        })
    }
}
