// Tiles of the picture that fire or smoke reaches, so that its layer goes over those alone.

const uint TILES = 32u; // along x, and along y

layout(push_constant, std430) uniform Laying {
    uint picture; // number of the pictures so far
} laying;
