#version 450

#extension GL_EXT_samplerless_texture_functions : require

#define COUNT_STEP
#define DEEPEST 23

#include "terrain/land.glsl"
#include "terrain/traversal-types.glsl"
#include "terrain/leaf-exact.glsl"
#include "terrain/traversal.glsl"
#include "terrain/depth.glsl"
#include "terrain/depth-compute.glsl"
