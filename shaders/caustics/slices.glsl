// Planes of the sub-box that a level belongs to. A list holds whole vectors: fewer loads, where one costs by itself.
struct Slices {
    float top; // metres from the box's centre
    float cells_per_m;
    float first_plane;
    float last_plane;
};

Slices slices_of(vec4 whole) {
    return Slices(whole.x, whole.y, whole.z, whole.w);
}

vec4 whole_of(Slices slices) {
    return vec4(slices.top, slices.cells_per_m, slices.first_plane, slices.last_plane);
}
