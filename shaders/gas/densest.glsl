// The densest that a gas is, opaque over any way: a high power of the turbulence leaves single precision, and of infinity comes what is
// no number.
const float MOST_DENSITY = 1.0e12;
