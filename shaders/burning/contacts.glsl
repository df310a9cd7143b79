// Where a part meets the ground: in each of eight directions the vertex that a plane leaning that way would touch first,
// and the lowest one; and how far those near the ground reach, by which a part stands or topples. They are the lowest or
// greatest of integers, so that no order of threads changes them.

const uint DIRECTIONS = 8u;
const uint CONTACTS = DIRECTIONS + 1u;
const uint WORDS = 48u; // of a part: reaches, heights of the contacts, their vertices, gaps of the meetings, theirs
const uint GAPS = DIRECTIONS + 2u * CONTACTS;
const uint ENTRIES = 65536u; // of a layer of the table of balls
const uint LAYERS = 3u; // of balls; two more of parts
const float STEPS_A_DIAGONAL = 1048576.0;
const float LEAN = 0.1; // slope of the leaning planes
const float NEAR_GROUND = 0.01; // diagonals
const int FARTHEST = 0x7fffffff;

vec2 direction(uint k) {
    const float r = 0.70710678;
    vec2 directions[8] = vec2[8](
        vec2(1.0, 0.0), vec2(r, r), vec2(0.0, 1.0), vec2(-r, r), vec2(-1.0, 0.0), vec2(-r, -r), vec2(0.0, -1.0), vec2(r, -r)
    );
    return directions[k & 7u];
}

int steps_of(float diagonals) {
    return int(floor(clamp(diagonals, -1000.0, 1000.0) * STEPS_A_DIAGONAL));
}

// Height over the plane that leans in direction k.
int height_over(vec3 position, uint k) {
    float lean = k < DIRECTIONS ? LEAN * dot(direction(k), position.xz) : 0.0;
    return steps_of(position.y - lean);
}
