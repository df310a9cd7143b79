// Accepted grid points as splats under the orthographic camera from above (section 6.3).

layout(push_constant, std430) uniform Grid {
    vec2 space_m; // along x and z
    vec2 columns; // grid points along x and z
    float radius_m; // R_i of eq. 6.3
} grid;

// A quad is larger than its splat, in columns, by more than any device rounds places to: the grid points on the radius are the
// fragment stage's to decide.
const float MARGIN = 0.125;

// The clip position of a corner, -1 or 1 along either axis.
vec4 corner_of(vec3 point_m, vec2 corner) {
    vec2 place_m = point_m.xz + corner * (grid.radius_m + MARGIN * grid.space_m / grid.columns);
    return vec4(2.0 * place_m / grid.space_m - 1.0, 0.5, 1.0);
}
