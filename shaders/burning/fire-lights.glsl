// The lights of the flames, as passes that draw read them: all of them, of which those beyond their count are dark.

#include "burning/fire-light.glsl"

layout(set = 0, binding = 53, std140) uniform FireLights {
    FireLight fire_lights[27];
};
