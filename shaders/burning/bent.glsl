// A place in the object, bent with its sections: what is ours, before a part moves it to the world.

#include "burning/parts.glsl"
#include "burning/sections.glsl"

#if !defined(OBJECT_WHOLE) && !defined(OBJECT_FREE)
layout(set = 0, binding = 101, std430) readonly buffer Bends {
    Bend bends[]; // of vertices
};

vec3 bent(uint vertex, vec3 place) {
    return turned(bends[vertex].turn, place) + bends[vertex].offset;
}
#endif
