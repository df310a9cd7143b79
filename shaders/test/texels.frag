#version 450

// Numbers the texels: column + 256 x row.

layout(location = 0) out uint number;

void main() {
    uvec2 texel = uvec2(gl_FragCoord.xy);
    number = texel.x + 256u * texel.y;
}
