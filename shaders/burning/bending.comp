#version 450

// What hangs by little bends: ours. Sections hang together in a tree, from those on the ground on. Where all that lies
// beyond a joint hangs by it alone, it loads the joint with the moment of its weight, and the joint turns by as much more
// than at rest, where it bore the same load, as it has lost of its section: as a thin tube of radius r and wall s, whose
// curvature is M / (E pi r^3 s). It never turns back, for charred wood does not spring; a tick's turn is small, and ends
// below the joint, so that what bends comes down and gains no energy. What is held from two sides holds.

layout(local_size_x = 256) in;

#include "burning/constants.glsl"
#include "burning/hash.glsl"
#include "burning/parts.glsl"
#include "burning/sections.glsl"

layout(set = 0, binding = 66, std430) readonly buffer Parts {
    Part parts[];
};

layout(set = 0, binding = 102, std430) readonly buffer Sections {
    Section sections[];
};

layout(set = 0, binding = 103, std430) readonly buffer Joints {
    Joint joints[];
};

layout(set = 0, binding = 104, std430) readonly buffer Around {
    uint around[]; // joints of the sections, one list after the other
};

layout(set = 0, binding = 107, std430) readonly buffer Loads {
    Load loads[];
};

layout(set = 0, binding = 108, std430) readonly buffer Strengths {
    uint strengths[]; // of joints
};

layout(set = 0, binding = 109, std430) readonly buffer SectionBends {
    Bend section_bends[];
};

layout(set = 0, binding = 110, std430) buffer Angles {
    float angles[]; // that the joints have turned by, radians
};

layout(set = 0, binding = 111, std430) buffer Hinges {
    Hinge hinges[]; // of sections
};

layout(set = 0, binding = 112, std430) buffer Bending {
    uint groups[3]; // workgroups over the vertices, in rows, while something bends; else 0 a row
    uint is_idle; // 1 where nothing has turned since the loads were summed, nor will before they are again
};

layout(push_constant, std430) uniform Sizes {
    uint section_count;
    uint joint_count;
    uint cut_count;
    float width; // of a section from the foot's side to the other, diagonals
    float area; // of a weight of 1, square diagonals
    float bending; // curvature of a joint of length 1 that bears a moment of 1, without it at rest
} sizes;

const uint GROUP = 256u;
const uint ROUNDS = 128u; // of the search
const uint UNKNOWN = 0xffffu;
const float STEPS = 256.0; // of L
const float MOST_ANGLE = 0.8; // of a joint, radians
const float SHARE = 0.1; // of what is left to turn by, in a tick
const float FARTHEST = 0.004; // that a tick moves anything, diagonals

shared uint depths[MOST_SECTIONS]; // joints to the ground, and in the high 16 bits the joint towards it
shared vec4 moments[MOST_SECTIONS]; // of what lies beyond, with itself: weight times place, weight
shared float reaches[MOST_SECTIONS]; // from the joint towards the foot to the farthest of it
shared uint loops[MOST_SECTIONS]; // of the joints beyond that close loops, 0 where there are none
shared uint found_count;
shared uint turning_count;

bool is_foot(uint section) {
    return loads[section].is_foot != 0u && loads[section].part < MOST_PARTS && parts[loads[section].part].rests != 0.0;
}

uint other_end(uint joint, uint section) {
    uvec2 ends = joints[joint].ends;
    return ends.x == section ? ends.y : ends.x;
}

// True where both ends lie still in one part.
bool holds(uint joint) {
    uint part = loads[joints[joint].ends.x].part;
    return strengths[joint] > 0u && part < MOST_PARTS && part == loads[joints[joint].ends.y].part;
}

vec3 bent_with(uint section, vec3 place) {
    return turned(section_bends[section].turn, place) + section_bends[section].offset;
}

uint depth_of(uint section) {
    return depths[section] & 0xffffu;
}

uint joint_of(uint section) {
    return depths[section] >> 16u;
}

// The joint of a section towards its foot, in the middle of how both ends have bent.
vec3 pivot_of(uint section, uint joint) {
    vec3 place = joints[joint].place;
    return 0.5 * (bent_with(section, place) + bent_with(other_end(joint, section), place));
}

void main() {
    if (is_idle != 0u) {
        return;
    }
    uint thread = gl_LocalInvocationID.x;
    uint count = min(sizes.section_count, MOST_SECTIONS);
    for (uint section = thread; section < count; section += GROUP) {
        depths[section] = (UNKNOWN << 16u) | (is_foot(section) ? 0u : UNKNOWN);
    }
    if (thread == 0u) {
        turning_count = 0u;
    }
    barrier();
    uint deepest = 0u;
    for (uint depth = 1u; depth < ROUNDS; depth++) {
        if (thread == 0u) {
            found_count = 0u;
        }
        barrier();
        for (uint section = thread; section < count; section += GROUP) {
            if (depth_of(section) == UNKNOWN) {
                for (uint i = sections[section].first; i < sections[section + 1u].first; i++) {
                    uint joint = around[i];
                    if (holds(joint) && depth_of(other_end(joint, section)) == depth - 1u) {
                        depths[section] = (joint << 16u) | depth;
                        found_count = 1u;
                        break;
                    }
                }
            }
        }
        barrier();
        if (found_count == 0u) {
            break;
        }
        deepest = depth;
        barrier();
    }

    // From the farthest inwards: each gathers from what hangs on it.
    for (uint step = 0u; step <= deepest; step++) {
        uint depth = deepest - step;
        for (uint section = thread; section < count; section += GROUP) {
            if (depth_of(section) == depth) {
                uint own_joint = joint_of(section);
                float weight = float(loads[section].weight);
                vec4 moment = vec4(weight * bent_with(section, sections[section].place), weight);
                uint open = 0u;
                bool is_root = own_joint == UNKNOWN;
                vec3 pivot = is_root ? vec3(0.0) : pivot_of(section, own_joint);
                float reach = 2.0 * sizes.width;
                if (!is_root) {
                    reach += distance(pivot, bent_with(section, sections[section].place));
                }
                for (uint i = sections[section].first; i < sections[section + 1u].first; i++) {
                    uint joint = around[i];
                    uint other = other_end(joint, section);
                    if (joint != own_joint && holds(joint)) {
                        if (joint_of(other) == joint) {
                            moment += moments[other];
                            open ^= loops[other];
                            reach = max(reach, reaches[other] + distance(pivot, pivot_of(other, joint)));
                        } else {
                            open ^= hash(uvec3(joint, 1u, 2u)).x | 1u;
                        }
                    }
                }
                moments[section] = moment;
                loops[section] = open;
                reaches[section] = reach;
            }
        }
        barrier();
    }

    for (uint section = thread; section < count; section += GROUP) {
        uint joint = depth_of(section) == UNKNOWN ? UNKNOWN : joint_of(section);
        Hinge hinge = Hinge(vec3(1.0, 0.0, 0.0), 0.0, vec3(0.0), joint == UNKNOWN ? NONE : joint);
        if (joint != UNKNOWN && loops[section] == 0u && moments[section].w > 0.0) {
            vec4 orientation = parts[loads[section].part].orientation;
            vec3 down = turned(vec4(-orientation.xyz, orientation.w), vec3(0.0, -1.0, 0.0));
            hinge.pivot = pivot_of(section, joint);
            vec3 arm = moments[section].xyz / moments[section].w - hinge.pivot;
            vec3 axis = cross(arm, down);
            float lever = length(axis);
            float whole = float(joints[joint].units) * LENGTH_UNIT;
            float left = min(float(strengths[joint]) * LENGTH_UNIT / STEPS, whole);
            // Curvature beyond that at rest, over a section's width.
            float load = sizes.area * moments[section].w * lever;
            float bent_by = sizes.bending * sizes.width * load * (1.0 / left - 1.0 / whole) / (whole * whole);
            float turn = SHARE * (min(bent_by, MOST_ANGLE) - angles[joint]);
            turn = min(min(turn, FARTHEST / reaches[section]), 0.5 * lever / length(arm));
            if (turn > 1e-6 && lever > 1e-6) {
                hinge.axis = axis / lever;
                hinge.angle = turn;
                angles[joint] += turn;
                turning_count = 1u;
            }
        }
        hinges[section] = hinge;
    }
    barrier();
    if (thread == 0u) {
        is_idle = 1u - turning_count;
        uint row = 64u * groups[1];
        groups[0] = turning_count * ((constants.vertex_count + row - 1u) / row);
    }
}
