// The display's tone: as it is up to the knee, above it ever less, so that nothing reaches 1 (knee 0.6). With a knee of 1
// what is brighter than the display is clipped. Ours: neither the thesis of the lava nor the dissertation of the burning
// objects has one, nor numbers that would need one.
vec3 toned(vec3 color, float exposure, float knee) {
    vec3 exposed = exposure * color;
    float room = max(1.0 - knee, 1.0e-6);
    vec3 bent = knee + room * (1.0 - exp(-max(exposed - knee, 0.0) / room));
    // No branch: drivers compile a shader anew for each value that a branch on constants sees.
    return mix(exposed, bent, step(vec3(knee), exposed));
}
