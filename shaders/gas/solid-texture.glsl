// The mean of a solid texture over a pixel's footprint on a surface. Turbulence varies as its finest octave does: the footprint is
// cut into parts of half its scale at most, each with a sample in its middle.

#include "gas/surface-footprint.glsl"

const float MOST_PARTS = 4.0; // each way
const float LONGEST = 16.0; // footprint that is looked at, in widths of a pixel that faces the eye

vec3 bounded(vec3 along, float most_m) {
    return along * min(1.0, most_m / max(length(along), 1.0e-30));
}

// Of the texture in hand, at a point in the surface's own space that is seen at a depth.
float mean_density(vec3 point, vec3 facing, vec3 ray, float depth) {
    vec3 across = footprint_along(facing, ray, depth, frame.ray_per_column);
    vec3 along = footprint_along(facing, ray, depth, frame.ray_per_row);
    across = bounded(across, LONGEST * depth * length(frame.ray_per_column));
    along = bounded(along, LONGEST * depth * length(frame.ray_per_row));
    float parts_a_metre = in_hand.texture_scale_per_m * exp2(float(max(octaves, 1u)));
    vec2 parts = clamp(ceil(vec2(length(across), length(along)) * parts_a_metre), vec2(1.0), vec2(MOST_PARTS));
    uint count = uint(parts.x) * uint(parts.y);
    float sum = 0.0;
    vec2 part = vec2(0.0);
    uint i = 0u;
    do {
        vec2 at = (part + 0.5) / parts - 0.5;
        part = part.x + 1.0 < parts.x ? part + vec2(1.0, 0.0) : vec2(0.0, part.y + 1.0);
        sum += clamp(gas_density(point + across * at.x + along * at.y), 0.0, 1.0);
        if (i < count) {
            i++;
        }
    } while (i < count);
    is_cut = is_cut || i < count;
    return sum / float(count);
}
