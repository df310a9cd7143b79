#version 450
#pragma variants SHADOW=off,on LAYERS=one,several

// Where the ray of each vertex of the refined water meets the receiver first (section 6.3), in the position map's texels.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "caustics/unfinished.glsl"
#include "caustics/hit.glsl"
#include "caustics/shadow-{SHADOW}.glsl"
#include "caustics/landing.glsl"

layout(std430, set = 0, binding = 5) buffer Landings {
    vec4 list[]; // a Landing each
} landings;

layout(std430, set = 0, binding = 11) buffer Intensities {
    float list[]; // I_c where each ray lands, negative where the light is turned over, 0 where it is not known
} intensities;

// Turns of loops on the way of a ray, all together. One surface takes 36,866 at most, which lavapipe grants, with room for what follows;
// with several it may end the loops before this does. Either is told.
const int MOST_TURNS = 60000;

int turns = 0;

// How far above a ray a surface may be at the texel that the ray comes to, as a slope that goes on rising; farther, it is an edge.
float most_rise(ivec2 texel, float found, vec2 slope) {
    vec2 ahead = slope * plane.texels_per_m;
    ivec2 onward = abs(ahead.x) > abs(ahead.y) ? ivec2(ahead.x > 0.0 ? 1 : -1, 0) : ivec2(0, ahead.y > 0.0 ? 1 : -1);
    float beyond = height_near(texel + onward, found);
    float rise = is_receiver(beyond) ? abs(beyond - found) : 0.0;
    return 1.5 * rise + 2.0 * sqrt(plane.texel_area_m2);
}

// The height of what a ray meets at a texel that it comes to at the height `above` and leaves at `height`: above `above` where it comes
// in by the side, below -1e29 where it goes on.
float met_at(ivec2 texel, float above, float height, vec2 slope) {
#ifdef LAYERS_SEVERAL
    float over = 1.0e30;
    int layer = 0;
    for (; layer < layer_count(); layer++) {
        turns++;
        float top = height_of(layer, texel);
        if (top <= above) {
            float ceiling = layer > 0 ? ceiling_of(layer, texel) : 1.0e30;
            // A sheet that goes on rising is met; under any other the ray passes. That looks at all layers once more.
            turns += is_receiver(ceiling) ? 0 : layer_count();
            bool is_inside = is_receiver(ceiling) ? above > ceiling : over - above <= most_rise(texel, over, slope);
            return is_inside ? over : (top >= height ? top : -1.0e30);
        }
        over = top;
    }
    is_cut = is_cut || layer < layer_count();
    return over;
#else
    float top = height_at(texel);
    return top >= height ? top : -1.0e30;
#endif
}

// The first place where a ray meets the receiver: texels in x and y, the height in z, and in w 1, or 0 where it meets nothing that
// the map holds. A receiver is solid below what the light sees of it: what enters by its side is lost.
vec4 first_hit(vec3 origin, vec2 slope) {
    float start = origin.y - plane.middle;
    float top = min(plane.half_height, start);
    float bottom = -plane.half_height;
    // Near the ray's place nothing is higher than the highest there, nor lower than the lowest.
    for (int i = 0; i < 3; i++) {
        vec2 range = heights_between(place_at(origin, slope, top), place_at(origin, slope, bottom));
        if (range.x > range.y) {
            return vec4(0.0);
        }
        top = min(top, range.y);
        bottom = max(bottom, least_near(range));
    }
    if (top < bottom) {
        return vec4(0.0);
    }
    vec2 path = abs(place_at(origin, slope, bottom) - place_at(origin, slope, top));
    if (max(path.x, path.y) > float(plane.map_size)) {
        // In the box of a high and narrow receiver most of a slanting way lies beside the map.
        vec2 begin = place_at(origin, slope, top);
        vec2 part = part_over_map(begin, place_at(origin, slope, bottom) - begin);
        if (part.x >= part.y) {
            return vec4(0.0);
        }
        vec2 ends = mix(vec2(top), vec2(bottom), part);
        top = ends.x;
        bottom = ends.y;
        path = abs(place_at(origin, slope, bottom) - place_at(origin, slope, top));
    }
    int steps = int(clamp(ceil(max(path.x, path.y)), 1.0, float(MOST_STEPS)));
    float above = top;
    float height = top;
    float found = -1.0e30;
    int from = 0;
    for (; from <= steps && found < height && turns < MOST_TURNS; from += STRIDE) {
        turns++;
        int to = min(from + STRIDE - 1, steps);
        // Exactly the lowest at the end, where nothing can be missed.
        float lowest = to == steps ? bottom : mix(top, bottom, float(to) / float(steps));
        vec2 near = heights_between(place_at(origin, slope, mix(top, bottom, float(from) / float(steps))), place_at(origin, slope, lowest));
        if (near.y < lowest) {
            found = -1.0e30;
            height = lowest;
            above = lowest;
        }
        int i = from;
        for (; i <= to && near.y >= lowest; i++) {
            turns++;
            height = i == steps ? bottom : mix(top, bottom, float(i) / float(steps));
            found = met_at(ivec2(floor(place_at(origin, slope, height))), above, height, slope);
            if (found >= height) {
                break;
            }
            above = height;
        }
        is_cut = is_cut || (i <= to && near.y >= lowest && found < height);
    }
    is_cut = is_cut || (from <= steps && found < height);
    if (found < height) {
        return vec4(0.0);
    }
    vec2 end = place_at(origin, slope, height);
    if (found > above) {
        // Stepped in at the side.
        if (found - above > most_rise(ivec2(floor(end)), found, slope)) {
            return vec4(0.0);
        }
    }
    // Over a texel's length the surface is nearly straight.
    float over = above - surface_at(place_at(origin, slope, above), found, false).height;
    float under = surface_at(end, found, false).height - height;
    float fraction = over + under > 1.0e-9 ? clamp(over / (over + under), 0.0, 1.0) : 1.0;
    float met = mix(above, height, fraction);
    return vec4(place_at(origin, slope, met), met, 1.0);
}

// Eq. 4-18 for a vertex without e^(-K d): the water's area around it against the area that its light has on the plane across V at
// that height, by the rays of its neighbours.
float intensity_at(uint index, Ray ray, float height) {
    uint column = index % plane.columns;
    uint before = column > 0u ? index - 1u : index;
    uint after = column + 1u < plane.columns ? index + 1u : index;
    uint above = index >= plane.columns ? index - plane.columns : index;
    uint below = index + plane.columns < plane.vertices ? index + plane.columns : index;
    Ray a = ray_at(before);
    Ray b = ray_at(after);
    Ray c = ray_at(above);
    Ray d = ray_at(below);
    vec2 along = place_at(b.origin, b.slope, height) - place_at(a.origin, a.slope, height);
    vec2 across = place_at(d.origin, d.slope, height) - place_at(c.origin, c.slope, height);
    float lit = along.x * across.y - along.y * across.x;
    vec3 face = cross(b.origin - a.origin, d.origin - c.origin);
    float enters = min(min(a.enters, b.enters), min(c.enters, d.enters));
    float passing = abs(dot(face, ray.incident)) * ray.secant / plane.texel_area_m2;
    return enters > 0.0 && abs(lit) > 1.0e-6 * passing ? passing / lit : 0.0;
}

void main() {
    uint index = element(64u);
    if (index >= plane.vertices) {
        return;
    }
    Ray ray = ray_at(index);
    // Of a ray that meets nothing, the place halfway down the box.
    Landing landing = Landing(vec3(place_at(ray.origin, ray.slope, 0.0), 0.0), -2.0);
    float light = 0.0;
    if (ray.enters > 0.0 && ray.origin.y > plane.middle - plane.half_height) {
        vec4 hit = first_hit(ray.origin, ray.slope);
        landing.weight = -1.0;
        if (hit.w > 0.0) {
            vec2 place = (hit.xy - 0.5 * float(plane.map_size)) / plane.texels_per_m + plane.center;
            landing.place = hit.xyz;
            if (reaches(vec3(place.x, hit.z + plane.middle, place.y), ray.origin)) {
                float descent = max(ray.origin.y - plane.middle - hit.z, 0.0);
                float passed = exp(-plane.absorption_per_m * (descent * ray.secant));
                landing.weight = passed * ray.secant;
                light = passed * intensity_at(index, ray, hit.z);
            }
        }
    }
    landings.list[index] = whole_of(landing);
    intensities.list[index] = light;
    if (is_cut || is_shadow_cut) {
        unfinished.intersect = 1u;
    }
}
