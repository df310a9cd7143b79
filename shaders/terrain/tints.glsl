// Drapes that are drawn of the land itself: lines of equal height, colours by slope and by height. Not the paper's.

const int CONTOURS = 3;
const int SLOPE = 4;
const int HYPSOMETRIC = 5;

// Kinds of base; 2 is an ellipsoid.
const int PLANE = 0;
const int CYLINDER = 1;

const vec3 INK = vec3(0.08, 0.045, 0.02);
// Every fifth line is a wide one.
const float LINE_PX = 1.0;
const float WIDE_LINE_PX = 2.0;
// Land on which lines are farther apart lies on none, however near its height is to one's.
const float MOST_APART_PX = 1.0e4;

// At 0, 15, 30, 45 and 60 degrees, linear: level, grassy, loose, rocky, sheer.
const vec3 SLOPES[5] = vec3[](vec3(0.55, 0.60, 0.50), vec3(0.35, 0.50, 0.15), vec3(0.70, 0.50, 0.05),
                              vec3(0.60, 0.08, 0.03), vec3(0.16, 0.02, 0.16));

// Of atlases: blue below 0 m, then green, yellow, brown and white, linear.
const float HEIGHTS_M[10] = float[](-6000.0, -200.0, 0.0, 0.0, 200.0, 500.0, 1000.0, 2000.0, 3500.0, 5000.0);
const vec3 HYPSOMETRIC_TINTS[10] =
    vec3[](vec3(0.01, 0.03, 0.12), vec3(0.05, 0.16, 0.35), vec3(0.22, 0.42, 0.55), vec3(0.10, 0.26, 0.10),
           vec3(0.28, 0.42, 0.14), vec3(0.62, 0.58, 0.25), vec3(0.50, 0.33, 0.12), vec3(0.30, 0.15, 0.06),
           vec3(0.32, 0.26, 0.24), vec3(0.75, 0.75, 0.76));

// The base's normal below a point of the world `height_m` over it.
vec3 up_at(vec3 point, float height_m) {
    if (light.base_kind == PLANE) {
        return vec3(0.0, 1.0, 0.0);
    }
    vec3 from_center = point - light.base_center;
    float along = dot(from_center, light.base_axis);
    vec3 across = from_center - along * light.base_axis;
    vec2 squares = light.base_radii * light.base_radii;
    float radius = max(length(across), 1.0e-20);
    vec2 up = vec2(radius, 0.0);
    if (light.base_kind != CYLINDER) {
        // The point is (N + h) cos, (N b^2 / a^2 + h) sin of the latitude, whose radius of curvature N changes little with it.
        up = vec2(radius, along) / squares;
        for (int i = 0; i < 4; i++) {
            up = normalize(up);
            float n = squares.x / sqrt(dot(squares, up * up));
            up = vec2(radius, along) / (vec2(n, n * squares.y / squares.x) + height_m);
        }
    }
    return normalize(up.x / radius * across + up.y * light.base_axis);
}

// The change of the height from a pixel to the next, metres: the next ray meets the plane of the surface in another place.
float rise_per_pixel(vec3 direction, float depth_m, vec3 facing, vec3 up) {
    // A normal between the nodes may point away from the eye.
    float towards = min(dot(facing, direction), -1.0e-4);
    vec3 right = light.right_step - direction * (dot(facing, light.right_step) / towards);
    vec3 down = light.down_step - direction * (dot(facing, light.down_step) / towards);
    return depth_m * length(vec2(dot(up, right), dot(up, down)));
}

// The share of a pixel that a line covers. Lines closer than 2 pixels are left out, those 4 apart are drawn in full.
float line_at(float height_m, float interval_m, float width_px, float rise_m) {
    float rise = max(rise_m, 1.0e-20);
    float apart_px = interval_m / rise;
    float off_px = abs(height_m - interval_m * floor(height_m / interval_m + 0.5)) / rise;
    float line = clamp(0.5 * width_px + 0.5 - off_px, 0.0, 1.0) * clamp(0.5 * apart_px - 1.0, 0.0, 1.0);
    return apart_px < MOST_APART_PX ? line : 0.0;
}

vec3 with_contours(vec3 albedo, float height_m, float rise_m) {
    float narrow = line_at(height_m, light.drape_scale, LINE_PX, rise_m);
    float wide = line_at(height_m, 5.0 * light.drape_scale, WIDE_LINE_PX, rise_m);
    return mix(albedo, INK, 0.75 * max(narrow, wide));
}

vec3 slope_tint(vec3 facing, vec3 up) {
    float place = clamp(degrees(atan(length(cross(facing, up)), dot(facing, up))) / 15.0, 0.0, 4.0);
    int below = min(int(place), 3);
    return mix(SLOPES[below], SLOPES[below + 1], place - float(below));
}

vec3 hypsometric_tint(float height_m) {
    vec3 tint = HYPSOMETRIC_TINTS[0];
    for (int i = 0; i < 9; i++) {
        float between = clamp((height_m - HEIGHTS_M[i]) / max(HEIGHTS_M[i + 1] - HEIGHTS_M[i], 1.0e-3), 0.0, 1.0);
        tint = height_m >= HEIGHTS_M[i] ? mix(HYPSOMETRIC_TINTS[i], HYPSOMETRIC_TINTS[i + 1], between) : tint;
    }
    return tint;
}

// The land's colour under such a drape; `facing` has the height over the base as its fourth number.
vec3 tinted(vec3 albedo, vec3 direction, float depth_m, vec4 facing) {
    vec3 up = up_at(light.eye + depth_m * direction, facing.w);
    float height_m = facing.w - light.zero_m;
    vec3 tint = albedo;
    if (light.draping == CONTOURS) {
        tint = with_contours(albedo, height_m, rise_per_pixel(direction, depth_m, facing.xyz, up));
    }
    if (light.draping == SLOPE) {
        tint = slope_tint(facing.xyz, up);
    }
    if (light.draping == HYPSOMETRIC) {
        tint = hypsometric_tint(height_m / light.drape_scale);
    }
    return tint;
}
