#version 450

// Light of one illumination volume on the surface inside it (section 3.2): the intensity of eq. 4-18 with A_d, the area that the
// volume's three rays span, taken at the height of the fragment's surface. The stencil buffer says that the surface is inside
// the prism around the volume.

#include "caustics/volume.glsl"
#include "caustics/diffuse.glsl"

layout(location = 0) flat in uint volume;

layout(set = 0, binding = 3) uniform texture2D surface_position;
layout(set = 0, binding = 4) uniform texture2D surface_normal;
layout(set = 0, binding = 5) uniform texture2D surface_albedo;
layout(set = 0, binding = 6) uniform sampler nearest;

layout(location = 0) out vec4 light;

float cross_2d(vec2 a, vec2 b) {
    return a.x * b.y - a.y * b.x;
}

// True for a point to the left of the segment from a to b. The order of the water's vertices decides its start, so that
// the two volumes along a side agree to the bit and a point on the side belongs to one of them.
bool is_left(vec2 a, vec2 b, bool in_order, vec2 point) {
    vec2 start = in_order ? a : b;
    vec2 end = in_order ? b : a;
    return (cross_2d(end - start, point - start) >= 0.0) == in_order;
}

void main() {
    // No fragment is discarded: it would leave its volume's count in the stencil buffer for the next volume to find.
    light = vec4(0.0);
    ivec2 texel = ivec2(gl_FragCoord.xy);
    vec3 world = texelFetch(sampler2D(surface_position, nearest), texel, 0).xyz;
    vec3 point = vec3(dot(volumes.u, world) - volumes.reference_u, dot(volumes.v, world) - volumes.reference_v,
        dot(volumes.w, world) - volumes.reference_w);

    uvec3 vertices = uvec3(water_vertex(volume, 0u), water_vertex(volume, 1u), water_vertex(volume, 2u));
    Ray a = rays.list[vertices.x];
    Ray b = rays.list[vertices.y];
    Ray c = rays.list[vertices.z];
    vec3 descent = vec3(a.origin.y, b.origin.y, c.origin.y) - point.y;
    if (min(descent.x, min(descent.y, descent.z)) <= 0.0) {
        return;
    }
    vec2 at_a = a.origin.xz + a.slope * descent.x;
    vec2 at_b = b.origin.xz + b.slope * descent.y;
    vec2 at_c = c.origin.xz + c.slope * descent.z;
    float twice_area = cross_2d(at_b - at_a, at_c - at_a);
    if (twice_area == 0.0) {
        return;
    }
    // Beyond its focus a beam is turned over.
    bool is_left_of_sides = twice_area > 0.0;
    if (is_left(at_a, at_b, vertices.x < vertices.y, point.xz) != is_left_of_sides
        || is_left(at_b, at_c, vertices.y < vertices.z, point.xz) != is_left_of_sides
        || is_left(at_c, at_a, vertices.z < vertices.x, point.xz) != is_left_of_sides) {
        return;
    }
    vec2 from_a = point.xz - at_a;
    float weight_b = cross_2d(from_a, at_c - at_a) / twice_area;
    float weight_c = cross_2d(at_b - at_a, from_a) / twice_area;
    float weight_a = 1.0 - weight_b - weight_c;

    // Twice A_w along the face normal: against the incident ray it is 2 A_w cos theta_i.
    vec3 water = cross(b.origin - a.origin, c.origin - a.origin);
    // Upwards; a face that is turned away from a corner's light passes nothing, whatever the normals of its vertices say.
    water *= sign(dot(water, vec3(volumes.u.y, volumes.v.y, volumes.w.y)));
    if (max(dot(water, a.incident), max(dot(water, b.incident), dot(water, c.incident))) >= 0.0) {
        return;
    }
    float k = volumes.absorption_per_m;
    vec3 weights = vec3(dot(water, a.incident) * a.secant * exp(-k * descent.x * a.secant),
        dot(water, b.incident) * b.secant * exp(-k * descent.y * b.secant),
        dot(water, c.incident) * c.secant * exp(-k * descent.z * c.secant));
    float intensity = abs(dot(weights, vec3(weight_a, weight_b, weight_c)) / twice_area);

    vec3 normal = texelFetch(sampler2D(surface_normal, nearest), texel, 0).xyz;
    vec3 albedo = texelFetch(sampler2D(surface_albedo, nearest), texel, 0).rgb;
    light = vec4(volumes.intensity * intensity * diffuse_light(albedo, normal, volumes.v).rgb, 0.0);
}
