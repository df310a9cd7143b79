#version 450

// Nothing: what is left of a pass is its vertex work, its set-up and its rasterisation.

void main() {}
