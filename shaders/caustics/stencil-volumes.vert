#version 450

// One illumination volume as a closed prism (section 3.2): a top where its rays leave the water, a bottom below every receiver, and
// three sides. The volume's own sides are ruled surfaces, and beyond a focus it is turned over; the prism's are planes along the
// water triangle's sides that touch the volume at the top and at the bottom, and so hold all of it between. 24 vertices a
// volume, eight triangles; the fragment stage leaves out what is in the prism alone.

#include "caustics/volume.glsl"

layout(location = 0) flat out uint volume;

// Distance of the sides beyond the volume, so that rounding does not decide what is inside: a fraction of the water triangle. What
// the device rounds in the picture adds that of `volumes`.
const float SLACK = 0.02;

vec2 place_at(Ray ray, float height) {
    return ray.origin.xz + ray.slope * (ray.origin.y - height);
}

vec4 clip_place(vec2 place, float height) {
    vec3 along = vec3(place.x + volumes.reference_u, height + volumes.reference_v, place.y + volumes.reference_w);
    vec3 world = volumes.u * along.x + volumes.v * along.y + volumes.w * along.z;
    return volumes.view_projection * vec4(world, 1.0);
}

float cross_2d(vec2 a, vec2 b) {
    return a.x * b.y - a.y * b.x;
}

void main() {
    volume = uint(gl_VertexIndex) / 24u;
    uint vertex = uint(gl_VertexIndex) % 24u;
    uint corner = vertex;
    bool is_bottom = false;
    if (vertex >= 3u && vertex < 6u) {
        corner = (6u - vertex) % 3u;
        is_bottom = true;
    } else if (vertex >= 6u) {
        uint from = (vertex - 6u) / 6u;
        uint to = (from + 1u) % 3u;
        uint place = (vertex - 6u) % 6u;
        // Corners of a side's two triangles: to from to' and from from' to', where ' is the bottom.
        corner = place == 1u || place == 3u || place == 4u ? from : to;
        is_bottom = place == 2u || place >= 4u;
    }

    // The corner lies where two sides meet: from `here` to `next`, and from `last` to `here`.
    Ray here = rays.list[water_vertex(volume, corner)];
    Ray next = rays.list[water_vertex(volume, (corner + 1u) % 3u)];
    Ray last = rays.list[water_vertex(volume, (corner + 2u) % 3u)];
    float height = is_bottom ? volumes.bottom : max(here.origin.y, max(next.origin.y, last.origin.y));
    vec2 towards = next.origin.xz - here.origin.xz;
    vec2 back = here.origin.xz - last.origin.xz;
    float twice_area = cross_2d(back, towards);
    // Normals that point outwards, as long as the sides.
    vec2 outwards_a = sign(twice_area) * vec2(towards.y, -towards.x);
    vec2 outwards_b = sign(twice_area) * vec2(back.y, -back.x);
    vec2 base = place_at(here, height);
    vec2 to_next = place_at(next, height) - base;
    vec2 to_last = place_at(last, height) - base;
    float slack_m = volumes.slack * max(clip_place(base, height).w, 0.0);
    float slack_a = SLACK * abs(twice_area) + slack_m * length(towards);
    float slack_b = SLACK * abs(twice_area) + slack_m * length(back);
    float reach_a = max(0.0, max(dot(outwards_a, to_next), dot(outwards_a, to_last))) + slack_a;
    float reach_b = max(0.0, max(dot(outwards_b, to_next), dot(outwards_b, to_last))) + slack_b;

    // Without light all corners are one, and the prism has no fragments.
    gl_Position = clip_place(vec2(0.0), 0.0);
    if (twice_area != 0.0 && min(here.enters, min(next.enters, last.enters)) > 0.0) {
        vec2 meet = (reach_a * back - reach_b * towards) / abs(twice_area);
        gl_Position = clip_place(base + meet, height);
    }
}
