#version 450

// A kernel that does nothing: what its invocations take is their launch.

layout(local_size_x = 256) in;

layout(std430, set = 0, binding = 0) buffer Nothing {
    uint list[];
} nothing;

void main() {
    // Never, and no compiler knows.
    if (gl_GlobalInvocationID.x == 0xffffffffu) {
        nothing.list[0] = 1u;
    }
}
