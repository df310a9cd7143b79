// A chain of dependent integer operations that no compiler can shorten (PCG's generator step).
uint run_chain(uint seed, uint iterations) {
    uint state = seed;
    for (uint i = 0u; i < iterations; i++) {
        state = state * 747796405u + 2891336453u;
        state ^= state >> 15;
    }
    return state;
}

float unit_float(uint state) {
    return float(state >> 8) / 16777216.0;
}
