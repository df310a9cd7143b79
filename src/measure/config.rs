//! JSON values of a run's configuration and results, the same for all papers.

use serde_json::{Map, Value, json};

use crate::scene::{Camera, Light, Mesh};

/// Named values as the record has them.
pub fn entries<const N: usize>(entries: [(&str, Value); N]) -> Map<String, Value> {
    entries.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
}

/// Adds the triangles of objects beside the phenomenon, where there are any.
pub fn add_object_triangles(config: &mut Map<String, Value>, objects: &[Mesh]) {
    if !objects.is_empty() {
        let triangles: usize = objects.iter().map(Mesh::triangle_count).sum();
        config.insert("object_triangles".to_owned(), json!(triangles));
    }
}

/// A light: where it shines to or where it stands, and how bright it is.
pub fn light(light: &Light) -> Value {
    match light {
        Light::Parallel { direction, intensity } => {
            json!({"direction": direction.to_array(), "intensity": intensity.to_array()})
        }
        Light::Point { position, intensity } => {
            json!({"position": position.to_array(), "intensity": intensity.to_array()})
        }
    }
}

/// A camera, as its option names it: eye and target.
pub fn camera(camera: &Camera) -> Value {
    json!([camera.eye.to_array(), camera.target.to_array()])
}
