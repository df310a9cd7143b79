// What the passes `corners` and `coarser` know of a map whose levels they write anew.

layout(set = 0, binding = 0) uniform utexture2DArray levels;

layout(push_constant, std430) uniform Packing {
    ivec2 last; // column and row of the data
    ivec2 beside; // where the coarser levels begin, beside the data
    ivec2 axis; // (1, 0) or (0, 1): along which they lie
    int top; // levels above the data
    int is_float; // texels are bits of floats
} packing;
