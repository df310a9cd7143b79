// Numbers of particles to numbers that follow no order: O'Neill's permuted congruential generator (2014) of one word.

uint hashed(uint number) {
    uint state = number * 747796405u + 2891336453u;
    uint word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

// From 0 to below 1.
float evenly(uint number) {
    return float(hashed(number) >> 8u) / 16777216.0;
}
