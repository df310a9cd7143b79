// The counts of a block (3.5.1).

struct Block {
    int live; // vertices with some L left: its weight
    int ready; // live vertices in the combustion-ready area
    int pitch_sign; // sums of the signs of this tick's events (3.5.2)
    int yaw_sign;
    int roll_sign;
    int combustion; // ticks with active vertices (5.4)
    int heated; // vertices inside the combustion-ready boundary
    int last_active_tick;
};
