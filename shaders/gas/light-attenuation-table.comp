#version 450

#pragma variants COUNT=one,several

// What the gas takes of the light that falls on surfaces, read from the table.

#include "gas/frame.glsl"
#include "gas/counts.glsl"
#include "gas/band.glsl"
#include "gas/progress.glsl"
#include "gas/volumes-{COUNT}.glsl"
#include "gas/lights-{COUNT}.glsl"
#include "gas/lists.glsl"
#include "gas/shadow-table.glsl"
#include "gas/surface-sums.glsl"
#include "gas/attenuation.glsl"
