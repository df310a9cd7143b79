// Moments of a part: sums over its vertices of weight, place and products of places, about its anchor. They are sums of
// integers, so that no order of threads changes them: a number is cut into two halves, and the sum of each is of 64 bits, whose
// upper ones count how often the lower ones went past their end.

#include "burning/parts.glsl"

const uint SUMS = 19u; // of a part: its weight; of x, y, z, xx, yy, zz, xy, xz, yz the lower and the upper half
const uint MOMENTS = 2u * SUMS; // words, of each sum the lower bits before the upper ones
const uint HALF_BITS = 12u; // both are a float's 24
const float REACH = 2.0; // diagonals, of a place from the anchor; of a product its square
