// The sun, the sky and the haze.

const int UNDRAPED = 0;
const int DRAPED = 1; // the picture's corners on the map's
const int PLACED = 2; // where it lies

layout(set = 0, binding = 0, std140) uniform Light {
    vec3 corner_direction; // to the middle of pixel (0, 0), world, for 1 m of depth
    float near_m; // near plane of what is rasterised
    vec3 right_step; // the direction's change from a pixel to the next on the right
    float sky_strength;
    vec3 down_step; // and to the next below
    float extinction_per_m; // by haze
    vec3 to_sun;
    float lowest_m; // above the base
    vec3 haze_color;
    float highest_m;
    vec2 drape_cells; // columns and rows of the first map that the draped picture covers
    vec2 drape_corner; // column and row of its north-west corner
    vec3 eye; // world, metres
    int draping;
    vec3 base_center; // of a curved base, world, metres
    float drape_scale; // of what is drawn of the terrain: metres between lines of equal height, or the heights' exaggeration
    vec3 base_axis; // its axis, a unit vector
    float zero_m; // where the maps' heights are 0, above the base
    vec2 base_radii; // off the axis and along it
    int base_kind;
    float drape_turn; // columns of the first map that fill a whole turn under a picture in a place of its own; 0 where none do
} light;

vec3 view_direction(vec2 pixel) {
    return light.corner_direction + pixel.x * light.right_step + pixel.y * light.down_step;
}

// The light of a surface of that colour, where `up` is the base's normal, as seen from a distance, through the haze.
vec3 lit_color(vec3 albedo, vec3 facing, vec3 up, float sunlit, float distance_m) {
    float lit = sunlit * max(dot(facing, light.to_sun), 0.0);
    float open = light.sky_strength * (0.5 + 0.5 * dot(facing, up));
    vec3 seen = albedo * (vec3(2.0, 1.88, 1.7) * lit + vec3(0.55, 0.68, 0.9) * open);
    return mix(light.haze_color, seen, exp(-light.extinction_per_m * distance_m));
}

vec3 encoded(vec3 linear) {
    vec3 c = clamp(linear, vec3(0.0), vec3(1.0));
    vec3 low = 12.92 * c;
    vec3 high = 1.055 * pow(max(c, vec3(1.0e-6)), vec3(1.0 / 2.4)) - 0.055;
    return mix(high, low, vec3(lessThanEqual(c, vec3(0.0031308))));
}
