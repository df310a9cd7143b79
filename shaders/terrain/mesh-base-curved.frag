#version 450

#extension GL_EXT_samplerless_texture_functions : require

#include "terrain/terrain.glsl"
#include "terrain/base-curved.glsl"
#include "terrain/mesh-base.glsl"
