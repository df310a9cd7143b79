// Moments of a part: sums over its vertices of weight, place and products of places, about its anchor. They are sums of
// integers, so that no order of threads changes them: a number is cut into two words of so many bits that no sum of a
// word passes 32.

#include "burning/parts.glsl"

const uint MOMENTS = 19u; // words of a part: its weight; of x, y, z, xx, yy, zz, xy, xz, yz the low and the high one
const float REACH = 2.0; // diagonals, of a place from the anchor; of a product its square
