// Eight invocations of a row answer for 4 x 2 pixels, not 8 x 1: rays beside each other in both directions take the same path
// through the levels longer than those along a line.
ivec2 pixel_of(uvec2 invocation) {
    ivec2 i = ivec2(invocation);
    return (i & ~7) + ivec2(4 * (i.y & 1) + (i.x & 3), (i.y & 6) + ((i.x >> 2) & 1));
}
