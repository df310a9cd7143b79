#version 450
#pragma variants PLANES=cells,slice,kept SHADOW=off,on

// As caustics-map.frag (PLANES=cells), caustics-map-plane.frag (PLANES=slice) and culled.frag (PLANES=kept): a multiple of the map's texels, intensities of faces
// or vertices, and shadows.

layout(location = 0) in vec4 surface;
layout(location = 1) in vec3 weight;
layout(location = 2) in float vertex_intensity;
#ifdef PLANES_KEPT
layout(location = 3) flat in vec3 accepted; // lowest height of the plane's cell, first no longer accepted, and the plane's
#endif

#ifndef PLANES_SLICE
layout(set = 0, binding = 0) uniform texture2D position_map;
#endif
#if !defined(PLANES_SLICE) || defined(SHADOW_ON)
layout(set = 0, binding = 1) uniform sampler nearest;
#endif

#include "caustics/caustics-map-options.glsl"
#include "caustics/intensity.glsl"
#include "caustics/shadow-{SHADOW}.glsl"

layout(location = 0) out float caustics;

void main() {
    vec3 water_dx = dFdx(surface.xyz);
    vec3 water_dy = dFdy(surface.xyz);
#ifdef PLANES_KEPT
    vec3 cell = accepted;
#else
    vec3 cell = vec3(plane.lower, plane.upper, plane.height);
#endif
#ifndef PLANES_SLICE
    float found = texelFetch(sampler2D(position_map, nearest), ivec2(gl_FragCoord.xy) / int(plane.coverage), 0).r;
    if (found < cell.x || found >= cell.y) {
        discard;
    }
#endif
    if (!is_lit(surface.w)) {
        discard;
    }
    // Texels of a side: twice over to_clip is the box's extent, and its product with the texels' area gives their number.
    vec2 extent = 2.0 / plane.to_clip;
    float texels = sqrt(extent.x * extent.y / plane.texel_area_m2);
    vec2 place = plane.center + (gl_FragCoord.xy / texels - 0.5) * extent;
    if (!reaches(vec3(place.x, cell.z, place.y), surface.xyz)) {
        discard;
    }
    float face_intensity = intensity(water_dx, water_dy, weight, plane.up, plane.texel_area_m2);
    caustics = plane.by_vertex == 1u ? vertex_intensity : face_intensity;
}
