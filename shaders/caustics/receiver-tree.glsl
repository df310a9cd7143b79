// The receivers' triangles in a tree of boxes, children after their parents: `skip` is the node after all that lies in a box.

struct Node {
    vec3 low; // corners of the box, metres
    uint skip; // next node when the box is missed
    vec3 high;
    uint leaf; // first triangle times 8 and their number; 0 for a node with children
};

layout(std430, set = 0, binding = 5) readonly buffer Nodes {
    Node list[];
} nodes;

layout(std430, set = 0, binding = 6) readonly buffer Corners {
    float list[]; // x, y, z of each, metres
} corners;

layout(std430, set = 0, binding = 7) readonly buffer Triangles {
    uint list[]; // three corners of each
} triangles;

const float EDGE_SLACK = 1.0e-5; // rounding must not let a ray through between two triangles

struct Hit {
    float distance_m; // negative where nothing is hit
    vec3 normal; // of the face, unit length, either side
};

vec3 corner_at(uint index) {
    return vec3(corners.list[3u * index], corners.list[3u * index + 1u], corners.list[3u * index + 2u]);
}

// The first triangle that a ray of unit direction meets, on either side.
Hit first_hit(vec3 origin, vec3 direction, uint node_count) {
    vec3 inverse = 1.0 / mix(direction, vec3(1.0e-9), lessThan(abs(direction), vec3(1.0e-9)));
    float nearest_m = 1.0e30;
    vec3 normal = vec3(0.0, 1.0, 0.0);
    uint at = 0u;
    while (at < node_count) {
        Node node = nodes.list[at];
        // lavapipe runs the pixels beside a triangle's edge along with those inside, and lets them read nothing but zeros: they would
        // never come to an end, and use up the iterations that it grants to all loops of a shader together.
        if (node.skip <= at) {
            break;
        }
        vec3 to_low = (node.low - origin) * inverse;
        vec3 to_high = (node.high - origin) * inverse;
        vec3 enters = min(to_low, to_high);
        vec3 leaves = max(to_low, to_high);
        float entry = max(max(enters.x, enters.y), max(enters.z, 0.0));
        float exit = min(min(leaves.x, leaves.y), min(leaves.z, nearest_m));
        // A flat box is as thin as its rounding.
        if (entry > exit + 1.0e-5 * abs(exit)) {
            at = node.skip;
            continue;
        }
        uint first = node.leaf >> 3u;
        uint end = first + (node.leaf & 7u);
        for (uint triangle = first; triangle < end; triangle++) {
            vec3 a = corner_at(triangles.list[3u * triangle]);
            vec3 ab = corner_at(triangles.list[3u * triangle + 1u]) - a;
            vec3 ac = corner_at(triangles.list[3u * triangle + 2u]) - a;
            vec3 across = cross(direction, ac);
            float determinant = dot(ab, across);
            if (determinant != 0.0) {
                vec3 from_a = origin - a;
                vec3 turned = cross(from_a, ab);
                float weight_b = dot(from_a, across) / determinant;
                float weight_c = dot(direction, turned) / determinant;
                float distance_m = dot(ac, turned) / determinant;
                if (min(weight_b, weight_c) >= -EDGE_SLACK && weight_b + weight_c <= 1.0 + EDGE_SLACK && distance_m > 0.0
                    && distance_m < nearest_m) {
                    nearest_m = distance_m;
                    normal = cross(ab, ac);
                }
            }
        }
        at++;
    }
    return Hit(nearest_m < 1.0e30 ? nearest_m : -1.0, normalize(normal));
}
