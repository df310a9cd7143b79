// Unpolarised reflectance of a dielectric; `eta` is the refraction index before the surface over that behind it.
float fresnel(float cos_incident, float cos_refracted, float eta) {
    float parallel = (cos_incident - eta * cos_refracted) / (cos_incident + eta * cos_refracted);
    float perpendicular = (eta * cos_incident - cos_refracted) / (eta * cos_incident + cos_refracted);
    return 0.5 * (parallel * parallel + perpendicular * perpendicular);
}
