// Inputs of the fragment stages of a splat.

layout(location = 0) in vec2 disc; // from the centre, in radii along tangent and binormal
layout(location = 1) in float eye_depth_m;
layout(location = 2) flat in vec3 center_m;
