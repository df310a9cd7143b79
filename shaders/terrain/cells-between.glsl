// A height above the surface over a rectangle of the map, by levels whose texels bound whole cells.

// A height above the surface over a block of cells.
float highest_over(int level, ivec2 block) {
    float highest = value_above(1, level, block);
#ifdef INTERPOLATION_BICUBIC
    highest += 9.0 / 32.0 * (highest - value_above(2, level, block));
#endif
    return highest;
}

// Between two places, by texels of a level or coarser ones; far below all heights where no map is.
float highest_between(vec2 low, vec2 high, int shift) {
    vec2 end = vec2(map.last);
    bool is_outside = high.x < 0.0 || high.y < 0.0 || low.x > end.x || low.y > end.y;
    ivec2 last_cell = max(map.last - 1, ivec2(0));
    ivec2 first = clamp(ivec2(floor(low)), ivec2(0), last_cell);
    ivec2 last = clamp(ivec2(floor(high)), ivec2(0), last_cell);
    int least = max(shift, 1);
    ivec2 touched = (last >> least) - (first >> least);
    int level = max(min(least + shift_for(float(max(touched.x, touched.y))), map.top), 1);
    ivec2 a = first >> level;
    ivec2 b = last >> level;
    float north = max(highest_over(level, a), highest_over(level, ivec2(b.x, a.y)));
    float south = max(highest_over(level, ivec2(a.x, b.y)), highest_over(level, b));
    float highest = max(north, south);
    return is_outside ? -NO_DEPTH : highest;
}
