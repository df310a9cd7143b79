// A particle of smoke by its age, 0 to 1, and a random number of its own.

// Half its square, over the particle's radius: it spreads.
float smoke_size(float age, float own) {
    return (0.45 + 0.55 * age) * (0.75 + 0.25 * own);
}

// Opacity where its noise leaves it whole.
float smoke_opacity(float age) {
    return 0.3 * smoothstep(0.0, 0.2, age) * (1.0 - age);
}

// Linear RGB where flames shine on nothing: young smoke is lit by the fire beneath it, by a rule of its age.
vec3 smoke_by_itself(float age) {
    return mix(vec3(0.11, 0.075, 0.05), vec3(0.1), smoothstep(0.0, 0.5, age));
}

// By the light of the flames: what it shows by itself, and of the light that reaches it what it scatters.
const vec3 SMOKE_GREY = vec3(0.1);
const float SMOKE_ALBEDO = 0.4;
