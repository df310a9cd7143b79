// A triangle as the pixels see it.
struct Facet {
    uint triangle;
    uint object;
    uvec3 corner;
    vec3 offset; // of the object, m
    vec3 eye; // in the object's space
    vec3 p0;
    vec3 p1;
    vec3 p2;
    vec3 facing; // twice its area long
    float height; // of its plane over the eye, times that length
    vec2 range; // depths of its nearest and its farthest corner
};

Facet facet_of(uint triangle) {
    Facet facet;
    facet.triangle = triangle;
    Triangle corners = triangle_at(triangle);
    facet.corner = corners.vertices;
    facet.object = corners.object;
    facet.offset = objects[facet.object].offset_m;
    facet.eye = frame.eye - facet.offset;
    facet.p0 = position_of(facet.corner.x);
    facet.p1 = position_of(facet.corner.y);
    facet.p2 = position_of(facet.corner.z);
    facet.facing = cross(facet.p1 - facet.p0, facet.p2 - facet.p0);
    vec3 depths = vec3(dot(facet.p0 - facet.eye, frame.forward), dot(facet.p1 - facet.eye, frame.forward),
        dot(facet.p2 - facet.eye, frame.forward));
    vec2 range = vec2(min(depths.x, min(depths.y, depths.z)), max(depths.x, max(depths.y, depths.z)));
    facet.range = max(range, vec2(frame.hither_m));
    facet.height = dot(facet.facing, facet.p0 - facet.eye);
    return facet;
}
