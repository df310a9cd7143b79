// Surfaces without a gas among them.

const uint CHUNKS_A_CALL = 32u; // of a tile's triangles in a dispatch, so that no driver ends the loops, see loops.glsl

float gas_opacity(Facet facet, vec2 at, float depth, vec3 normal, float opacity) {
    return opacity;
}
