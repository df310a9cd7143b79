// The square of a particle, as the fragment stages of `draw-fire` see it. It is tested against the mesh's depth here and
// fades out where it comes near, so that no square shows where it cuts the surface. Colours are premultiplied.

#include "burning/billboards.glsl"

layout(set = 0, binding = 45) uniform texture2D mesh_depth;

layout(location = 0) noperspective in vec2 square_coordinates; // -1 to 1
layout(location = 1) flat in float eye_depth; // distance along the view, diagonals
layout(location = 2) flat in float age_fraction; // of its life
layout(location = 3) flat in float own_random; // 0 to 1

layout(location = 0) out vec4 shaded;

// Of the square before the mesh at this pixel of the layer, diagonals.
float before_mesh(ivec2 pixel) {
    return eye_distance(texelFetch(mesh_depth, layer_pixel(pixel), 0).x) - eye_depth;
}

// The share of it that shows at that distance.
float softness(float distance_before) {
    return clamp(distance_before / billboards.particle_radius, 0.0, 1.0);
}
