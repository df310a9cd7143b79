// Constants of a block (table 3.1): means over its vertices at rest.

struct BlockLevels {
    float beta; // displacement
    float rho; // density
    float phi; // bond strength
    float flammability; // L of what burns, ticks; at least 1
};

layout(set = 0, binding = 80, std430) readonly buffer BlockConstants {
    BlockLevels block_levels[];
};
