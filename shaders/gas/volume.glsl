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

// theta = (frame_num mod SWIRL_FRAMES) SWIRL with SWIRL = 2 pi / SWIRL_FRAMES: the text prints a product for the
// remainder.
vec2 helix_of(Volume moved) {
    float frames = moved.swirl_frames;
    if (frames <= 0.0) {
        return vec2(0.0);
    }
    float theta = 6.2831853 * (frame.number - frames * floor(frame.number / frames)) / frames;
    return moved.ellipse * vec2(cos(theta), sin(theta));
}
