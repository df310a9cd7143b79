// The ground fades into the background between these distances from the middle, diagonals.
const float FADES_FROM = 0.5;
const float FADES_TO = 1.6;
