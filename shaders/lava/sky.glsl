// Daylight on a fluid and its ground: a sky that is brightest low above one side, so that folds cast their own shade. In the
// display's values, of a white surface.

const vec3 BRIGHTEST = vec3(-0.62, 0.55, 0.56);

const vec3 SKY = vec3(0.8, 0.9, 1.1);

vec3 sky_on(vec3 normal) {
    float lit = 0.5 + 0.5 * dot(normal, BRIGHTEST);
    return SKY * lit * lit;
}

// What a mirror shows of it in a direction, blurred as by a skin that is rough.
vec3 sky_towards(vec3 direction) {
    float lit = 0.5 + 0.5 * dot(direction, BRIGHTEST);
    float squared = lit * lit;
    return SKY * squared * squared * squared;
}
