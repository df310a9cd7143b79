// Parts of the lava's surface that shine each as one, three vectors each: place in metres and area in square metres; unit normal and the
// number of all lamps; light, linear for a black body's, else the display's.

// Light that comes back from a white surface with this normal. A lamp that is nearer than it is large shines as a disc of its size
// would (its area over the squared distance, and at most half of the sky). Nothing casts a shadow.
vec3 light_of(vec4 lamp, vec3 direction, vec3 light, vec3 place_m, vec3 normal) {
    vec3 way_m = lamp.xyz - place_m;
    float squared = max(dot(way_m, way_m), 1.0e-12);
    float seen = max(dot(way_m, normal), 0.0) * max(-dot(way_m, direction), 0.0) / squared;
    float disc = lamp.w / 3.14159265;
    return light * seen * disc / (squared + disc);
}
