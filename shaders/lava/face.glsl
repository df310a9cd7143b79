// The temperature of a crust's face, which is what glows, by the mean of the particle that it has grown on (heat-balance integral, Goodman
// 1958). Through a crust d thick the temperature changes evenly from the melt's to the face's: it has lost d (T_m - T_f) / 2, the particle's
// loss. What the face radiates reaches it by conduction: e sigma (T_f^4 - T_a^4) = k (T_m - T_f) / d. Both without d:
// radiance lost_k (T_f^4 - T_a^4) = (T_m - T_f)^2, the left of which grows and the right of which falls with T_f.

const int HALVINGS = 20;

float face_k(float kelvin, float radiance) {
    float per_k4 = radiance * max(flow.melt_k - kelvin, 0.0);
    float around_k2 = flow.ambient_k * flow.ambient_k;
    vec2 between_k = vec2(flow.ambient_k, flow.melt_k);
    for (int i = 0; i < HALVINGS; i++) {
        float middle_k = 0.5 * (between_k.x + between_k.y);
        float squared = middle_k * middle_k;
        float below_k = flow.melt_k - middle_k;
        bool is_hot = per_k4 * (squared * squared - around_k2 * around_k2) > below_k * below_k;
        between_k = is_hot ? vec2(between_k.x, middle_k) : vec2(middle_k, between_k.y);
    }
    // A crust thicker than its particle is as cold as that.
    return radiance > 0.0 ? min(between_k.x, kelvin) : kelvin;
}
