layout(push_constant, std430) uniform Object {
    mat4 to_clip; // from the world; w is the depth along the view's axis in metres
} object;
