// What a surface is made of.

struct Object {
    vec3 color; // linear RGB
    float opacity;
    vec3 checker_color; // of every other square, linear RGB
    float checker_edge_m; // of a square; 0 for a plain object
    vec3 offset_m;
    float highlight_strength; // Phong's
    float highlight_exponent;
    uint is_two_sided; // 1 when seen from both sides
    int solid_texture; // its entry in the volumes, or -1
    float fade_m; // depth before the opaque surface behind it over which a surface-defined gas fades, 0 for none
    vec2 ends_m; // distances in x and z from its origin at which such a gas has faded out, 0 for none
    float rim; // cosine between normal and ray below which such a gas fades towards its silhouette, 0 for none
    vec3 vein_color; // where a solid texture is dense, linear RGB
    int veins; // its entry in the volumes, or -1
};
