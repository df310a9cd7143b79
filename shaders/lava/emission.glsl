// Light of black bodies by temperature (chapter 9): a table of linear red, green and blue, candela per square metre, from 0
// to 10,000 K, linear between its entries.

layout(set = 0, binding = 6, std430) readonly buffer Emission {
    vec4 list[];
} emission;

const float ENTRIES_A_KELVIN = 0.4095;
const float LAST_ENTRY = 4094.0; // that has a next one

vec3 emitted(float kelvin) {
    float place = clamp(kelvin * ENTRIES_A_KELVIN, 0.0, LAST_ENTRY + 1.0);
    float entry = min(floor(place), LAST_ENTRY);
    return mix(emission.list[uint(entry)], emission.list[uint(entry) + 1u], place - entry).rgb;
}
