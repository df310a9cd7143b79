#version 450

// The planes of smart slicing (section 4.7.2) in the sub-boxes that the device found (section 6.1): an invocation places a plane, and
// tells a level what its sub-box is sliced into.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "caustics/sub-box.glsl"
#include "caustics/levels.glsl"
#include "caustics/cell.glsl"
#include "caustics/slices.glsl"

layout(std430, set = 0, binding = 2) readonly buffer SubBoxes {
    SubBox list[];
} sub_boxes;

layout(std430, set = 0, binding = 3) readonly buffer Placed {
    uint planes;
    uint boxes;
} placed;

layout(std430, set = 0, binding = 4) buffer Cells {
    Cell list[];
} cells;

layout(std430, set = 0, binding = 5) buffer Sliced {
    vec4 list[]; // the Slices of each level
} sliced;

// The sub-box of a plane, or of a level that is held: the last that begins no later.
SubBox sub_box_of(uint number, bool is_plane) {
    uint found = 0u;
    uint end = placed.boxes;
    while (found + 1u < end) {
        uint middle = (found + end) / 2u;
        SubBox other = sub_boxes.list[middle];
        uint begins = is_plane ? other.first_plane : other.first;
        if (begins <= number) {
            found = middle;
        } else {
            end = middle;
        }
    }
    return sub_boxes.list[found];
}

// The box's own top belongs to the level under it, whose bound is the number after.
float top_of(SubBox box) {
    return box.first == 0u ? smart.top : bounds.list[box.first];
}

// The height so many cells under the top of a sub-box.
float height_at(float top, float place, Fit fit) {
    return (top - place * fit.coarse) - place * fit.fine;
}

void main() {
    uint at = element(64u);
    if (at < smart.most) {
        Cell cell = Cell(0.0, 0.0, 0.0, 0.0);
        if (at < placed.planes) {
            SubBox box = sub_box_of(at, true);
            Fit fit = fits.list[box.end - box.first - 1u];
            float top = top_of(box);
            uint plane = at - box.first_plane;
            cell.height = smart.middle + height_at(top, float(plane) + 0.5, fit);
            cell.upper = plane == 0u ? bounds.list[box.first] : height_at(top, float(plane), fit);
            cell.lower = plane + 1u == box.planes ? bounds.list[box.end] : height_at(top, float(plane + 1u), fit);
        }
        cells.list[at] = cell;
    }
    if (at < smart.levels) {
        if (held.list[at] != 0u) {
            SubBox box = sub_box_of(at, false);
            Fit fit = fits.list[box.end - box.first - 1u];
            float last = float(box.first_plane + box.planes - 1u);
            sliced.list[at] = whole_of(Slices(top_of(box), 1.0 / (fit.coarse + fit.fine), float(box.first_plane), last));
            // As the next frame wants it.
            held.list[at] = 0u;
        }
    }
}
