layout(location = 0) out float shadow;

void main() {
    shadow = lit_at(ivec2(gl_FragCoord.xy));
}
