// Numbers of the crust; a storage buffer's, since drivers compile a shader anew for each constant that a branch sees.

layout(set = 0, binding = 11, std430) readonly buffer Crust {
    float rope_m; // length of a rope along the skin; 0 without any
    float piece_m; // length of a piece; 0 where nothing breaks
    float jumble; // height by which pieces are raised and tilted, over their length
    float healing_s; // time in which new crust closes a gap
    float kept; // share of the particles in the middle of a piece
    float melt_k; // where there is no crust
    float solidus_k; // where there is nothing else
    float ambient_k;
    float radiance; // of a crust's face, as in face.glsl
    float least_m; // depth of lava that bears all of the crust's relief
    float seam_m; // depth of the seam between two toes; 0 where there are none
} crust;
