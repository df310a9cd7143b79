// A dispatch by elements: what the device does not take of workgroups along x lies in further rows of them.

uint workgroup() {
    return gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
}

// The number of this thread, in workgroups of `size`; those beyond the last element have nothing to do.
uint element(uint size) {
    return size * workgroup() + gl_LocalInvocationID.x;
}
