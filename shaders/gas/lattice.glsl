// Gas at a lower resolution (ours): that of a lattice of pixels is marched first, whose columns and rows are
// `lattice_scale` apart. A section of any other pixel is then the mean of those of the lattice around it that lie between the
// same surfaces, each as long as its own; where they do not, it is marched.

// Of their depths together, what two sections share at least.
const float LEAST_SHARED = 0.5;
// Weights of the lattice's sections together, at least.
const float LEAST_WEIGHT = 0.5;

// The pixel of the lattice at or before another one, along both axes. In floats, which hold a picture's columns and rows: whole
// numbers are divided thread by thread.
uvec2 lattice_before(uvec2 pixel) {
    float scale = float(lattice_scale);
    return uvec2(floor((vec2(pixel) + 0.5) / scale) * scale);
}

bool is_on_lattice(uvec2 pixel) {
    return pixel == lattice_before(pixel);
}

// This dispatch is the pixel's: the lattice has the first ones.
bool is_turn_of(uvec2 pixel) {
    return is_on_lattice(pixel) == (band.rest == 0u);
}

// A section of a pixel of the lattice as another one's from `extent.x` to `extent.y` has it, times a weight; nothing where it is
// another piece of gas.
vec4 lent(uvec2 corner, uint number, vec2 extent, float weight, inout float weights) {
    bool is_there = weight > 0.0 && corner.x < frame.size.x && corner.y >= band.list_row && corner.y < band.end_list_row;
    if (!is_there) {
        return vec4(0.0);
    }
    Pixel pixel = pixel_of_words(pixels[list_of(corner)]);
    if (number >= pixel.section_count) {
        return vec4(0.0);
    }
    uint slot = pixel.first_section + number;
    vec2 other = uintBitsToFloat(sections[2u * slot].xy);
    vec4 light = uintBitsToFloat(sections[2u * slot + 1u]);
    float shared_m = min(other.y, extent.y) - max(other.x, extent.x);
    float whole_m = max(other.y, extent.y) - min(other.x, extent.x);
    if (shared_m < LEAST_SHARED * whole_m) {
        return vec4(0.0);
    }
    weights += weight;
    float ratio = (extent.y - extent.x) / (other.y - other.x);
    float passed = light.w < 1.0 ? pow(max(light.w, 1.0e-37), ratio) : 1.0;
    float share = light.w < 0.999 ? (1.0 - passed) / (1.0 - light.w) : ratio;
    return vec4(light.xyz * share, passed) * weight;
}

// A section of a pixel that is not of the lattice: done, unless it must be marched.
Gas taken(uvec2 pixel, uint number, vec2 extent) {
    uvec2 low = lattice_before(pixel);
    uvec2 high = low + uvec2(lattice_scale);
    vec2 t = vec2(pixel - low) / float(lattice_scale);
    float weights = 0.0;
    vec4 sum = lent(low, number, extent, (1.0 - t.x) * (1.0 - t.y), weights);
    sum += lent(uvec2(high.x, low.y), number, extent, t.x * (1.0 - t.y), weights);
    sum += lent(uvec2(low.x, high.y), number, extent, (1.0 - t.x) * t.y, weights);
    sum += lent(high, number, extent, t.x * t.y, weights);
    if (weights < LEAST_WEIGHT) {
        return NOTHING;
    }
    return Gas(sum.xyz / weights, sum.w / weights, 0u, 0u, true);
}
