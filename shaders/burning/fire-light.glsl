// A light of the flames: all fire particles of a cell of the box around them, as one ball of light.

struct FireLight {
    vec3 position; // mean of the particles', diagonals
    float radius; // of the ball, diagonals
    vec3 intensity; // irradiance over pi at a distance of 1 diagonal, linear RGB
    float count; // of the lights, in each
};

// Cells of the box along each axis, and in all.
const int LIGHT_CELLS = 3;
const uint MOST_LIGHTS = 27u;
