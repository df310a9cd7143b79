// Connected parts of the object that fall as rigid bodies: ours, the dissertation's fall apart in place. A part moves
// its vertices, turned with their blocks, from their places in the object to the world. Forces are accelerations, so
// that masses count only against each other.

const uint MOST_PARTS = 1024u;
const uint DUST = MOST_PARTS; // of a part beyond the most
const uint NO_PART = 0xffffffffu; // of a vertex without triangles, and before parts are known

struct Part {
    vec4 orientation; // unit quaternion
    vec3 offset; // diagonals
    float rests; // 1 while it lies still
    vec3 velocity; // of the centre of mass, diagonals a second
    float fallen_ticks; // since it last lay still
    vec3 spin; // radians a second
    float weight; // of its vertices
    vec3 center; // of mass, a place in the object
    float energy; // over its weight, with that of its height
    vec3 anchor; // the place about which its moments are taken
    float extent; // root of the mean squared distance from the centre
};

vec3 turned(vec4 orientation, vec3 v) {
    vec3 t = cross(orientation.xyz, v) + orientation.w * v;
    return v + 2.0 * cross(orientation.xyz, t);
}
