layout(location = 0) out vec4 depth;

void main() {
    depth = find(ivec2(gl_FragCoord.xy));
}
