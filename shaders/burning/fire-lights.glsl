// The lights of the flames, as passes that draw read them.

#include "burning/fire-light.glsl"

layout(set = 0, binding = 53, std430) readonly buffer FireLights {
    FireLight fire_lights[];
};
