// Triangles of meshes in a tree of boxes, children after their parents: `skip` is the node after all that lies in a box.

struct Node {
    vec3 low; // corners of the box, metres
    uint skip; // next node when the box is missed
    vec3 high;
    uint leaf; // first triangle times 8 and their number; 0 for a node with children
};

#ifdef TREE_PIECES
// One list of words, cut where a buffer of the device ends: a header of the number of nodes, the number of triangles and the
// logarithm of the words of a piece, then the nodes, three corners of each triangle, and x, y, z of each corner.
layout(std430, set = 0, binding = 5) readonly buffer TreePiece0 {
    uint list[];
} tree_0;

layout(std430, set = 0, binding = 6) readonly buffer TreePiece1 {
    uint list[];
} tree_1;

layout(std430, set = 0, binding = 7) readonly buffer TreePiece2 {
    uint list[];
} tree_2;

layout(std430, set = 0, binding = 8) readonly buffer TreePiece3 {
    uint list[];
} tree_3;

layout(std430, set = 0, binding = 9) readonly buffer TreePiece4 {
    uint list[];
} tree_4;

layout(std430, set = 0, binding = 10) readonly buffer TreePiece5 {
    uint list[];
} tree_5;

layout(std430, set = 0, binding = 11) readonly buffer TreePiece6 {
    uint list[];
} tree_6;

layout(std430, set = 0, binding = 12) readonly buffer TreePiece7 {
    uint list[];
} tree_7;

const uint HEADER = 3u;

uint word_at(uint at) {
    uint bits = tree_0.list[2];
    uint piece = at >> bits;
    uint place = at & ((1u << bits) - 1u);
    if (piece == 0u) {
        return tree_0.list[place];
    }
    if (piece == 1u) {
        return tree_1.list[place];
    }
    if (piece == 2u) {
        return tree_2.list[place];
    }
    if (piece == 3u) {
        return tree_3.list[place];
    }
    if (piece == 4u) {
        return tree_4.list[place];
    }
    if (piece == 5u) {
        return tree_5.list[place];
    }
    if (piece == 6u) {
        return tree_6.list[place];
    }
    return tree_7.list[place];
}

float number_at(uint at) {
    return uintBitsToFloat(word_at(at));
}

uint tree_node_count() {
    return tree_0.list[0];
}

Node node_at(uint index) {
    uint at = HEADER + 8u * index;
    vec3 low = vec3(number_at(at), number_at(at + 1u), number_at(at + 2u));
    vec3 high = vec3(number_at(at + 4u), number_at(at + 5u), number_at(at + 6u));
    return Node(low, word_at(at + 3u), high, word_at(at + 7u));
}

vec3 corner_at(uint index) {
    uint before = HEADER + 8u * tree_0.list[0];
    uint at = before + 3u * (tree_0.list[1] + word_at(before + index));
    return vec3(number_at(at), number_at(at + 1u), number_at(at + 2u));
}
#else
layout(std430, set = 0, binding = 5) readonly buffer Nodes {
    Node list[];
} nodes;

layout(std430, set = 0, binding = 6) readonly buffer Corners {
    float list[]; // x, y, z of each, metres
} corners;

layout(std430, set = 0, binding = 7) readonly buffer Triangles {
    uint list[]; // three corners of each
} triangles;

uint tree_node_count() {
    return nodes.list[0].skip;
}

Node node_at(uint index) {
    return nodes.list[index];
}

// Of corner `index` among all triangles'.
vec3 corner_at(uint index) {
    uint at = 3u * triangles.list[index];
    return vec3(corners.list[at], corners.list[at + 1u], corners.list[at + 2u]);
}
#endif

const float EDGE_SLACK = 1.0e-5; // rounding must not let a ray through between two triangles

struct Hit {
    float distance_m; // negative where nothing is hit
    vec3 normal; // of the face, unit length, either side
    bool is_certain; // false where the steps did not suffice
};

// The first triangle that a ray of unit direction meets, on either side. A step visits a box or a triangle; one loop for both and a
// bound of its own, since lavapipe grants all loops of a shader 65,535 iterations together, and ends them without a word.
Hit first_hit(vec3 origin, vec3 direction, uint node_count, uint most_steps) {
    vec3 inverse = 1.0 / mix(direction, vec3(1.0e-9), lessThan(abs(direction), vec3(1.0e-9)));
    float nearest_m = 1.0e30;
    vec3 normal = vec3(0.0, 1.0, 0.0);
    uint at = 0u;
    uint triangle = 0u; // of the leaf that was entered last
    uint end = 0u;
    uint steps = 0u;
    while (steps < most_steps && (triangle < end || at < node_count)) {
        steps++;
        if (triangle < end) {
            vec3 a = corner_at(3u * triangle);
            vec3 ab = corner_at(3u * triangle + 1u) - a;
            vec3 ac = corner_at(3u * triangle + 2u) - a;
            triangle++;
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
        } else {
            Node node = node_at(at);
            vec3 to_low = (node.low - origin) * inverse;
            vec3 to_high = (node.high - origin) * inverse;
            vec3 enters = min(to_low, to_high);
            vec3 leaves = max(to_low, to_high);
            float entry = max(max(enters.x, enters.y), max(enters.z, 0.0));
            float exit = min(min(leaves.x, leaves.y), min(leaves.z, nearest_m));
            if (node.skip <= at) {
                // lavapipe runs the pixels beside a triangle's edge along with those inside, and lets them read nothing but zeros.
                at = node_count;
            } else if (entry > exit + 1.0e-5 * abs(exit)) { // a flat box is as thin as its rounding
                at = node.skip;
            } else {
                at++;
                triangle = node.leaf >> 3u;
                end = triangle + (node.leaf & 7u);
            }
        }
    }
    bool is_certain = triangle >= end && at >= node_count;
    return Hit(nearest_m < 1.0e30 ? nearest_m : -1.0, normalize(normal), is_certain);
}
