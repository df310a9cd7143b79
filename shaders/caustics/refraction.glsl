// Snell's law for vectors, eq. 2-8: T = (eta_1/eta_2) I + ((eta_1/eta_2) cos theta_I - cos theta_T) N, unit vectors, N against
// I. The printed sign inside the bracket is that of a normal along I.

// `eta` is eta_1/eta_2. False when the light comes from behind or is totally reflected; the ray is then untouched.
bool refract_ray(vec3 incident, vec3 normal, float eta, out vec3 refracted) {
    float cos_incident = -dot(incident, normal);
    float sin2_refracted = eta * eta * (1.0 - cos_incident * cos_incident);
    if (cos_incident <= 0.0 || sin2_refracted > 1.0) {
        refracted = incident;
        return false;
    }
    refracted = normalize(eta * incident + (eta * cos_incident - sqrt(1.0 - sin2_refracted)) * normal);
    return true;
}
