// Angles on a round base, to single precision: the built-in functions promise much less.

// The angle of (x, y), -pi to pi.
float arc_tangent(float y, float x) {
    float a = abs(y);
    float b = abs(x);
    float t = min(a, b) / max(max(a, b), 1.0e-30);
    bool is_steep = t > 0.41421356;
    float s = is_steep ? (t - 1.0) / (t + 1.0) : t;
    float z = s * s;
    float angle = s + s * z * (-3.33329491539e-1 + z * (1.99777106478e-1 + z * (-1.38776856032e-1 + z * 8.05374449538e-2)));
    angle += is_steep ? 0.785398163 : 0.0;
    angle = a > b ? 1.570796327 - angle : angle;
    angle = x < 0.0 ? 3.141592654 - angle : angle;
    return y < 0.0 ? -angle : angle;
}

// Of an angle up to pi/2.
float sine(float x) {
    float z = x * x;
    float tail = 1.0 / 362880.0 - z / 39916800.0;
    return x + x * z * (-1.0 / 6.0 + z * (1.0 / 120.0 + z * (-1.0 / 5040.0 + z * tail)));
}

float cosine(float x) {
    float z = x * x;
    float tail = 1.0 / 40320.0 + z * (-1.0 / 3628800.0 + z / 479001600.0);
    return 1.0 + z * (-0.5 + z * (1.0 / 24.0 + z * (-1.0 / 720.0 + z * tail)));
}

// An ellipse's point at a latitude that differs by `delta` from the map's middle: sine and cosine of the latitude; how the
// point lies to the middle's, off and along the axis. Written in differences, so that nothing of a planet's size cancels.
struct Meridian {
    float s;
    float c;
    float off;
    float along;
    float cross_radius; // of curvature, across the meridian
    float radius; // and along it
};

Meridian meridian_at(float delta) {
    float a = terrain.semi_major_m;
    float e2 = terrain.squared_eccentricity;
    float s0 = terrain.sine_latitude;
    float c0 = terrain.cosine_latitude;
    float sh = sine(0.5 * delta);
    float ch = cosine(0.5 * delta);
    float ds = 2.0 * sh * (c0 * ch - s0 * sh);
    float dc = -2.0 * sh * (s0 * ch + c0 * sh);
    float s = s0 + ds;
    float c = c0 + dc;
    float w0 = sqrt(1.0 - e2 * s0 * s0);
    float w = sqrt(1.0 - e2 * s * s);
    float n = a / w;
    float dn = a * e2 * ds * (s + s0) / ((w0 + w) * w * w0);
    return Meridian(s, c, n * dc + dn * c0, (1.0 - e2) * (n * ds + dn * s0), n, a * (1.0 - e2) / (w * w * w));
}

// Latitude as a difference from the map's middle, and height, of a point in the plane of a meridian: Newton's method for the
// foot of the normal.
vec2 geodetic(float off, float along) {
    float e2 = terrain.squared_eccentricity;
    float s0 = terrain.sine_latitude;
    float c0 = terrain.cosine_latitude;
    float n0 = terrain.semi_major_m / sqrt(1.0 - e2 * s0 * s0);
    float axis_m = (terrain.axis_distance_m + off) * (1.0 - e2);
    float delta = arc_tangent(n0 * (1.0 - e2) * s0 + along, axis_m) - arc_tangent(s0, c0);
    float height_m = 0.0;
    for (int i = 0; i < 4; i++) {
        Meridian foot = meridian_at(delta);
        float r = off - foot.off;
        float w = along - foot.along;
        height_m = r * foot.c + w * foot.s;
        delta += (w * foot.c - r * foot.s) / max(foot.radius + height_m, 1.0e-6 * foot.radius);
    }
    return vec2(delta, height_m);
}

// A point in metres from the map's middle on the base (east, off the axis, along the axis) in the map's coordinates; `side` is
// that of the half-plane behind the axis that longitudes are counted to.
vec3 map_coordinates(vec3 point, float side) {
    float off = terrain.axis_distance_m + point.y;
    float radius = length(vec2(point.x, off));
    float longitude = 0.0;
    vec2 found = vec2(0.0);
    // A loop of one turn, which compilers that unroll take away: without it SwiftShader's needs minutes and more than 20 GB.
    for (int once = 0; once < 1; once++) {
        longitude = arc_tangent(point.x, off);
        if (off < 0.0) {
            longitude = side < 0.0 ? -abs(longitude) : abs(longitude);
        }
        float grown = off > 0.0 ? point.y + point.x * point.x / (radius + off) : radius - terrain.axis_distance_m;
        found = vec2(point.z, grown);
        if (!is_kind(terrain.base_kind, CYLINDER, radius)) {
            found = geodetic(grown, point.z);
        }
    }
    return vec3(terrain.middle_node.x + longitude * terrain.nodes_per_unit.x,
                terrain.middle_node.y + found.x * terrain.nodes_per_unit.y,
                terrain.base_height + found.y / terrain.height_unit_m);
}

// F = P + n h (eq. 6): the point over a place in nodes, in the map's frame.
vec3 frame_point(vec2 place, float height) {
    float away = max(abs(place.x), abs(place.y));
    if (is_kind(terrain.base_kind, PLANE, away)) {
        return vec3(place, height);
    }
    vec2 moved = (place - terrain.middle_node) / terrain.nodes_per_unit;
    float height_m = (height - terrain.base_height) * terrain.height_unit_m;
    float sh = sine(0.5 * moved.x);
    float s = 2.0 * sh * cosine(0.5 * moved.x);
    float dc = -2.0 * sh * sh;
    float off = height_m;
    float along = moved.y;
    if (!is_kind(terrain.base_kind, CYLINDER, away)) {
        Meridian foot = meridian_at(moved.y);
        off = foot.off + height_m * foot.c;
        along = foot.along + height_m * foot.s;
    }
    // (middle + off) (cosine, sine) of the longitude, less the middle.
    return vec3((terrain.axis_distance_m + off) * s, off + (terrain.axis_distance_m + off) * dc, along);
}
