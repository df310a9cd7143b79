//! Frame and pass times over the last minutes.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use egui::{Color32, Pos2, Rect, Sense, Shape, Stroke, Ui};

use super::interface::Interface;
use super::session::Point;

/// Time that the plots show.
const SPAN: Duration = Duration::from_secs(180);

/// Height of the words above and below the lines, points.
const CAPTION: f32 = 12.0;

/// The plots.
pub fn show(ui: &mut Ui, face: &mut Interface) {
    ui.horizontal(|ui| {
        ui.toggle_value(&mut face.is_plot_paused, "Hold").on_hover_text("The plots stay as they are");
        ui.weak("the last 3 minutes; frames without timestamps left, passes by timestamped frames right");
    });
    let held = ui.data_mut(|data| data.get_temp::<Instant>(ui.id().with("held")));
    let now = match (face.is_plot_paused, held) {
        (true, Some(held)) => held,
        _ => Instant::now(),
    };
    let keep = face.is_plot_paused.then_some(now);
    ui.data_mut(|data| match keep {
        Some(now) => data.insert_temp(ui.id().with("held"), now),
        None => data.remove::<Instant>(ui.id().with("held")),
    });
    let times = (face.opened, now);
    ui.columns(2, |columns| {
        let sides: Vec<String> = match face.session.side_count() {
            1 => vec!["frame".into()],
            _ => vec!["A".into(), "B".into()],
        };
        plot(&mut columns[0], &face.session.frames, &sides, times);
        let built = face.session.side_built(0);
        let names: Vec<String> =
            built.map(|side| side.passes.iter().map(|pass| pass.name.clone()).collect()).unwrap_or_default();
        if face.session.passes.is_empty() {
            let is_asked = face.measure.times > 0;
            let words = if is_asked {
                "They come with the first timestamps."
            } else {
                "Turn times on above the passes to see them here."
            };
            columns[1].weak(words);
        } else {
            plot(&mut columns[1], &face.session.passes, &names, times);
        }
    });
}

/// Lines of the points' values, one a name, from 0 to the largest that is seen. Columns of time are counted from `since`.
fn plot(ui: &mut Ui, points: &VecDeque<Point>, names: &[String], (since, now): (Instant, Instant)) {
    let (response, painter) = ui.allocate_painter(ui.available_size(), Sense::hover());
    let rect = response.rect;
    painter.rect_filled(rect, 2.0, ui.visuals().extreme_bg_color);
    // The lines move by whole pixels, so that most frames draw nothing here.
    let columns = (rect.width() * ui.ctx().pixels_per_point()).max(1.0);
    let now = on_a_column(since, now, SPAN.div_f32(columns));
    let age = |point: &Point| now.saturating_duration_since(point.at);
    let seen: Vec<&Point> = points.iter().filter(|point| point.at <= now && age(point) < SPAN).collect();
    let most = seen.iter().flat_map(|point| &point.values_ms).copied().fold(0.0, f64::max);
    if most <= 0.0 {
        return;
    }
    // Between the legend and the words on time.
    let (top, bottom) = (rect.top() + CAPTION, (rect.bottom() - CAPTION).max(rect.top() + CAPTION + 1.0));
    painter.hline(rect.x_range(), bottom, Stroke::new(1.0, ui.visuals().weak_text_color().gamma_multiply(0.5)));
    let place = |point: &Point, value: f64| {
        let x = rect.right() - age(point).as_secs_f32() / SPAN.as_secs_f32() * rect.width();
        Pos2::new(x, bottom - (value / most) as f32 * (bottom - top))
    };
    for index in 0..names.len() {
        let line: Vec<Pos2> =
            seen.iter().filter_map(|point| Some(place(point, *point.values_ms.get(index)?))).collect();
        let line = by_columns(&line, ui.ctx().pixels_per_point());
        let stroke = Stroke::new(1.5, colour(index, ui.visuals().dark_mode));
        match line.as_slice() {
            [] => {}
            [one] => drop(painter.circle_filled(*one, 2.0, stroke.color)),
            _ => drop(painter.add(Shape::line(line, stroke))),
        }
    }
    let font = egui::TextStyle::Small.resolve(ui.style());
    let text = ui.visuals().text_color();
    painter.text(rect.left_top(), egui::Align2::LEFT_TOP, format!("{most:.2} ms"), font.clone(), text);
    let weak = ui.visuals().weak_text_color();
    let ends = [
        (rect.left_bottom(), egui::Align2::LEFT_BOTTOM, "0 ms, 3 min ago"),
        (rect.right_bottom(), egui::Align2::RIGHT_BOTTOM, "now"),
    ];
    for (at, align, words) in ends {
        painter.text(at, align, words, font.clone(), weak);
    }
    legend(&painter, rect, names, font, ui.visuals().dark_mode);
    if let (Some(pointer), false) = (response.hover_pos(), seen.is_empty()) {
        let near = seen.iter().min_by(|a, b| {
            let distance = |point: &Point| (place(point, 0.0).x - pointer.x).abs();
            distance(a).total_cmp(&distance(b))
        });
        if let Some(point) = near {
            let values = names.iter().zip(&point.values_ms).map(|(name, ms)| format!("{name} {ms:.3} ms"));
            let lines = values.collect::<Vec<_>>().join("\n");
            response.on_hover_text(format!("{:.0} s ago\n{lines}", age(point).as_secs_f32()));
        }
    }
}

/// The last moment up to `now` that lies whole columns of time behind `since`.
fn on_a_column(since: Instant, now: Instant, column: Duration) -> Instant {
    let behind = now.saturating_duration_since(since).as_nanos() % column.as_nanos().max(1);
    now.checked_sub(Duration::from_nanos(behind as u64)).unwrap_or(now)
}

/// The line with the lowest and the highest of the points that lie in one column of pixels, in their order: no more can
/// be seen.
fn by_columns(line: &[Pos2], pixels_per_point: f32) -> Vec<Pos2> {
    let column = |point: &Pos2| (point.x * pixels_per_point).floor();
    let extremes = |points: &[Pos2]| -> Vec<Pos2> {
        let at = |order: fn(&f32, &f32) -> std::cmp::Ordering| {
            (0..points.len()).max_by(|&a, &b| order(&points[a].y, &points[b].y)).unwrap_or(0)
        };
        let (lowest, highest) = (at(f32::total_cmp), at(|a, b| b.total_cmp(a)));
        let mut ends = vec![lowest.min(highest), lowest.max(highest)];
        ends.dedup();
        ends.into_iter().map(|index| points[index]).collect()
    };
    line.chunk_by(|a, b| column(a) == column(b)).flat_map(extremes).collect()
}

fn legend(painter: &egui::Painter, rect: Rect, names: &[String], font: egui::FontId, is_dark: bool) {
    let mut x = rect.left() + 76.0;
    for (index, name) in names.iter().enumerate() {
        let drawn =
            painter.text(Pos2::new(x, rect.top()), egui::Align2::LEFT_TOP, name, font.clone(), colour(index, is_dark));
        x = drawn.right() + 10.0;
        if x > rect.right() - 40.0 {
            return;
        }
    }
}

/// Colours that differ from each other, on dark and on light ground.
fn colour(index: usize, is_dark: bool) -> Color32 {
    let hue = (index as f32 * 0.618_034 + 0.58) % 1.0;
    egui::ecolor::Hsva::new(hue, 0.65, if is_dark { 0.95 } else { 0.6 }, 1.0).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_keeps_the_extremes_of_each_column_in_their_order() {
        let point = |x: f32, y: f32| Pos2::new(x, y);
        let line = [point(0.1, 5.0), point(0.2, 9.0), point(0.3, 1.0), point(0.9, 4.0), point(1.5, 2.0)];
        assert_eq!(by_columns(&line, 1.0), [point(0.2, 9.0), point(0.3, 1.0), point(1.5, 2.0)]);
        assert_eq!(by_columns(&line, 0.1).len(), 2);
        assert!(by_columns(&[], 1.0).is_empty());
    }

    #[test]
    fn plots_stand_still_between_two_columns_of_time() {
        let start = Instant::now();
        let at = |ms: u64| on_a_column(start, start + Duration::from_millis(ms), Duration::from_millis(300));
        assert_eq!((at(299), at(310), at(910)), (start, at(590), at(1190)));
        assert!(at(610) > at(310));
    }
}
