// A triangle of the refined water (section 6.3).

layout(std430, set = 0, binding = 4) readonly buffer Rays {
    Ray list[];
} rays;

layout(std430, set = 0, binding = 7) readonly buffer Indices {
    uint list[]; // three a water triangle
} indices;

layout(std430, set = 0, binding = 8) buffer Straddling {
    uint list[]; // their number, then triangles of the water that do not land whole
} straddling;

// The area vector in texels of the map, on the upper side.
vec3 face_of(Ray a, Ray b, Ray c) {
    vec3 face = 0.5 * cross(b.origin - a.origin, c.origin - a.origin);
    return face * (sign(dot(face, plane.up)) / plane.texel_area_m2);
}
