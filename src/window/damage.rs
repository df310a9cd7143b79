//! Damage of the window, the parts to be drawn again: the shapes of a frame set against those of the last one.
//!
//! Shapes that stay keep their order, so that a pixel which no other shape touches keeps its colour; all others lie in a
//! few rectangles, and only there is anything drawn.

use std::collections::HashSet;
use std::sync::Arc;

use egui::epaint::{ClippedShape, RectShape, Shape, TextShape};
use egui::{Color32, CornerRadius, Pos2, Rect, TextureId};

use super::area::Area;

/// Rectangles that are drawn again, at most. Each is a few draws more.
const MOST_AREAS: usize = 6;
/// Pixels that are drawn in vain rather than as a rectangle of their own.
const CHEAP_PIXELS: i64 = 8192;
/// Shapes that the search for the next equal ones looks ahead.
const LOOK_AHEAD: usize = 48;

/// A shape with the pixels that it may touch.
struct Piece {
    shape: ClippedShape,
    area: Area,
    /// Pixels of which it leaves nothing to be seen.
    covered: Option<Area>,
}

/// The shapes of the window, and what of them is not drawn yet.
#[derive(Default)]
pub struct Canvas {
    pieces: Vec<Piece>,
    pixels_per_point: f32,
    stale: Vec<Area>,
    /// Those that changed by their texture alone. They stay apart: a picture that is copied needs no drawing.
    stale_pictures: Vec<Area>,
    is_all_stale: bool,
}

/// The visible contents of a rectangle.
pub struct Seen {
    /// A picture that leaves nothing below it to be seen.
    pub picture: Option<Sheet>,
    /// The shapes, in their order; without the picture.
    pub shapes: Vec<ClippedShape>,
    /// Nothing shows through between them.
    pub is_covered: bool,
}

/// A texture that lies on the window texel by pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sheet {
    /// The texture as the interface knows it.
    pub texture: TextureId,
    /// Its pixels of the window, from the first texel on.
    pub place: Area,
}

impl Canvas {
    /// Everything is to be drawn again.
    pub fn forget(&mut self) {
        self.is_all_stale = true;
    }

    /// Takes the shapes of a frame over. `redrawn` are the textures that have changed, `is_opaque` tells those without a
    /// texel that lets anything through.
    pub fn change(
        &mut self,
        shapes: Vec<ClippedShape>,
        pixels_per_point: f32,
        redrawn: &HashSet<TextureId>,
        is_opaque: impl Fn(TextureId) -> bool,
    ) {
        if self.pixels_per_point != pixels_per_point {
            (self.pixels_per_point, self.is_all_stale) = (pixels_per_point, true);
        }
        let pieces: Vec<Piece> =
            shapes.into_iter().filter_map(|shape| piece(shape, pixels_per_point, &is_opaque)).collect();
        if !self.is_all_stale {
            let (stale, pictures) = (&mut self.stale, &mut self.stale_pictures);
            differences(&self.pieces, &pieces, redrawn, |area, is_picture| {
                if is_picture && !pictures.contains(&area) {
                    pictures.push(area);
                } else if !is_picture {
                    add(stale, area);
                }
            });
            while stale.len() > MOST_AREAS {
                join_nearest(stale);
            }
        }
        self.pieces = pieces;
    }

    /// The shapes stay, and these textures have changed.
    pub fn change_textures(&mut self, redrawn: &HashSet<TextureId>) {
        for piece in self.pieces.iter().filter(|piece| uses(&piece.shape.shape, redrawn)) {
            if !self.stale_pictures.contains(&piece.area) {
                self.stale_pictures.push(piece.area);
            }
        }
    }

    /// Pixels of a point of the shapes' places.
    pub fn pixels_per_point(&self) -> f32 {
        self.pixels_per_point
    }

    /// The rectangles of a picture of that size that are to be drawn again, none over another.
    pub fn stale(&self, extent: (u32, u32)) -> Vec<Area> {
        let whole = Area::whole(extent);
        if self.is_all_stale {
            return vec![whole];
        }
        let (mut areas, mut pictures) = (self.stale.clone(), self.stale_pictures.clone());
        while let Some(picture) = first_overlapping(&pictures, &areas) {
            add(&mut areas, pictures.swap_remove(picture));
        }
        areas.extend(pictures);
        areas.into_iter().filter_map(|area| area.common(whole)).collect()
    }

    /// All is drawn.
    pub fn settle(&mut self) {
        self.stale.clear();
        self.stale_pictures.clear();
        self.is_all_stale = false;
    }

    /// The shape that lays a picture where it lies.
    pub fn shape_of(&self, sheet: Sheet) -> ClippedShape {
        let uv = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
        let shape = Shape::image(sheet.texture, self.points(sheet.place), uv, Color32::WHITE);
        ClippedShape { clip_rect: Rect::EVERYTHING, shape }
    }

    fn points(&self, area: Area) -> Rect {
        let point = |x: u32, y: u32| Pos2::new(x as f32, y as f32) / self.pixels_per_point;
        Rect::from_min_max(point(area.left, area.top), point(area.right, area.bottom))
    }

    /// The ground under all shapes: black.
    pub fn ground(&self, area: Area) -> ClippedShape {
        let shape = Shape::rect_filled(self.points(area).expand(4.0), CornerRadius::ZERO, Color32::BLACK);
        ClippedShape { clip_rect: Rect::EVERYTHING, shape }
    }

    /// The visible contents of a rectangle.
    pub fn seen_in(&self, area: Area) -> Seen {
        let base = self.pieces.iter().rposition(|piece| piece.covered.is_some_and(|covered| covered.holds(area)));
        let picture = base.and_then(|base| sheet(&self.pieces[base].shape.shape, self.pixels_per_point));
        let first = base.map_or(0, |base| base + usize::from(picture.is_some()));
        let touching = self.pieces[first..].iter().filter(|piece| piece.area.common(area).is_some());
        Seen { picture, shapes: touching.map(|piece| piece.shape.clone()).collect(), is_covered: base.is_some() }
    }
}

/// Index of the first area that lies over one of the others, or over one before it.
fn first_overlapping(areas: &[Area], others: &[Area]) -> Option<usize> {
    let is_over = |index: usize| {
        let mut before = areas[..index].iter().chain(others);
        before.any(|other| other.common(areas[index]).is_some())
    };
    (0..areas.len()).find(|&index| is_over(index))
}

/// The texture that a shape lays on the window texel by pixel.
fn sheet(shape: &Shape, pixels_per_point: f32) -> Option<Sheet> {
    let Shape::Rect(rect) = shape else { return None };
    let brush = rect.brush.as_ref().filter(|_| rect.fill == Color32::WHITE && is_sharp(rect, pixels_per_point))?;
    let is_all = brush.uv == Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
    // Places before the first pixel have no corner to count from.
    let is_inside = rect.rect.min.x * pixels_per_point > -0.5 && rect.rect.min.y * pixels_per_point > -0.5;
    let place = Area::of_clip(rect.rect, pixels_per_point).filter(|_| is_all && is_inside)?;
    Some(Sheet { texture: brush.fill_texture_id, place })
}

/// A shape that may be seen.
fn piece(shape: ClippedShape, pixels_per_point: f32, is_opaque: &impl Fn(TextureId) -> bool) -> Option<Piece> {
    let clip = Area::of_clip(shape.clip_rect, pixels_per_point)?;
    let area = touched(&shape.shape, pixels_per_point)?.common(clip)?;
    let covered = covered(&shape.shape, pixels_per_point, is_opaque).and_then(|covered| covered.common(clip));
    Some(Piece { shape, area, covered })
}

/// Pixels that a shape may touch.
fn touched(shape: &Shape, pixels_per_point: f32) -> Option<Area> {
    let rect = match shape {
        Shape::Vec(shapes) => {
            let areas = shapes.iter().filter_map(|shape| touched(shape, pixels_per_point));
            return areas.reduce(Area::around);
        }
        Shape::Rect(rect) if rect.brush.is_some() && is_sharp(rect, pixels_per_point) => {
            return Area::of_clip(rect.rect, pixels_per_point);
        }
        // Its corners stand out by up to as much again.
        Shape::Path(path) => path.visual_bounding_rect().expand(path.stroke.width),
        Shape::Text(text) if text.angle == 0.0 => {
            text.visual_bounding_rect().union(text.galley.rect.translate(text.pos.to_vec2()))
        }
        other => other.visual_bounding_rect(),
    };
    // Edges are softened by half a pixel.
    let [left, top] = [rect.min.x, rect.min.y].map(|side| (side * pixels_per_point - 1.0).floor());
    let [right, bottom] = [rect.max.x, rect.max.y].map(|side| (side * pixels_per_point + 1.0).ceil());
    Area::between(left, top, right, bottom)
}

/// True for a rectangle whose edges are those of pixels.
fn is_sharp(rect: &RectShape, pixels_per_point: f32) -> bool {
    let sides = [rect.rect.min.x, rect.rect.min.y, rect.rect.max.x, rect.rect.max.y];
    let is_whole = |side: f32| (side * pixels_per_point - (side * pixels_per_point).round()).abs() < 1e-3;
    let is_plain = rect.stroke.is_empty() && rect.blur_width == 0.0 && rect.corner_radius == CornerRadius::ZERO;
    is_plain && sides.into_iter().all(is_whole)
}

/// Pixels that a shape paints over whatever lies below.
fn covered(shape: &Shape, pixels_per_point: f32, is_opaque: &impl Fn(TextureId) -> bool) -> Option<Area> {
    let Shape::Rect(rect) = shape else { return None };
    if rect.fill.a() != u8::MAX || rect.blur_width > 0.0 {
        return None;
    }
    match &rect.brush {
        Some(brush) if is_opaque(brush.fill_texture_id) && is_sharp(rect, pixels_per_point) => {
            Area::of_clip(rect.rect, pixels_per_point)
        }
        Some(_) => None,
        None => {
            // Without the edges, whatever they are.
            let radius = f32::from(rect.corner_radius.nw.max(rect.corner_radius.ne))
                .max(f32::from(rect.corner_radius.sw.max(rect.corner_radius.se)));
            let inner = rect.rect.shrink(radius + rect.stroke.width + 1.0 / pixels_per_point);
            let [left, top] = [inner.min.x, inner.min.y].map(|side| (side * pixels_per_point).ceil());
            let [right, bottom] = [inner.max.x, inner.max.y].map(|side| (side * pixels_per_point).floor());
            Area::between(left, top, right, bottom)
        }
    }
}

/// Tells the pixels of every shape that is in one list alone, or, as a picture, is drawn with a texture that has changed.
fn differences(old: &[Piece], new: &[Piece], redrawn: &HashSet<TextureId>, mut tell: impl FnMut(Area, bool)) {
    let (mut at_old, mut at_new) = (0, 0);
    while at_old < old.len() && at_new < new.len() {
        let (skipped_old, skipped_new) = next_equal(&old[at_old..], &new[at_new..]).unwrap_or((1, 1));
        old[at_old..][..skipped_old]
            .iter()
            .chain(&new[at_new..][..skipped_new])
            .for_each(|piece| tell(piece.area, false));
        (at_old, at_new) = (at_old + skipped_old, at_new + skipped_new);
        if (skipped_old, skipped_new) == (0, 0) {
            if uses(&new[at_new].shape.shape, redrawn) {
                tell(new[at_new].area, true);
            }
            (at_old, at_new) = (at_old + 1, at_new + 1);
        }
    }
    old[at_old..].iter().chain(&new[at_new..]).for_each(|piece| tell(piece.area, false));
}

/// Number of shapes of each list to be passed over until the next of both are equal; `None` where none are near.
fn next_equal(old: &[Piece], new: &[Piece]) -> Option<(usize, usize)> {
    let is_equal = |a: usize, b: usize| old.get(a).zip(new.get(b)).is_some_and(|(a, b)| are_equal(&a.shape, &b.shape));
    // One in the place of one is what happens most.
    if is_equal(0, 0) {
        return Some((0, 0));
    }
    if is_equal(1, 1) {
        return Some((1, 1));
    }
    (1..=LOOK_AHEAD).find_map(|sum| (0..=sum).map(|a| (a, sum - a)).find(|&(a, b)| is_equal(a, b)))
}

fn are_equal(a: &ClippedShape, b: &ClippedShape) -> bool {
    a.clip_rect == b.clip_rect && are_equal_shapes(&a.shape, &b.shape)
}

fn are_equal_shapes(a: &Shape, b: &Shape) -> bool {
    match (a, b) {
        (Shape::Text(a), Shape::Text(b)) => are_equal_texts(a, b),
        (Shape::Vec(a), Shape::Vec(b)) => a.len() == b.len() && a.iter().zip(b).all(|(a, b)| are_equal_shapes(a, b)),
        (Shape::Mesh(a), Shape::Mesh(b)) => Arc::ptr_eq(a, b) || a == b,
        (a, b) => a == b,
    }
}

/// Texts that were laid out once are the same piece of memory: their letters need no look.
fn are_equal_texts(a: &TextShape, b: &TextShape) -> bool {
    (Arc::ptr_eq(&a.galley, &b.galley) || a.galley == b.galley)
        && (a.pos, a.underline, a.fallback_color, a.override_text_color, a.opacity_factor, a.angle)
            == (b.pos, b.underline, b.fallback_color, b.override_text_color, b.opacity_factor, b.angle)
}

/// True for a shape that is drawn with one of the textures.
fn uses(shape: &Shape, textures: &HashSet<TextureId>) -> bool {
    match shape {
        Shape::Rect(rect) => rect.brush.as_ref().is_some_and(|brush| textures.contains(&brush.fill_texture_id)),
        Shape::Mesh(mesh) => textures.contains(&mesh.texture_id),
        Shape::Vec(shapes) => shapes.iter().any(|shape| uses(shape, textures)),
        _ => false,
    }
}

/// Adds an area to others, none of which lies over another.
fn add(areas: &mut Vec<Area>, mut area: Area) {
    while let Some(at) =
        areas.iter().position(|other| other.common(area).is_some() || other.waste(area) <= CHEAP_PIXELS)
    {
        area = area.around(areas.swap_remove(at));
    }
    areas.push(area);
}

/// Joins the two that lie nearest to each other.
fn join_nearest(areas: &mut Vec<Area>) {
    let pairs = (0..areas.len()).flat_map(|b| (0..b).map(move |a| (a, b)));
    let Some((a, b)) = pairs.min_by_key(|&(a, b)| areas[a].waste(areas[b])) else { return };
    let second = areas.swap_remove(b);
    let first = areas.swap_remove(a);
    add(areas, first.around(second));
}

#[cfg(test)]
mod tests {
    use egui::{Color32, Vec2};

    use super::*;

    const EXTENT: (u32, u32) = (800, 600);

    fn square(x: f32, y: f32) -> ClippedShape {
        let rect = Rect::from_min_size(Pos2::new(x, y), Vec2::splat(20.0));
        ClippedShape { clip_rect: Rect::EVERYTHING, shape: Shape::rect_filled(rect, 0.0, Color32::RED) }
    }

    fn picture(id: u64) -> ClippedShape {
        let rect = Rect::from_min_size(Pos2::new(100.0, 100.0), Vec2::new(320.0, 200.0));
        let uv = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
        // As a widget paints it; `Shape::image` makes triangles.
        let shape = RectShape::filled(rect, 0.0, Color32::WHITE).with_texture(TextureId::Managed(id), uv);
        ClippedShape { clip_rect: Rect::EVERYTHING, shape: shape.into() }
    }

    /// The rectangles to draw when one list of shapes follows another.
    fn stale(old: &[ClippedShape], new: &[ClippedShape], redrawn: &[TextureId]) -> Vec<Area> {
        let mut canvas = Canvas::default();
        canvas.change(old.to_vec(), 1.0, &HashSet::new(), |_| true);
        assert_eq!(canvas.stale(EXTENT), [Area::whole(EXTENT)], "the first frame is drawn whole");
        canvas.settle();
        canvas.change(new.to_vec(), 1.0, &redrawn.iter().copied().collect(), |_| true);
        canvas.stale(EXTENT)
    }

    fn row(count: usize) -> Vec<ClippedShape> {
        (0..count).map(|index| square(20.0 * (index % 30) as f32, 40.0 * (index / 30) as f32)).collect()
    }

    #[test]
    fn what_stays_is_not_drawn_again() {
        assert_eq!(stale(&row(300), &row(300), &[]), []);
        let text = |at: f32| {
            let shape = Shape::LineSegment { points: [Pos2::new(at, 5.0); 2], stroke: (1.0, Color32::RED).into() };
            ClippedShape { clip_rect: Rect::EVERYTHING, shape }
        };
        assert_eq!(stale(&[text(3.0)], &[text(3.0)], &[]), []);
    }

    #[test]
    fn what_moves_is_drawn_where_it_was_and_where_it_is() {
        let (mut old, mut new) = (row(40), row(40));
        old[7] = square(500.0, 500.0);
        new[7] = square(300.0, 300.0);
        let mut areas = stale(&old, &new, &[]);
        areas.sort_by_key(|area| area.left);
        assert_eq!(areas.len(), 2, "{areas:?}");
        for (area, corner) in areas.into_iter().zip([300, 500]) {
            assert!((corner - 1..=corner).contains(&area.left) && (corner + 20..=corner + 21).contains(&area.right));
        }
    }

    #[test]
    fn shapes_that_come_between_others_are_drawn_alone() {
        let mut new = row(60);
        new.splice(11..11, [square(700.0, 500.0), square(700.0, 520.0)]);
        for areas in [stale(&row(60), &new, &[]), stale(&new, &row(60), &[])] {
            assert!(matches!(&areas[..], [area] if area.left >= 699 && area.top >= 499), "{areas:?}");
        }
    }

    #[test]
    fn a_texture_that_changes_is_drawn_where_it_lies_and_hides_what_is_below() {
        let shapes = [square(110.0, 110.0), picture(3), square(400.0, 110.0)];
        assert_eq!(stale(&shapes, &shapes, &[TextureId::Managed(9)]), []);
        let [area] = stale(&shapes, &shapes, &[TextureId::Managed(3)])[..] else { panic!("one rectangle") };
        assert_eq!(area, Area { left: 100, top: 100, right: 420, bottom: 300 });
        let mut canvas = Canvas::default();
        canvas.change(shapes.to_vec(), 1.0, &HashSet::new(), |_| true);
        let seen = canvas.seen_in(area);
        let sheet = Sheet { texture: TextureId::Managed(3), place: area };
        assert_eq!((seen.picture, seen.shapes, seen.is_covered), (Some(sheet), shapes[2..].to_vec(), true));
        canvas.change(shapes.to_vec(), 1.0, &HashSet::new(), |_| false);
        let seen = canvas.seen_in(area);
        assert_eq!((seen.picture, seen.shapes), (None, shapes.to_vec()), "it lets through what is below");
    }

    #[test]
    fn a_texture_is_drawn_again_where_the_last_shapes_show_it() {
        let mut canvas = Canvas::default();
        canvas.change(vec![square(0.0, 0.0), picture(3), picture(4)], 1.0, &HashSet::new(), |_| true);
        canvas.settle();
        canvas.change_textures(&HashSet::from([TextureId::Managed(9)]));
        assert_eq!(canvas.stale(EXTENT), []);
        canvas.change_textures(&HashSet::from([TextureId::Managed(3)]));
        let area = Area { left: 100, top: 100, right: 420, bottom: 300 };
        assert_eq!(canvas.stale(EXTENT), [area]);
        assert_eq!(
            canvas.seen_in(area).picture.map(|sheet| sheet.texture),
            Some(TextureId::Managed(4)),
            "the upper one"
        );
    }

    #[test]
    fn rectangles_hold_all_that_changed_and_lie_apart() {
        let mut seed = 7_u32;
        let mut random = |most: u32| {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 8) % most
        };
        for _ in 0..50 {
            let new: Vec<ClippedShape> =
                (0..1 + random(60)).map(|_| square(random(780) as f32, random(580) as f32)).collect();
            let areas = stale(&[], &new, &[]);
            assert!(areas.len() <= MOST_AREAS);
            for (index, area) in areas.iter().enumerate() {
                assert!(areas[..index].iter().all(|other| other.common(*area).is_none()), "{areas:?}");
            }
            for shape in &new {
                let wanted = touched(&shape.shape, 1.0).and_then(|area| area.common(Area::whole(EXTENT)));
                assert!(areas.iter().any(|area| wanted.is_none_or(|wanted| area.holds(wanted))), "{areas:?}");
            }
        }
    }

    #[test]
    fn another_scale_is_drawn_whole() {
        let mut canvas = Canvas::default();
        canvas.change(row(3), 1.0, &HashSet::new(), |_| true);
        canvas.settle();
        canvas.change(row(3), 1.5, &HashSet::new(), |_| true);
        assert_eq!(canvas.stale(EXTENT), [Area::whole(EXTENT)]);
    }
}
