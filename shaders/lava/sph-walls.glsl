// Walls of the fluid: the bed and the four sides.

// Distances from the bed, as from the plane that touches it below, and from the four sides, over h; no wall is out of reach.
struct Walls {
    float bed_q;
    vec3 up; // away from the bed
    vec4 sides_q; // low x, high x, low z, high z
};

Walls walls_at(vec3 place_m) {
    vec2 high = flow.space_m.xz - place_m.xz;
    vec4 sides = vec4(place_m.x, high.x, place_m.z, high.y) / flow.support_m + flow.periodic * 2.0;
    vec3 ground = bed_at(place_m.xz / flow.space_m.xz);
    vec3 up = normalize(vec3(-ground.x, 1.0, -ground.y));
    return Walls(max((place_m.y - ground.z) * up.y / flow.support_m, 0.0), up, max(sides, 0.0));
}

// Share of the kernel's sum that a half space of lava beyond a wall has, by the distance: the kernel's integral.
float beyond(float q) {
    float u = max(1.0 - q, 0.0);
    float cubed = u * u * u;
    return cubed * cubed * (3.5 - 4.5 * u + 1.5 * u * u);
}

// How fast it falls with the distance, per h.
float beyond_slope(float q) {
    float u = max(1.0 - q, 0.0);
    float squared = u * u;
    return 21.0 * squared * squared * u * (1.0 - 1.5 * u + 4.0 / 7.0 * squared);
}

float wall_share(Walls walls) {
    vec4 q = walls.sides_q;
    return beyond(walls.bed_q) + beyond(q.x) + beyond(q.y) + beyond(q.z) + beyond(q.w);
}

// Gradient of the walls' share, times h.
vec3 wall_gradient(Walls walls) {
    vec4 q = walls.sides_q;
    float along_x = beyond_slope(q.y) - beyond_slope(q.x);
    float along_z = beyond_slope(q.w) - beyond_slope(q.z);
    return vec3(along_x, 0.0, along_z) - beyond_slope(walls.bed_q) * walls.up;
}

// The drag of a half space whose speed goes on linearly through 0 at the wall (Morris et al. 1997), integrated.
float drag_beyond(float q) {
    float u = max(1.0 - q, 0.0);
    float squared = u * u;
    return squared * squared * u * (21.0 - 31.5 * u + 12.0 * squared) / max(q, 1.0e-3);
}

float wall_drag(Walls walls) {
    vec4 q = walls.sides_q;
    return drag_beyond(walls.bed_q) + drag_beyond(q.x) + drag_beyond(q.y) + drag_beyond(q.z) + drag_beyond(q.w);
}
