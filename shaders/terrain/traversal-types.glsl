// The part of a ray that can meet the map.
struct Span {
    float near_m; // depth of its ends, metres
    float far_m;
    int side; // the surface it comes in through
};

// A piece of a ray in the map's frame (eq. 9), and the depth of its near end.
struct Segment {
    vec3 near;
    vec3 far;
    float depth_m;
};
