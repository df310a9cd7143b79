// What is found of a section of gas.

struct Gas {
    vec3 color; // premultiplied
    float transparency;
    uint increments;
    uint evaluations; // of the density, in this dispatch
    bool is_done;
};

const Gas NOTHING = Gas(vec3(0.0), 1.0, 0u, 0u, false);
