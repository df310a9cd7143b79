#version 450

#pragma variants SIMULATION=free,sph

// A ray for each pixel against the height field, in place of splats. It begins where it comes below the highest place, goes
// from cell to cell, and in a cell to the exact
// crossing with the bilinear patch, whose height above a ray is a quadratic. The sheet is seen from both sides, as splats
// are; at the sides of the space a wall closes it down to the floor. Ours: the thesis has splats alone.

#extension GL_EXT_samplerless_texture_functions : require

#include "lava/scene.glsl"
#include "lava/ground.glsl"
#include "lava/rays.glsl"

layout(set = 0, binding = 2, std430) readonly buffer Highest {
    float all; // place of the height field, metres
} highest;

layout(set = 0, binding = 5, rgba32f) uniform readonly image2D patches; // of highest-rows.comp

#include "lava/height.glsl"
#include "lava/color.glsl"
#include "lava/taps.glsl"

layout(location = 0) out vec4 accumulated;

// lavapipe ends all loops of a shader after 65,535 iterations. A ray crosses at most columns + rows + 1 cells.
const int MOST_CELLS = 65534;
const float FAR_AWAY = 1.0e30;

struct Hit {
    float t; // eye-space depth in metres, above far_m for none
    vec3 side; // normal of a wall, no vector for the sheet
};

// The sheet's height over a cell, the first of which is -1, -1: at its first corner, its slopes along both sides from there, and its
// twist.
vec4 patch_of(vec2 cell) {
    return imageLoad(patches, ivec2(cell) + 1);
}

float height_in(vec4 sheet, vec2 at) {
    return sheet.x + sheet.y * at.x + sheet.z * at.y + sheet.w * at.x * at.y;
}

float finite_over(float over, float under) {
    return under == 0.0 ? FAR_AWAY : clamp(over / under, -FAR_AWAY, FAR_AWAY);
}

// The first s in 0 to `last` at which c0 + c1 s + c2 s^2 is 0; FAR_AWAY for none.
float first_root(float c0, float c1, float c2, float last) {
    float inside = c1 * c1 - 4.0 * c0 * c2;
    if (inside < 0.0) {
        return FAR_AWAY;
    }
    float q = -0.5 * (c1 + (c1 < 0.0 ? -1.0 : 1.0) * sqrt(inside));
    float a = finite_over(q, c2);
    float b = finite_over(c0, q);
    a = a >= 0.0 && a <= last ? a : FAR_AWAY;
    b = b >= 0.0 && b <= last ? b : FAR_AWAY;
    return min(a, b);
}

Hit march(vec3 direction) {
    // The box, a little deeper than any surface, and as high as the surface.
    float slack_m = 1.0e-3 * scene.space_m.y;
    vec3 low = vec3(0.0, -slack_m, 0.0) - shading.eye_m;
    vec3 high = vec3(scene.space_m.x, highest.all + slack_m, scene.space_m.z) - shading.eye_m;
    vec3 safe = mix(direction, vec3(1.0e-12), lessThan(abs(direction), vec3(1.0e-12)));
    vec3 enter = min(low / safe, high / safe);
    vec3 leave = max(low / safe, high / safe);
    float entry = max(max(enter.x, enter.z), max(enter.y, shading.near_m));
    float exit = min(min(leave.x, leave.z), min(leave.y, shading.far_m));
    if (entry >= exit) {
        return Hit(FAR_AWAY, vec3(0.0));
    }
    vec2 from = columns_at(shading.eye_m.xz);
    vec2 along = direction.xz / scene.space_m.xz * scene.columns;
    vec2 forward = step(vec2(0.0), along);
    vec2 cell = clamp(floor(from + entry * along), vec2(-1.0), scene.columns - 1.0);
    float t = entry;
    float height_m = shading.eye_m.y + t * direction.y;
    bool begins_above = height_m >= height_in(patch_of(cell), from + t * along - cell);
    if (!begins_above && height_m >= 0.0) {
        if (entry == enter.x) {
            return Hit(entry, vec3(-sign(direction.x), 0.0, 0.0));
        }
        if (entry == enter.z) {
            return Hit(entry, vec3(0.0, 0.0, -sign(direction.z)));
        }
    }
    // A ray crosses each column and each row once; where rounding holds it in a cell of the border, it goes no farther.
    int most = min(int(scene.columns.x + scene.columns.y) + 4, MOST_CELLS);
    for (int i = 0; i < most; i++) {
        vec2 to_border = cell + forward - from;
        vec2 borders = vec2(finite_over(to_border.x, along.x), finite_over(to_border.y, along.y));
        float next = max(min(min(borders.x, borders.y), exit), t);
        vec4 sheet = patch_of(cell);
        vec2 at = from + t * along - cell;
        float c0 = shading.eye_m.y + t * direction.y - height_in(sheet, at);
        float c1 = direction.y - (dot(sheet.yz, along) + sheet.w * (at.x * along.y + at.y * along.x));
        float c2 = -sheet.w * along.x * along.y;
        float last = next - t;
        float root = first_root(c0, c1, c2, last);
        bool ends_above = c0 + last * (c1 + last * c2) >= 0.0;
        if (root <= last || ends_above != begins_above) {
            // Rounding may hide a crossing on the border of two cells.
            return Hit(t + min(root, last), vec3(0.0));
        }
        t = next;
        if (t >= exit) {
            break;
        }
        if (borders.x <= borders.y) {
            cell.x += 2.0 * forward.x - 1.0;
        } else {
            cell.y += 2.0 * forward.y - 1.0;
        }
        cell = clamp(cell, vec2(-1.0), scene.columns - 1.0);
    }
    if (!begins_above && shading.eye_m.y + exit * direction.y >= 0.0) {
        if (exit == leave.x) {
            return Hit(exit, vec3(-sign(direction.x), 0.0, 0.0));
        }
        if (exit == leave.z) {
            return Hit(exit, vec3(0.0, 0.0, -sign(direction.z)));
        }
    }
    return Hit(FAR_AWAY, vec3(0.0));
}

void main() {
    vec3 direction = ray_through(gl_FragCoord.xy);
    Hit hit = march(direction);
    if (hit.t > shading.far_m) {
        discard;
    }
    vec3 place_m = shading.eye_m + hit.t * direction;
    vec4 surface = surface_at(columns_at(place_m.xz));
    bool is_wall = dot(hit.side, hit.side) > 0.0;
    // Of a wall only what lies between lava and ground.
    bool is_ground = is_wall && place_m.y < ground_m(place_m.xz);
    if (is_ground || is_bare(vec3(place_m.x, surface.w, place_m.z))) {
        discard;
    }
    vec3 normal = is_wall ? hit.side : normalize(surface.xyz);
    vec3 rock = rock_over(place_m, hit.t, direction, normal, hit.side, surface.w);
    vec3 color = color_of(place_m, normal, rock);
    accumulated = vec4(shading.mode == NORMALS ? 0.5 + 0.5 * normal : color, 1.0);
    gl_FragDepth = (hit.t + scene.epsilon_m) * scene.depth_per_m;
}
