// The end of a hash of a place of a lattice: its bits mixed, 0 to 65,535.

float mixed(uint h) {
    h ^= h >> 15u;
    h *= 0x846ca68bu;
    h ^= h >> 16u;
    return float(h & 0xffffu);
}
