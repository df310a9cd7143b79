// A right-angled triangle in normalised device coordinates (y down), symmetric in neither x nor y.
const vec2 CORNERS[3] = vec2[](vec2(-0.9, -0.8), vec2(0.5, -0.8), vec2(-0.9, 0.2));

// Red at the right angle (top left), green at the right, blue below.
vec3 corner_colour(uint corner) {
    return vec3(corner == 0u, corner == 1u, corner == 2u);
}
