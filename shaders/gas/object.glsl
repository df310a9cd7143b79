// What a surface is made of.

struct Object {
    vec4 color; // linear RGB, opacity
    vec4 second; // colour of the other squares; edge of a square, m, 0 for a plain object
    vec4 offset; // m; w: strength of the highlight
    vec4 detail; // exponent of the highlight; 1 when seen from both sides; the volumes entry of its solid texture, or -1
};
