// The radially decreasing Gaussian g of eq. 6.3 and 7.2; the thesis leaves its width open. Here the radius is three
// standard deviations. `ratio_squared` is (r / R)^2; beyond the radius g is 0.
float gaussian(float ratio_squared) {
    return exp(-4.5 * ratio_squared);
}
