// A ray is WHOLE units long; what halving makes of it begins and ends at whole units.

// A subsegment of one unit is intersected whatever it touches. Single precision counts them exactly.
const int WHOLE = 1 << 23;

vec3 point_on(Subsegment subsegment, float fraction) {
    return mix(subsegment.near, subsegment.far, fraction);
}
