#version 450

#extension GL_EXT_samplerless_texture_functions : require

#include "terrain/terrain.glsl"
#include "terrain/interpolation-bicubic.glsl"
#include "terrain/normal.glsl"
#include "terrain/normal-fragment.glsl"
