#version 450

// One level of the multilevel altitude map (section 3): a texel is the highest, or for the lower bound of Catmull-Rom
// surfaces the lowest, of up to four texels of the level below it. Maps need not be powers of two: the last column and row
// repeat where a level's size is odd. The first level of the variants that walk from cell to cell has all that the surface
// of a texel's cells reads, so that the texels of all levels bound whole cells.

#extension GL_EXT_samplerless_texture_functions : require

layout(set = 0, binding = 0) uniform utexture2DArray finer;

layout(push_constant, std430) uniform Level {
    ivec2 origin; // of the finer level in its layer
    ivec2 last; // its last column and row
    int is_float; // texels are bits of floats
    int is_lowest;
    int before; // texels that are read before and after the four
    int after;
} level;

layout(location = 0) out uint value;

uint choose(uint a, uint b) {
    bool is_less = level.is_float != 0 ? uintBitsToFloat(a) < uintBitsToFloat(b) : a < b;
    return is_less == (level.is_lowest != 0) ? a : b;
}

uint texel_at(ivec2 texel) {
    return texelFetch(finer, ivec3(level.origin + min(texel, level.last), 0), 0).x;
}

void main() {
    ivec2 corner = 2 * ivec2(gl_FragCoord.xy);
    value = texel_at(corner);
    for (int row = -level.before; row < 2 + level.after; row++) {
        for (int column = -level.before; column < 2 + level.after; column++) {
            value = choose(value, texel_at(max(corner + ivec2(column, row), ivec2(0))));
        }
    }
}
