//! Polygon objects in the picture of the terrain: their depth, their shadows and their colours.

use std::sync::Arc;

use super::geometric_transformation::SceneView;
use super::object_depth::ObjectDepth;
use super::object_hits::ObjectHits;
use super::object_occlusion::object_occlusion;
use super::object_shadow::object_shadow;
use super::objects::{ObjectMesh, Objects};
use super::scene::DeviceScene;
use super::shadow::all_lit;
use super::stage::{Build, PixelPass};
use crate::gpu::{DepthTest, Error, Frame, ImageView};
use crate::measure::Target;
use crate::papers::triangle_tree::DeviceTree;
use crate::scene::Mesh;

/// The passes of all objects.
pub struct ObjectPasses {
    meshes: Vec<ObjectMesh>,
    depth: ObjectDepth,
    /// None where nothing throws shadows.
    pub shadow: Option<ObjectShadows>,
    objects: Objects,
}

/// Hits of objects, and the sun's light that reaches them past the maps and past each other.
pub struct ObjectShadows {
    hits: ObjectHits,
    /// Past the maps.
    pub shadow: PixelPass,
    /// Past the objects, too.
    pub occlusion: PixelPass,
}

impl ObjectPasses {
    /// `casters` are the maps and the objects that throw shadows.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(
        build: &Build<'_>,
        meshes: &[Mesh],
        (depth, picture): (&Arc<ImageView>, &Arc<ImageView>),
        casters: Option<(&DeviceScene, &DeviceTree)>,
    ) -> Result<Self, Error> {
        let depth = ObjectDepth::new(build, depth)?;
        let meshes = meshes.iter().map(|mesh| ObjectMesh::new(build, mesh)).collect::<Result<Vec<_>, _>>()?;
        let shadow = casters.map(|(scene, tree)| -> Result<_, Error> {
            let hits = ObjectHits::new(build, &meshes, &depth)?;
            let shadow = object_shadow(build, scene, &hits)?;
            let occlusion = object_occlusion(build, tree, (&depth, &hits), &shadow)?;
            Ok(ObjectShadows { hits, shadow, occlusion })
        });
        let shadow = shadow.transpose()?;
        let (sunlit, test) = match &shadow {
            None => (all_lit(build, "/objects")?, DepthTest::GreaterWrite),
            Some(shadows) => (shadows.occlusion.target.clone(), DepthTest::EqualReadOnly),
        };
        let objects = Objects::new(build, &meshes, (&depth, test), &sunlit, picture)?;
        Ok(ObjectPasses { meshes, depth, shadow, objects })
    }

    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, view: &SceneView) -> Result<(), Error> {
        self.depth.record(frame, view)?;
        if let Some(ObjectShadows { hits, shadow, occlusion }) = &self.shadow {
            hits.record(frame, &self.meshes, view)?;
            shadow.record(frame)?;
            occlusion.record(frame)?;
        }
        self.objects.record(frame, &self.meshes, view)
    }

    pub fn targets(&self) -> Vec<Target> {
        let shadow = |ObjectShadows { hits, shadow, occlusion }: &ObjectShadows| {
            [
                Target::image("object-hits", &hits.target).of("depth along the view in metres, and what was met"),
                Target::image("object-shadow", &shadow.target).of("share of the sun that arrives, 0 to 1"),
                Target::image("object-occlusion", &occlusion.target)
                    .of("share of the sun that arrives past objects, 0 to 1"),
            ]
        };
        self.shadow.iter().flat_map(shadow).collect()
    }
}
