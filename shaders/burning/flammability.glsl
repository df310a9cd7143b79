// L of the vertices before the fire, ticks (table 3.1); 0 for what does not burn. Where all have the same there is one
// number.

layout(set = 0, binding = 78, std430) readonly buffer Flammabilities {
    float flammabilities[];
};

float flammability_of(uint vertex) {
    return flammabilities[vertex * constants.level_stride];
}
