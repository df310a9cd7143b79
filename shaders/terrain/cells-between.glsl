// A height above the surface over a rectangle of the map, by levels whose texels bound whole cells.

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
    float highest = highest_of(level, first >> level, last >> level);
    return is_outside ? -NO_DEPTH : highest;
}
