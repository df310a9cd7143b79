#version 450

// One illumination volume as a closed prism (section 3.2): the water triangle, its three sides along the refracted rays, and a bottom
// below every receiver. 24 vertices a volume, eight triangles, all facing outwards.

#include "caustics/volume.glsl"

layout(location = 0) flat out uint volume;

void main() {
    volume = uint(gl_VertexIndex) / 24u;
    uint vertex = uint(gl_VertexIndex) % 24u;
    uint corner = vertex;
    bool is_bottom = false;
    if (vertex >= 3u && vertex < 6u) {
        corner = (6u - vertex) % 3u;
        is_bottom = true;
    } else if (vertex >= 6u) {
        uint a = (vertex - 6u) / 6u;
        uint b = (a + 1u) % 3u;
        uint place = (vertex - 6u) % 6u;
        // A side is no plane; neighbours must cut it along the same diagonal, so the order of the water's vertices decides.
        bool from_a = water_vertex(volume, a) < water_vertex(volume, b);
        // Corners of the two triangles: b a b' and a a' b', or b a a' and b a' b', where ' is the bottom.
        if (from_a) {
            corner = place == 1u || place == 3u || place == 4u ? a : b;
            is_bottom = place == 2u || place >= 4u;
        } else {
            corner = place == 1u || place == 2u || place == 4u ? a : b;
            is_bottom = place == 2u || place >= 4u;
        }
    }
    bool is_lit = rays.list[water_vertex(volume, 0u)].origin.w > 0.0 && rays.list[water_vertex(volume, 1u)].origin.w > 0.0
        && rays.list[water_vertex(volume, 2u)].origin.w > 0.0;
    if (!is_lit) {
        // No area, no fragments.
        corner = 0u;
        is_bottom = false;
    }
    Ray ray = rays.list[water_vertex(volume, corner)];
    vec3 point = ray.origin.xyz;
    if (is_bottom) {
        float descent = point.y - volumes.bottom;
        point = vec3(point.x + ray.slope.x * descent, volumes.bottom, point.z + ray.slope.y * descent);
    }
    vec3 along = point + vec3(volumes.u.w, volumes.v.w, volumes.w.w);
    vec3 world = volumes.u.xyz * along.x + volumes.v.xyz * along.y + volumes.w.xyz * along.z;
    gl_Position = volumes.view_projection * vec4(world, 1.0);
}
