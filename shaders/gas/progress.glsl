// Work that one dispatch does not finish (see loops.glsl): the state of the pixel is kept, and the next dispatch of the
// pass goes on from there. The host raises their number until the last one leaves nothing.

#include "gas/loops.glsl"

const uint SORT = 0u;
const uint VOLUME = 1u;
const uint LIGHT_ATTENUATION = 2u;
const uint RESOLVE = 3u;

layout(set = 0, binding = 19, std430) buffer Progress {
    uvec4 progress[]; // three a pixel; the last word is the pass, plus 1, that has not finished it
};

layout(set = 0, binding = 20, std430) buffer Unfinished {
    uint unfinished[4]; // by pass: the dispatches after which some pixel was not finished
    uint stuck[4]; // 1 where a dispatch got no further with some pixel
};

struct State {
    uvec4 a;
    uvec4 b;
    uvec3 c;
};

const State NO_STATE = State(uvec4(NONE), uvec4(NONE), uvec3(NONE));

uint held = 0u; // the pass, plus 1, that has not finished the pixel in hand

// The pixel is this dispatch's: all are the first one's. Conditions on constants alone are avoided, see counts.glsl.
bool is_due(uint pass, uint list) {
    held = progress[3u * list + 2u].w;
    return (uint(band.call == 0u) | uint(held == pass + 1u)) != 0u;
}

// Of a pixel that is due: the pass goes on with what its dispatch before has left.
bool is_carried(uint pass) {
    return (min(band.call, 1u) & uint(held == pass + 1u)) != 0u;
}

State state_of(uint list) {
    return State(progress[3u * list], progress[3u * list + 1u], progress[3u * list + 2u].xyz);
}

// `before` is what the dispatch began with.
void leave(uint pass, uint list, bool is_done, State before, State state) {
    uint is_last = uint(band.call + 1u == band.calls) & uint(!is_done);
    if (is_last != 0u) {
        unfinished[pass] = band.calls;
    }
    if (!is_done) {
        progress[3u * list] = state.a;
        progress[3u * list + 1u] = state.b;
        progress[3u * list + 2u] = uvec4(state.c, pass + 1u);
        if (state.a == before.a && state.b == before.b && state.c == before.c) {
            stuck[pass] = 1u;
        }
    } else if (held == pass + 1u) {
        progress[3u * list + 2u].w = 0u;
    }
}
