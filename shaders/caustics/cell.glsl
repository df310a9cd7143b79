// A plane and the cell of heights that it accepts, of the culled map's list (section 6.1).

struct Cell {
    float height; // of the plane along V, from the rays' reference point, metres
    float lower; // lowest height accepted, along V from the box's centre, metres
    float upper; // first height no longer accepted
    float _pad; // 0
};
