layout(push_constant) uniform Map {
    Box bounds; // of all receivers
    float receiver; // index of the one that is drawn
} map;
