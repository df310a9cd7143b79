// Cells a side of a patch of the variant mesh-lod; as src/papers/terrain/quadtree.rs has it.
const int PATCH_SIDE = 16;
