// The solids that bound the gases. Any convex solid does that a ray can be cut with (section on volume-modelled
// phenomena).

struct Volume {
    vec3 center; // m
    uint shape; // BOX, SPHERE or FRUSTUM
    vec3 half_extent_m;
    float falloff; // fraction of the distance from boundary to middle over which the gas fades
    vec3 texture_offset; // texture units
    float texture_scale_per_m; // texture units a metre
    vec3 albedo; // linear RGB
    float tau_per_m; // or a solid's c
    vec2 radii; // of a frustum at bottom and top, over half_extent_m.xz
    uint is_solid; // 1 for a hypertexture solid
    float step_m; // of the march
    uint density_function; // CONSTANT to HYPERTEXTURE
    float opaque;
    float power;
    float frequency; // of the clouds' sine wave
    vec2 ellipse; // diameters of the helix (ELLIPSE1, ELLIPSE2), texture units
    float along_per_frame; // along the helix (DOWN), texture units a frame
    float swirl_frames; // of one revolution (SWIRL_FRAMES), 0 for none
    float front_x_m; // of the fog's front at frame 0
    float front_per_frame_m;
    float front_depth_m; // behind the front until the fog is at its thickest
    float front_full_frames; // until the fog is at its thickest (FULL_FOG)
    float front_turbulence_m; // by which a turbulence of 1 moves the front
    float front_table_m; // by which a random number of 1 moves it
    float hypertexture_amplitude; // fraction of the radius by which a turbulence of 1 moves the surface
    float hypertexture_softness; // fraction of the radius over which it turns dense
    vec2 phase_weights; // of two Henyey-Greenstein functions
    vec2 phase_g;
};

layout(set = 0, binding = 1, std430) readonly buffer Volumes {
    Volume volumes[];
};

const uint BOX = 0u;
const uint SPHERE = 1u;
const uint FRUSTUM = 2u;
const vec2 EMPTY_SEGMENT = vec2(1.0, -1.0);

// Where the line is inside |p| <= 1 along one axis.
vec2 slab_segment(float origin, float direction) {
    if (abs(direction) < 1.0e-12) {
        return abs(origin) <= 1.0 ? vec2(-1.0e30, 1.0e30) : EMPTY_SEGMENT;
    }
    float a = (-1.0 - origin) / direction;
    float b = (1.0 - origin) / direction;
    return vec2(min(a, b), max(a, b));
}

vec2 intersect(vec2 a, vec2 b) {
    return vec2(max(a.x, b.x), min(a.y, b.y));
}

vec2 box_segment(vec3 origin, vec3 direction) {
    vec2 xy = intersect(slab_segment(origin.x, direction.x), slab_segment(origin.y, direction.y));
    return intersect(xy, slab_segment(origin.z, direction.z));
}

// Where a t^2 + 2 b t + c <= 0 for a > 0.
vec2 quadratic_segment(float a, float b, float c) {
    float under = b * b - a * c;
    if (under < 0.0) {
        return EMPTY_SEGMENT;
    }
    // The root of larger size first: the other has no cancellation then.
    float q = -(b + (b >= 0.0 ? sqrt(under) : -sqrt(under)));
    float first = q / a;
    float second = q != 0.0 ? c / q : first;
    return vec2(min(first, second), max(first, second));
}

// x^2 + z^2 <= (m + n y)^2 between y = -1 and 1, where m + n y is not negative.
vec2 frustum_segment(vec3 o, vec3 d, vec2 radii) {
    vec2 slab = slab_segment(o.y, d.y);
    if (slab.x > slab.y) {
        return EMPTY_SEGMENT;
    }
    float n = 0.5 * (radii.y - radii.x);
    float radius = 0.5 * (radii.x + radii.y) + n * o.y; // at the origin
    float slope = n * d.y;
    float a = dot(d.xz, d.xz) - slope * slope;
    float b = dot(o.xz, d.xz) - radius * slope;
    float c = dot(o.xz, o.xz) - radius * radius;
    if (abs(a) < 1.0e-9) {
        if (abs(b) < 1.0e-12) {
            return c <= 0.0 ? slab : EMPTY_SEGMENT;
        }
        float t = -0.5 * c / b;
        return intersect(slab, b > 0.0 ? vec2(-1.0e30, t) : vec2(t, 1.0e30));
    }
    if (a > 0.0) {
        return intersect(slab, quadratic_segment(a, b, c));
    }
    // Steeper than the cone: inside before the first root and after the second, of which the slab holds one.
    vec2 outside = quadratic_segment(-a, -b, -c);
    if (outside.x > outside.y) {
        return slab;
    }
    vec2 before = intersect(slab, vec2(-1.0e30, outside.x));
    return before.x < before.y ? before : intersect(slab, vec2(outside.y, 1.0e30));
}

// Where the line origin + t direction is inside the solid; empty (x > y) where it misses it.
vec2 volume_segment(uint v, vec3 origin, vec3 direction) {
    vec3 scale = 1.0 / volumes[v].half_extent_m;
    vec3 o = (origin - volumes[v].center) * scale;
    vec3 d = direction * scale;
    uint shape = volumes[v].shape;
    if (shape == BOX) {
        return box_segment(o, d);
    }
    if (shape == SPHERE) {
        return quadratic_segment(dot(d, d), dot(o, d), dot(o, o) - 1.0);
    }
    return frustum_segment(o, d, volumes[v].radii);
}

// Where the line is inside the box around the solid, which is the box of its tables.
vec2 bounds_segment(uint v, vec3 origin, vec3 direction) {
    vec3 scale = 1.0 / volumes[v].half_extent_m;
    return box_segment((origin - volumes[v].center) * scale, direction * scale);
}

// How far inside the solid a point is: 0 on the boundary, 1 in the middle, negative outside.
float inwardness(uint v, vec3 point) {
    vec3 q = (point - volumes[v].center) / volumes[v].half_extent_m;
    uint shape = volumes[v].shape;
    if (shape == BOX) {
        vec3 inside = 1.0 - abs(q);
        return min(inside.x, min(inside.y, inside.z));
    }
    if (shape == SPHERE) {
        return 1.0 - length(q);
    }
    vec2 radii = volumes[v].radii;
    float radius = mix(radii.x, radii.y, clamp(0.5 * q.y + 0.5, 0.0, 1.0));
    return min(1.0 - abs(q.y), radius - length(q.xz));
}
