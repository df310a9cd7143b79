// The pixels whose rays meet gas, listed by `sort` in no order, and the workgroups of 64 that each part of `volume` takes for them.
// A processor that does eight pixels in step does all that stands outside of loops, and a loop's first turn, for pixels
// without gas as well: where gas covers a part of a picture, that took as long as the gas.

layout(set = 0, binding = 36, std430) buffer GasPixels {
    uint gas_groups[3];
    uint gas_pixel_count;
    uint gas_pixels[]; // column, and row times 65536
};
