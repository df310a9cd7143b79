//! `terrain`: S. I. Vyatkin's terrain from a shape texture, ray-cast without triangles.
//!
//! ```text
//! geometric-transformation (host) (─► start) ─► depth ─► normal (─► shadow (─► occlusion)) ─► illumination
//!                                  (─► object-depth (─► object-hits ─► object-shadow ─► object-occlusion) ─► objects)
//! geometric-transformation (host) ─► base ─► mesh ─► normal (─► shadow (─► occlusion)) ─► illumination (...)   (mesh)
//! geometric-transformation (host) ─► base ─► select (host) ─► mesh-lod ─► normal ...                           (mesh-lod)
//! ```

mod axes;
mod base;
mod blocks;
mod collision;
mod curve;
mod depth;
mod drape;
mod drape_source;
mod estimate;
pub mod experiments;
mod geodesy;
mod geometric_transformation;
mod ground;
mod height_field;
mod hit;
mod host;
mod illumination;
mod interpolation;
#[cfg(test)]
mod layouts;
mod levels;
mod mesh;
mod mesh_lod;
mod nearest;
mod normal;
mod object_depth;
mod object_hits;
mod object_occlusion;
mod object_passes;
mod object_shadow;
mod object_source;
mod objects;
mod occlusion;
mod packed;
mod page_table;
mod parameters;
mod placement;
mod pyramid;
mod quadtree;
mod ray_caster;
mod ray_segment;
pub mod reference;
mod scene;
mod select;
mod selection;
pub mod setup;
mod shadow;
mod show;
mod solid;
mod stage;
mod start;
mod streaming;
mod tile_file;
mod tile_writer;
mod tiles;
mod tints;
mod unfinished;
mod view;
mod voids;
mod walk;
mod warnings;

use std::sync::Arc;

use self::base::BasePass;
pub use self::collision::{Collider, Contact};
use self::depth::{DeviceDepth, HostDepth};
pub use self::drape::{Drape, Draping};
pub use self::drape_source::DrapeSource;
use self::geometric_transformation::GeometricTransformation;
pub use self::ground::{Ground, Origin};
use self::height_field::HeightField;
pub use self::hit::{Hit, NO_DEPTH, Surface};
use self::illumination::{HostIllumination, illumination};
pub use self::levels::Levels;
pub use self::mesh::MESH_SIDE;
use self::mesh::Mesh;
use self::mesh_lod::MeshLod;
use self::normal::{HostNormal, normal};
use self::object_passes::ObjectPasses;
pub use self::object_source::{ObjectSource, Stand};
use self::occlusion::{HostOcclusion, occlusion};
pub use self::parameters::{Base, Corners, Interpolation, Lod, Normals, Parameters, Start, Sun, Variant, View};
pub use self::placement::{Extent, Placement, Rays};
pub use self::pyramid::{Bound, Cover, Pyramid, Shape, Texel};
pub use self::quadtree::{Bounds, PATCH_SIDE, PatchLevel, Quadtree};
use self::scene::{DeviceScene, Scene};
pub use self::scene::{Inputs, MapInput};
pub use self::selection::{Patch, Selection, Viewer};
use self::shadow::{HostShadow, all_lit, shadow};
use self::show::Show;
use self::stage::{Build, PixelPass, Stage, Traversal};
use self::start::Starts;
pub use self::tile_file::{TileFile, read_head as read_tile_file};
pub use self::tiles::TileCounts;
use self::tiles::Tiles;
pub use self::voids::void_warnings;
use crate::gpu::{Error, Feature, Frame, ImageView, Mode, Recorder, ShaderLibrary};
use crate::measure::parameter::Given;
use crate::measure::{Paper, Target};
use crate::papers::triangle_tree::{DeviceTree, TriangleTree};
use crate::scene::Camera;

/// The features that this paper needs of a device, beyond the baseline of the Vulkan layer.
pub const NEEDS: [Feature; 0] = [];

/// Parameters that each frame writes into its blocks.
pub const WRITTEN: [&str; 5] = ["camera", "haze", "mesh-error", "normals", "sun"];

/// The paper under one variant.
pub struct Terrain {
    parameters: Parameters,
    variant: Variant,
    /// Names of the parameters that a user gave.
    given: Given,
    scene: Scene,
    geometric_transformation: GeometricTransformation,
    /// The maps on the device, where a pass reads them there.
    device_scene: Option<DeviceScene>,
    technique: Technique,
    objects: Option<ObjectPasses>,
    corners: Option<Corners>,
    /// Lines on objects that lie beside the maps.
    strays: Vec<String>,
}

/// The passes that make the picture of the terrain.
enum Technique {
    Cpu(HostPasses),
    RayCast(Starts, DeviceDepth, Shading),
    Mesh(BasePass, Triangles, Shading),
}

/// The triangles of the maps.
enum Triangles {
    All(Mesh),
    Selected(MeshLod),
}

/// Everything on the processor.
struct HostPasses {
    maps: Vec<HeightField>,
    depth: HostDepth,
    normal: HostNormal,
    shadow: Option<HostShadow>,
    /// With objects that throw shadows.
    occlusion: Option<HostOcclusion>,
    illumination: HostIllumination,
    show: Show,
}

/// The passes that follow the depth on the device.
struct Shading {
    depth: Arc<ImageView>,
    normal: PixelPass,
    shadow: Option<PixelPass>,
    /// With objects that throw shadows.
    occlusion: Option<PixelPass>,
    illumination: PixelPass,
}

impl Terrain {
    /// Makes every resource and pass, and the maps' pyramids; `label` goes before the names of the resources.
    ///
    /// # Errors
    /// [`Error::Limit`] for too many maps and for a map that the device or the variant cannot hold, errors of the Vulkan layer.
    /// The caller has validated `parameters`, and there is a map.
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
        let (stage, traversal) = match variant {
            Variant::GpuCompute => (Stage::Compute, Traversal::Halving),
            Variant::DdaCompute => (Stage::Compute, Traversal::Cells),
            Variant::DdaFragment | Variant::DdaCpu => (Stage::Fragment, Traversal::Cells),
            Variant::TiledCompute => (Stage::Compute, Traversal::Tiles),
            Variant::Cpu | Variant::GpuFragment | Variant::Mesh | Variant::MeshLod => {
                (Stage::Fragment, Traversal::Halving)
            }
        };
        let scene = Scene::new(parameters, inputs);
        let strays = warnings::off_the_maps(inputs.objects, &scene.extent);
        scene.check_tiles(label, variant)?;
        let walks = matches!(variant, Variant::DdaCompute | Variant::DdaFragment);
        let is_packed = walks && packed::is_packed(shaders.device(), parameters, scene.height_maps());
        let build = Build { shaders, label, parameters, stage, traversal, is_packed };
        let on_device = |drape| DeviceScene::new(&build, &scene, drape);
        let casts = parameters.shadows && !inputs.objects.is_empty();
        let tree = casts.then(|| TriangleTree::over(inputs.objects));
        let device_tree = tree.as_ref().map(|tree| DeviceTree::new(shaders.device(), label, tree)).transpose()?;
        let (device_scene, technique) = match variant {
            Variant::Cpu | Variant::DdaCpu => {
                let host = HostPasses::new(&build, &scene, inputs.drape, tree)?;
                (casts.then(|| on_device(None)).transpose()?, Technique::Cpu(host))
            }
            Variant::GpuCompute
            | Variant::GpuFragment
            | Variant::DdaCompute
            | Variant::DdaFragment
            | Variant::TiledCompute => {
                let maps = on_device(inputs.drape)?;
                let starts = Starts::new(&build, &maps)?;
                let depth = DeviceDepth::new(&build, &maps, &starts)?;
                let shading = Shading::new(&build, &maps, depth.target(), device_tree.as_ref())?;
                (Some(maps), Technique::RayCast(starts, depth, shading))
            }
            Variant::Mesh | Variant::MeshLod => {
                let maps = on_device(inputs.drape)?;
                let base = BasePass::new(&build, &maps)?;
                let mesh = match variant {
                    Variant::MeshLod => Triangles::Selected(MeshLod::new(&build, &scene.grounds, &maps, &base)?),
                    _ => Triangles::All(Mesh::new(&build, &scene.grounds, &maps, &base)?),
                };
                let shading = Shading::new(&build, &maps, &base.target, device_tree.as_ref())?;
                (Some(maps), Technique::Mesh(base, mesh, shading))
            }
        };
        let mut terrain = Terrain {
            parameters: parameters.clone(),
            variant,
            given: Given::default(),
            scene,
            geometric_transformation: GeometricTransformation::new(
                traversal.footprint(parameters.interpolation),
                variant == Variant::MeshLod,
            ),
            device_scene,
            technique,
            objects: None,
            corners: walks.then_some(if is_packed { Corners::Packed } else { Corners::Image }),
            strays,
        };
        if !inputs.objects.is_empty() {
            let casters = terrain.device_scene.as_ref().zip(device_tree.as_ref());
            let build = Build { stage: Stage::Fragment, ..build };
            let (depth, picture) = (terrain.depth(), terrain.picture());
            terrain.objects = Some(ObjectPasses::new(&build, inputs.objects, (depth, picture), casters)?);
        }
        Ok(terrain)
    }

    /// The same, of parameters of which a user gave those: what the variant does not heed of them is warned of.
    pub fn given(mut self, given: Given) -> Self {
        self.given = given;
        self
    }

    /// Sets the numbers of [`WRITTEN`] of the next frames; all others are those that it was made with. The caller has
    /// validated them.
    pub fn set_written(&mut self, parameters: &Parameters) {
        self.parameters = parameters.clone();
    }

    /// Sets the view of the next frames. The caller has validated it.
    pub fn set_view(&mut self, view: View) {
        self.parameters.view = view;
    }

    /// Extinction by haze, as it was set or as it suits the maps.
    pub fn extinction_per_km(&self) -> f32 {
        self.parameters.extinction_per_km(&self.scene.extent)
    }

    /// A [`Hit`] of each pixel, on the device.
    fn depth(&self) -> &Arc<ImageView> {
        match &self.technique {
            Technique::Cpu(host) => &host.show.depth,
            Technique::RayCast(_, _, shading) | Technique::Mesh(_, _, shading) => &shading.depth,
        }
    }

    /// Patches of triangles that the last frame drew, by level from the maps' own cells on; of [`Variant::MeshLod`].
    pub fn patches(&self) -> Option<Vec<u64>> {
        match &self.technique {
            Technique::Mesh(_, Triangles::Selected(mesh), _) => Some(mesh.by_level()),
            _ => None,
        }
    }

    /// The images that rays read of a cell; of [`Variant::DdaCompute`] and [`Variant::DdaFragment`].
    pub fn corners(&self) -> Option<Corners> {
        self.corners
    }

    /// The tiles of all maps; of [`Variant::TiledCompute`].
    pub fn tiles(&self) -> Option<TileCounts> {
        self.tiles_by_map().reduce(TileCounts::and)
    }

    fn tiles_by_map(&self) -> impl Iterator<Item = TileCounts> {
        let maps = self.device_scene.iter().flat_map(|scene| &scene.maps);
        maps.filter_map(|map| map.levels.tiles.as_ref()).map(Tiles::counts)
    }

    /// Draws once more to learn which tiles that reads, and copies to the device what it lacks of them; true where that is
    /// nothing.
    fn exchange_tiles(&mut self, shaders: &ShaderLibrary) -> Result<bool, Error> {
        if self.tiles().is_none() {
            return Ok(true);
        }
        self.set_marking(true);
        let drawn =
            Recorder::new(shaders.device())?.run(Mode::Plain, |frame| self.record_passes(frame, false)).map(drop);
        self.set_marking(false);
        drawn?;
        let maps = self.device_scene.iter_mut().flat_map(|scene| &mut scene.maps);
        let tiles = maps.filter_map(|map| map.levels.tiles.as_mut());
        tiles.map(Tiles::exchange).try_fold(true, |all, one| Ok(all & one?))
    }

    fn set_marking(&mut self, marks_tiles: bool) {
        self.device_scene.iter_mut().for_each(|scene| scene.marks_tiles = marks_tiles);
    }

    fn record_passes(&mut self, frame: &mut Frame<'_>, shows: bool) -> Result<(), Error> {
        let Terrain { geometric_transformation, scene, parameters, device_scene, .. } = self;
        let view = geometric_transformation.record(frame, scene, parameters, device_scene.as_ref())?;
        match &mut self.technique {
            Technique::Cpu(host) => {
                let maps = (&host.maps[..], &view);
                let hits = host.depth.record(frame, maps);
                let normals = host.normal.record(frame, maps, hits);
                let mut sunlit = host.shadow.as_mut().map_or(&[][..], |shadow| shadow.record(frame, maps, hits));
                if let Some(occlusion) = &mut host.occlusion {
                    sunlit = occlusion.record(frame, &view, (hits, sunlit));
                }
                let colors = host.illumination.record(frame, &view, (hits, normals, sunlit));
                // Polygons are drawn by the device, so the processor's picture has to be there first.
                if shows || self.objects.is_some() {
                    host.show.record(frame, (hits, normals, colors))?;
                }
            }
            Technique::RayCast(starts, depth, shading) => {
                starts.record(frame)?;
                depth.record(frame)?;
                shading.record(frame)?;
            }
            Technique::Mesh(base, mesh, shading) => {
                base.record(frame)?;
                match mesh {
                    Triangles::All(mesh) => mesh.record(frame, &self.scene.grounds, &view)?,
                    Triangles::Selected(mesh) => mesh.record(frame, &self.scene.grounds, &view, &self.parameters)?,
                }
                shading.record(frame)?;
            }
        }
        self.objects.as_ref().map_or(Ok(()), |objects| objects.record(frame, &view))
    }
}

impl HostPasses {
    /// `tree` has the objects that throw shadows.
    fn new(build: &Build<'_>, scene: &Scene, drape: Option<&Drape>, tree: Option<TriangleTree>) -> Result<Self, Error> {
        let parameters = build.parameters;
        let cover = build.cover();
        Ok(HostPasses {
            show: Show::new(build)?,
            maps: scene.maps.iter().map(|map| HeightField::new(map, parameters.interpolation, cover)).collect(),
            depth: HostDepth::new(parameters),
            normal: HostNormal::new(parameters),
            shadow: parameters.shadows.then(|| HostShadow::new(parameters)),
            occlusion: tree.map(|tree| HostOcclusion::new(parameters, tree)),
            illumination: HostIllumination::new(parameters, drape),
        })
    }
}

impl Shading {
    /// `tree` has the objects that throw shadows.
    fn new(
        build: &Build<'_>,
        scene: &DeviceScene,
        depth: &Arc<ImageView>,
        tree: Option<&DeviceTree>,
    ) -> Result<Self, Error> {
        let normal = normal(build, scene, depth)?;
        let shadow = build.parameters.shadows.then(|| shadow(build, "shadow", scene, depth)).transpose()?;
        let of_maps = shadow.as_ref().map_or_else(|| all_lit(build, ""), |shadow| Ok(shadow.target.clone()))?;
        let occlusion = tree.map(|tree| occlusion(build, "occlusion", (&scene.light, tree), [depth, &of_maps]));
        let occlusion = occlusion.transpose()?;
        let sunlit = occlusion.as_ref().map_or(&of_maps, |occlusion| &occlusion.target);
        let illumination = illumination(build, scene, [depth, &normal.target, sunlit])?;
        Ok(Shading { depth: depth.clone(), normal, shadow, occlusion, illumination })
    }

    fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        self.normal.record(frame)?;
        [&self.shadow, &self.occlusion].into_iter().flatten().try_for_each(|pass| pass.record(frame))?;
        self.illumination.record(frame)
    }

    fn targets(&self) -> Vec<Target> {
        let mut targets = vec![
            Target::image("depth", &self.depth)
                .of("depth along the view in metres, place on the map in two coordinates, code of the surface"),
            Target::image("normal", &self.normal.target)
                .of("x, y, z of the unit normal, height above the base in metres"),
        ];
        targets.extend(
            self.shadow
                .as_ref()
                .map(|shadow| Target::image("shadow", &shadow.target).of("share of the sun that arrives, 0 to 1")),
        );
        targets.extend(self.occlusion.as_ref().map(|occlusion| {
            Target::image("occlusion", &occlusion.target).of("share of the sun that arrives past objects, 0 to 1")
        }));
        targets
    }
}

impl Paper for Terrain {
    fn record(&mut self, frame: &mut Frame<'_>, _number: u32) -> Result<(), Error> {
        self.record_passes(frame, false)
    }

    /// Brings the tiles that the frames lacked, and fails where the driver left a ray before its end.
    fn settle(&mut self, shaders: &ShaderLibrary) -> Result<bool, Error> {
        if !self.exchange_tiles(shaders)? {
            return Ok(false);
        }
        self.check_rays(shaders.device()).map(|()| true)
    }

    fn record_picture(&mut self, frame: &mut Frame<'_>, _number: u32) -> Result<(), Error> {
        self.record_passes(frame, true)
    }

    fn warnings(&self) -> Vec<String> {
        let haze = self.parameters.haze_warning(&self.scene.extent);
        let memory_mib = self.parameters.tile_memory_mib;
        let count = self.scene.grounds.len();
        let lacking =
            (1..).zip(self.tiles_by_map()).flat_map(|(number, counts)| counts.warnings(memory_mib, (number, count)));
        let winding =
            (1..).zip(&self.scene.grounds).filter_map(|(number, ground)| ground.winding_warning(number, count));
        let voids = void_warnings(self.scene.height_maps());
        let wants_packed =
            self.parameters.corners == Corners::Auto && self.parameters.interpolation == Interpolation::Bilinear;
        let unpacked =
            (wants_packed && self.corners == Some(Corners::Image)).then(|| packed::no_room(self.scene.height_maps()));
        let unread = (self.parameters.corners == Corners::Packed && self.corners == Some(Corners::Image)).then(|| {
            "`corners` packed is of bilinear cells alone: rays over bicubic terrain read the image of the levels"
                .to_owned()
        });
        let unheeded = warnings::unheeded(&self.parameters, &self.given, self.variant);
        let drowned = warnings::drowned(self.scene.base_level_m, self.scene.range_m);
        let of_variant =
            unpacked.into_iter().chain(drowned).chain(unread).chain(unheeded).chain(self.strays.iter().cloned());
        voids.into_iter().chain(winding).chain(haze).chain(lacking).chain(of_variant).collect()
    }

    fn camera(&self) -> Option<Camera> {
        Some(self.parameters.camera(&self.scene.extent))
    }

    fn picture(&self) -> &Arc<ImageView> {
        match &self.technique {
            Technique::Cpu(host) => &host.show.picture,
            Technique::RayCast(_, _, shading) | Technique::Mesh(_, _, shading) => &shading.illumination.target,
        }
    }

    fn targets(&self) -> Vec<Target> {
        let mut targets = match &self.technique {
            Technique::Cpu(host) => host.show.targets(),
            Technique::RayCast(starts, _, shading) => starts.target().into_iter().chain(shading.targets()).collect(),
            Technique::Mesh(_, _, shading) => shading.targets(),
        };
        targets.extend(self.objects.iter().flat_map(ObjectPasses::targets));
        targets.push(
            Target::image("picture", self.picture()).of("red, green, blue, alpha as sRGB encodes them, 0 to 255"),
        );
        targets
    }
}
