// Triangles are drawn in the order that a vertex cache likes best.

layout(set = 0, binding = 56, std430) readonly buffer DrawOrder {
    uint draw_order[]; // triangles
};

uint drawn_triangle(uint place) {
    return draw_order[place];
}
