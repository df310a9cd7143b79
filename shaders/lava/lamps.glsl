// A part of the lava's surface that shines as one. A list holds whole vectors, three a lamp: place and area; direction and the number of
// all lamps; light.
struct Lamp {
    vec3 place_m;
    float area_m2;
    vec3 direction; // unit normal
    vec3 light; // linear for a black body's, else the display's
};

Lamp lamp_of(vec4 place, vec4 direction, vec4 light) {
    return Lamp(place.xyz, place.w, direction.xyz, light.rgb);
}

// Light that comes back from a white surface with this normal. A lamp that is nearer than it is large shines as a disc of its size
// would (its area over the squared distance, and at most half of the sky). Nothing casts a shadow.
vec3 light_of(Lamp lamp, vec3 place_m, vec3 normal) {
    vec3 to_lamp_m = lamp.place_m - place_m;
    float squared = max(dot(to_lamp_m, to_lamp_m), 1.0e-12);
    float seen = max(dot(to_lamp_m, normal), 0.0) * max(-dot(to_lamp_m, lamp.direction), 0.0) / squared;
    float disc = lamp.area_m2 / 3.14159265;
    return lamp.light * seen * disc / (squared + disc);
}
