#version 450

#extension GL_EXT_samplerless_texture_functions : require

#include "terrain/terrain.glsl"
#include "terrain/base-plane.glsl"
#include "terrain/interpolation-bilinear.glsl"
#include "terrain/leaf-exact.glsl"
#include "terrain/traversal.glsl"
#include "terrain/depth.glsl"
#include "terrain/depth-compute.glsl"
