// The rock over a whole pixel, by more taps where the pixel covers more texels.

// Most taps of the rock along each side of a pixel, and the texels between two: the sampler's own filter is two wide.
const float MOST_TAPS = 3.0;
const float TEXELS_A_TAP = 1.5;

// Of a ray that meets the surface at that eye-space depth. `side` is the normal of a wall below an edge at that height, whose rock
// goes on from the edge as if it were folded down; no vector for the sheet.
vec3 rock_over(vec3 place_m, float depth_m, vec3 direction, vec3 normal, vec3 side, float edge_m) {
    // The pixel's sides on the tangent plane; seen edge-on they would not end.
    float facing = dot(direction, normal);
    facing = abs(facing) < 0.05 ? (facing < 0.0 ? -0.05 : 0.05) : facing;
    vec3 right_m = depth_m * (shading.across - direction * (dot(shading.across, normal) / facing));
    vec3 down_m = depth_m * (shading.down - direction * (dot(shading.down, normal) / facing));
    vec2 texels = vec2(length(right_m), length(down_m)) / scene.rock_tile_m * scene.rock_texels;
    vec2 taps = clamp(ceil(texels / TEXELS_A_TAP), 1.0, MOST_TAPS);
    Rock laid = rock_of(place_m.xz);
    vec3 rock = vec3(0.0);
    for (float y = 0.5; y < taps.y; y++) {
        for (float x = 0.5; x < taps.x; x++) {
            vec3 tap_m = place_m + (x / taps.x - 0.5) * right_m + (y / taps.y - 0.5) * down_m;
            rock += rock_at(laid, tap_m.xz + side.xz * (edge_m - tap_m.y));
        }
    }
    return rock / (taps.x * taps.y);
}
