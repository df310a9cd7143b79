// How far the search for parts is.

struct Progress {
    uint is_unsettled; // some triangle's corners are not known to hang together yet
    uint is_numbered; // the parts have numbers that nothing has taken over yet
    uint part_count;
};
