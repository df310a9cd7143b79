// A ray of light that meets the water, as the illumination volumes hold it (section 4.3).

struct Ray {
    vec3 origin; // along U, V, W from the light's reference point, metres
    float enters; // 1 where the ray enters the water, else 0
    vec2 slope; // movement along U and W per metre of descent along V
    float secant; // 1 / cos(theta_t): metres of the ray per metre of descent
    float _pad_slope; // 0
    vec3 incident; // direction of the light in air, along U, V, W, as long as the share of it that enters
    float _pad_incident; // 0
};
