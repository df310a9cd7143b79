// A vertex's place in the object, bent and moved to the world with its part, where parts fall.

#include "burning/bent.glsl"

#ifdef OBJECT_PARTS
layout(set = 0, binding = 65, std430) readonly buffer PartOf {
    uint part_of[];
};

layout(set = 0, binding = 66, std430) readonly buffer Parts {
    Part parts[];
};

vec3 posed(uint vertex, vec3 place) {
    vec3 own = bent(vertex, place);
    uint part = part_of[vertex];
    if (part >= MOST_PARTS) {
        return own;
    }
    return turned(parts[part].orientation, own) + parts[part].offset;
}
#endif
