// The area that a boundary of radius r has put a vertex into (3.3; with the virtual one of 4.3). R knows the irregularity
// already: inside is R <= r + offset. The number rises with r and falls with R.

uint area_of(float distance_to_boundary, float r) {
    float width = constants.area_width;
    if (distance_to_boundary <= r - 2.0 * width) {
        return DEFORMED;
    }
    if (distance_to_boundary <= r - width) {
        return READY;
    }
    if (distance_to_boundary <= r) {
        return INITIAL;
    }
    // Chapter 3 has no virtual area; nothing of it reads this label.
    return distance_to_boundary <= r + 2.0 * width ? VIRTUAL : OUTSIDE;
}
