//! The picture of a swept region as PNG.
//!
//! The region is filled from its loops, not from its triangles: where two of these meet, smoothing
//! along their common edge would let the white below shine through as a fine line.

use super::{Look, MARGIN, Paint, PathKind, REGION, RegionPicture, VerticalAxis, layers};
use glam::DVec2;
use std::io::{self, Write};
use tiny_skia::{Color, FillRule, LineJoin, PathBuilder, Pixmap, Stroke, Transform};

/// Longer side of the picture in pixels.
const PIXELS: f64 = 1600.0;

pub(super) fn write(out: &mut impl Write, picture: &RegionPicture) -> io::Result<()> {
    let [low, high] = picture.bounds();
    let diagonal = low.distance(high);
    let margin = MARGIN * diagonal;
    let size = high - low + 2.0 * margin;
    // A point has no size; it makes a picture of one pixel.
    let scale = if diagonal > 0.0 {
        PIXELS / size.max_element()
    } else {
        1.0
    };
    let frame = PixelFrame {
        low: low - margin,
        high: high + margin,
        scale,
        vertical: picture.vertical,
    };
    let [width, height] = (size * scale).to_array().map(pixels);
    let mut pixmap =
        Pixmap::new(width, height).ok_or_else(|| io::Error::other("the picture has no size"))?;
    pixmap.fill(Color::WHITE);
    let region = picture.region.iter().collect();
    for (look, loops, kind) in
        std::iter::once((REGION, region, PathKind::Closed)).chain(layers(picture))
    {
        draw(&mut pixmap, &frame, &look, &loops, kind, diagonal);
    }
    out.write_all(
        &pixmap
            .encode_png()
            .map_err(|error| io::Error::other(error.to_string()))?,
    )
}

/// The map from the coordinates of the region to pixels.
struct PixelFrame {
    low: DVec2,
    high: DVec2,
    scale: f64,
    vertical: VerticalAxis,
}

impl PixelFrame {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "pixels need no more than single precision"
    )]
    fn pixel(&self, point: DVec2) -> [f32; 2] {
        let y = match self.vertical {
            VerticalAxis::Down => point.y - self.low.y,
            VerticalAxis::Up => self.high.y - point.y,
        };
        [(point.x - self.low.x) * self.scale, y * self.scale].map(|pixel| pixel as f32)
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "between 1 and a few thousand"
)]
fn pixels(length: f64) -> u32 {
    length.ceil().clamp(1.0, 2.0 * PIXELS) as u32
}

fn draw(
    pixmap: &mut Pixmap,
    frame: &PixelFrame,
    look: &Look,
    loops: &[&Vec<DVec2>],
    kind: PathKind,
    diagonal: f64,
) {
    let mut builder = PathBuilder::new();
    for points in loops {
        for (i, &point) in points.iter().enumerate() {
            let [x, y] = frame.pixel(point);
            if i == 0 {
                builder.move_to(x, y)
            } else {
                builder.line_to(x, y)
            }
        }
        if kind == PathKind::Closed {
            builder.close();
        }
    }
    // There is no path where nothing is left to draw: no points, or numbers beyond single
    // precision.
    let Some(path) = builder.finish() else { return };
    if let Some(fill) = look.fill {
        pixmap.fill_path(
            &path,
            &paint(fill),
            FillRule::EvenOdd,
            Transform::identity(),
            None,
        );
    }
    #[expect(clippy::cast_possible_truncation, reason = "a few pixels")]
    let width = (look.width * diagonal * frame.scale).max(1.0) as f32;
    let stroke = Stroke {
        width,
        line_join: LineJoin::Round,
        ..Stroke::default()
    };
    pixmap.stroke_path(
        &path,
        &paint(look.line),
        &stroke,
        Transform::identity(),
        None,
    );
}

fn paint(paint: Paint) -> tiny_skia::Paint<'static> {
    let mut shade = tiny_skia::Paint {
        anti_alias: true,
        ..tiny_skia::Paint::default()
    };
    let channel = |value: u8| f32::from(value) / 255.0;
    let colour = Color::from_rgba(
        channel(paint.red),
        channel(paint.green),
        channel(paint.blue),
        paint.opacity,
    );
    shade.set_color(colour.unwrap_or(Color::BLACK));
    shade
}

#[cfg(test)]
mod tests {
    use super::super::tests::picture;
    use super::*;

    fn pixel(picture: &RegionPicture, x: f64, y: f64) -> [u8; 3] {
        let mut bytes = Vec::new();
        write(&mut bytes, picture).expect("memory");
        let image = Pixmap::decode_png(&bytes).expect("a PNG");
        let at = |share: f64, count: u32| pixels((share * f64::from(count)).floor()).min(count - 1);
        let found = image
            .pixel(at(x, image.width()), at(y, image.height()))
            .expect("in the picture")
            .demultiply();
        [found.red(), found.green(), found.blue()]
    }

    #[test]
    fn the_region_the_body_and_the_paper_have_their_colours() {
        let picture = picture();
        assert_eq!(pixel(&picture, 0.01, 0.01), [255; 3], "paper around it");
        assert_eq!(pixel(&picture, 0.4, 0.25), [198, 219, 239], "region");
        // The start is on the left, the end on the right.
        let [red, _, blue] = pixel(&picture, 0.2, 0.5);
        assert!(red > 230 && blue < 160, "the start is yellow: {red} {blue}");
        let [red, green, _] = pixel(&picture, 0.9, 0.5);
        assert!(red > green + 40, "the end is orange: {red} {green}");
    }

    #[test]
    fn y_points_up_or_down_as_asked() {
        let mut picture = RegionPicture {
            poses: vec![],
            paths: vec![],
            ..picture()
        };
        // The hole is in the lower half where y is up: 1.5 to 1.75, 0.2 to 0.45 of 3 x 1 from (0,
        // 0.1).
        let hole = [1.625 / 3.0 * 0.94 + 0.03, 0.72];
        assert_eq!(pixel(&picture, hole[0], hole[1]), [255; 3]);
        picture.vertical = VerticalAxis::Down;
        assert_eq!(pixel(&picture, hole[0], 1.0 - hole[1]), [255; 3]);
    }
}
