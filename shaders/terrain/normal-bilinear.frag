#version 450

#extension GL_EXT_samplerless_texture_functions : require

#include "terrain/land.glsl"
#include "terrain/interpolation-bilinear.glsl"
#include "terrain/normal.glsl"
#include "terrain/normal-fragment.glsl"
