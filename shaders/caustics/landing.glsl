// The end of the ray of a vertex of the refined water (section 6.3). A list holds whole vectors, as that of the rays does.
struct Landing {
    vec3 place; // texels in x and y, the height in z, metres
    float weight; // 1 / cos theta_t e^(-K d); -1 for a ray that does not land, -2 without light
};

Landing landing_of(vec4 whole) {
    return Landing(whole.xyz, whole.w);
}

vec4 whole_of(Landing landing) {
    return vec4(landing.place, landing.weight);
}
