// Invocations of each pass whose loops were left before their end, of all frames since the host last looked; of
// intersect 1 for any number of them.
layout(std430, set = 0, binding = 9) buffer Unfinished {
    uint intersect;
    uint land;
    uint straddle;
} unfinished;

// Set where a loop is left before its end.
bool is_cut = false;
