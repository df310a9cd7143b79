// A material to the eye, of an object of several.

struct Appearance {
    vec3 albedo; // linear RGB
    float charring; // 1 of what chars
    vec3 embers; // linear RGB of its glow
    float grain; // 1 for the rings of a tree
};
