// Eq. 4-18: I_c = I_i (A_w cos theta_i) / (A_d cos theta_t) e^(-K d), flux per area perpendicular to the beam.
//
// A_w and A_d belong to a triangle, while indexed vertices are shared by six. The point of the water that a fragment's light
// left is linear over the intersection triangle, so the cross product of its derivatives is the water triangle's area vector
// (area A_w along the face normal) for one texel of the plane; against the incident ray that is A_w cos theta_i / A_d times
// the texel's area, exactly, and the same for every fragment of a triangle. `weight` holds the incident ray times
// e^(-K d) / cos theta_t of each vertex, between them linear.

float intensity(vec3 water_dx, vec3 water_dy, vec3 weight, vec3 up, float texel_area_m2) {
    // Beyond its focus a beam is turned over, which changes the sign of the area and nothing else: a face's front is its upper side.
    vec3 area = cross(water_dx, water_dy);
    float passing = -sign(dot(area, up)) * dot(area, weight);
    // A face that is turned away passes nothing, whatever the normals of its vertices say.
    return max(passing, 0.0) / texel_area_m2;
}

// A triangle lights nothing when one of its rays does not: between the vertices `lit` is then below 1.
bool is_lit(float lit) {
    return lit > 0.9999;
}
