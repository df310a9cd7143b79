// The stream of an object that is not refined: it holds what has not been removed.

#ifndef TRIANGLES_REFINED
layout(set = 0, binding = 115, std430) buffer Compacted {
    uint removed; // 1 + triangles that were, 0 before the first stream
    uint is_kept; // 1 where none has been since
} compacted;

// True where the stream is that of so many removed triangles: none ever comes back, so that their number tells which.
bool is_compacted(uint removed) {
    return compacted.removed == removed + 1u;
}
#endif
