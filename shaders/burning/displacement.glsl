// The position that a triangle ABC moves its vertex B to (3.4, figure 3.4): the intersection of the cevians from A and
// C to P1 and P2, which lie the fractions m and l along BC and BA. The printed X, Y, Z exchange P1 and P2 and so return
// B itself; this is their intersection for every triangle: B for l = m = 0, inside the triangle below 1.

// Bond strength (3.4): weaker by phi where the other end is heated too. L counts as a fraction, and lengths in mean
// rest edges, so that beta means the same on every mesh. A length of zero displaces nothing; half the edge is the most.
// beta, rho and phi are those of the vertex's block at rest.
float fraction_along(BlockLevels block, float edge, bool is_heated, float left_fraction) {
    if (edge <= 0.0) {
        return 0.0;
    }
    float phi = is_heated ? block.phi : 1.0;
    float beta = block.beta;
    float rho = block.rho;
    return min(0.5, phi * beta * rho * left_fraction * constants.mean_edge / edge);
}

vec3 cevians_meet(vec3 a, vec3 b, vec3 c, float l, float m) {
    return (l * (1.0 - m) * a + (1.0 - l) * (1.0 - m) * b + m * (1.0 - l) * c) / (1.0 - l * m);
}
