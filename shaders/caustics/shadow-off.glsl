const bool is_shadow_cut = false;

// Without shadows between receivers every beam reaches what it lights.
bool reaches(vec3 point, vec3 water) {
    return true;
}
