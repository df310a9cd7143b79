// Tiles of the picture that fire or smoke reaches, so that its layer goes over those alone.

const uint TILES = 32u; // along x, and along y
