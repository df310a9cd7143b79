layout(push_constant, std430) uniform Mesh {
    mat4 to_clip; // from u, v and h; w is the depth along the view's axis in metres
    int first_row; // of the block of rows that is drawn
    int surface; // TERRAIN or one of the walls
} mesh;
