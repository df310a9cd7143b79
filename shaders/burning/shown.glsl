// The last picture, so that the next one makes those normals anew alone that have changed since.

layout(push_constant, std430) uniform Shown {
    uint since; // tick from which on what is touched is new; 0 where everything is
} shown;
