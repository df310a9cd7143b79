// The nearest ball of another part.

#include "burning/meeting.glsl"

layout(set = 0, binding = 76, std430) readonly buffer Balls {
    uint balls[]; // vertex, NONE without any
};

struct Meeting {
    uint vertex; // NONE without any
    vec3 toward; // from it, a unit vector
    float gap; // diagonals, below 0 where the balls overlap
};

vec3 position_of(uint vertex) {
    uint block = cells[vertex];
    vec3 place = bent(vertex, rotated_with_block(new_state[vertex].position, block, new_rotations[block].xyz));
    uint part = min(part_of[vertex], MOST_PARTS - 1u);
    return turned(parts[part].orientation, place) + parts[part].offset;
}

// True where the larger cells hold no ball of another part in this cell and those around it.
bool is_among_its_own(uint part, ivec3 middle) {
    ivec3 low = (middle - 1) >> LARGER;
    ivec3 high = (middle + 1) >> LARGER;
    bool is_alone = true;
    for (int i = 0; i < 8; i++) {
        ivec3 cell = ivec3((i & 1) == 0 ? low.x : high.x, (i & 2) == 0 ? low.y : high.y, (i & 4) == 0 ? low.z : high.z);
        bool has_lower = balls[entry_of(LOWEST_PART, cell)] < part;
        bool has_higher = balls[entry_of(HIGHEST_PART, cell)] < ~part;
        is_alone = is_alone && !has_lower && !has_higher;
    }
    return is_alone;
}

Meeting meeting_of(uint part, vec3 position) {
    Meeting nearest = Meeting(NONE, vec3(0.0), 0.0);
    float width = ball_width();
    ivec3 middle = cell_at(position);
    if (is_among_its_own(part, middle)) {
        return nearest;
    }
    for (int i = 0; i < 27 * int(LAYERS); i++) {
        int at = i % 27;
        ivec3 cell = middle + ivec3(at % 3, (at / 3) % 3, at / 9) - 1;
        uint other = balls[entry_of(uint(i / 27), cell)];
        // A part's own balls, most of those near it, are no business of its own.
        if (other != NONE && part_of[other] != part) {
            vec3 apart = position - position_of(other);
            float distance_apart = length(apart);
            bool is_near = distance_apart > 1e-6 && distance_apart < 2.0 * width;
            if (is_near && (nearest.vertex == NONE || distance_apart - width < nearest.gap)) {
                nearest = Meeting(other, apart / distance_apart, distance_apart - width);
            }
        }
    }
    return nearest;
}
