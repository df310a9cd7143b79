// Triangles, or nodes of the refinement pattern, that one thread counts and writes, so that no barriers stand between.
const uint RUN = 16u;
