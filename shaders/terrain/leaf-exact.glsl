// `--lod exact`: subdivision ends at the data.

int finest_shift(float depth_m) {
    return 0;
}
