// A forest over the vertices: each tree is what is known to hang together, its root the vertex of the lowest number. No
// order of threads changes the trees that are left in the end. Loops are short, as drivers end long ones; what they
// leave the next dispatch takes up.

layout(set = 0, binding = 60, std430) coherent buffer Roots {
    uint roots[];
};

const uint STEPS = 128u;
const uint TRIES = 8u;

uint root_of(uint vertex) {
    uint at = vertex;
    for (uint i = 0u; i < STEPS; i++) {
        uint above = roots[at];
        if (above == at) {
            return at;
        }
        uint next = roots[above];
        atomicMin(roots[at], next);
        at = next;
    }
    return at;
}

void unite(uint a, uint b) {
    for (uint i = 0u; i < TRIES; i++) {
        a = root_of(a);
        b = root_of(b);
        if (a == b) {
            return;
        }
        uint high = max(a, b);
        if (atomicCompSwap(roots[high], high, min(a, b)) == high) {
            return;
        }
    }
}
