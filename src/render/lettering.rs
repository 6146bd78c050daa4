//! Words on the sheet.

use std::sync::LazyLock;

use fontdue::{Font, FontSettings};
use tiny_skia::{Pixmap, PremultipliedColorU8};

use crate::math::Colour;

/// DejaVu Sans, Latin letters only; licence beside it.
static FONT: LazyLock<Option<Font>> = LazyLock::new(|| {
    let bytes: &[u8] = include_bytes!("../../assets/DejaVuSans-Latin.ttf");
    Font::from_bytes(bytes, FontSettings::default()).ok()
});

/// How a line of text stands to its point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// It begins there.
    Start,
    /// Its middle is there.
    Middle,
    /// It ends there.
    End,
}

/// Width in pixels of `text` at `size` pixels per em.
pub fn width(text: &str, size: f32) -> f32 {
    place(text, size).1
}

/// `text`, shortened to at most `room` pixels with an ellipsis at the end.
pub fn fitted(text: &str, size: f32, room: f32) -> String {
    if width(text, size) <= room {
        return text.to_owned();
    }
    let mut kept: Vec<char> = text.chars().collect();
    while !kept.is_empty() {
        kept.pop();
        let short = kept.iter().collect::<String>().trim_end().to_owned() + "…";
        if width(&short, size) <= room {
            return short;
        }
    }
    String::new()
}

/// Each letter with its pen position, and where the pen ends.
fn place(text: &str, size: f32) -> (Vec<(char, f32)>, f32) {
    let Some(font) = FONT.as_ref() else { return (Vec::new(), 0.0) };
    let (mut pen, mut before) = (0.0, None);
    let mut letters = Vec::new();
    for c in text.chars().map(|c| if font.has_glyph(c) { c } else { '\u{fffd}' }) {
        pen += before.and_then(|b| font.horizontal_kern(b, c, size)).unwrap_or(0.0);
        letters.push((c, pen));
        pen += font.metrics(c, size).advance_width;
        before = Some(c);
    }
    (letters, pen)
}

/// Writes `text` with a rim of `paper` around the letters, for words over a picture.
pub fn write_over(pixmap: &mut Pixmap, text: &str, x: f32, y: f32, size: f32, colour: Colour, paper: Colour) {
    let rim = (size / 9.0).round().max(1.0);
    for (dx, dy) in
        [(-1.0, 0.0), (1.0, 0.0), (0.0, -1.0), (0.0, 1.0), (-1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (1.0, -1.0)]
    {
        write(pixmap, text, x + dx * rim, y + dy * rim, size, Anchor::Start, paper);
    }
    write(pixmap, text, x, y, size, Anchor::Start, colour);
}

/// Writes `text` with its baseline at `y`.
pub fn write(pixmap: &mut Pixmap, text: &str, x: f32, y: f32, size: f32, anchor: Anchor, colour: Colour) {
    let Some(font) = FONT.as_ref() else { return };
    let (letters, total) = place(text, size);
    let start = match anchor {
        Anchor::Start => x,
        Anchor::Middle => x - 0.5 * total,
        Anchor::End => x - total,
    };
    let (w, h) = (pixmap.width() as i64, pixmap.height() as i64);
    let ink = [colour.r, colour.g, colour.b].map(|c| c * 255.0);
    let pixels = pixmap.pixels_mut();
    for (c, pen) in letters {
        let (metrics, cover) = font.rasterize(c, size);
        let left = (start + pen).round() as i64 + i64::from(metrics.xmin);
        let top = y.round() as i64 - i64::from(metrics.ymin) - metrics.height as i64;
        for (i, &a) in cover.iter().enumerate() {
            let (px, py) = (left + (i % metrics.width) as i64, top + (i / metrics.width) as i64);
            if a == 0 || px < 0 || py < 0 || px >= w || py >= h {
                continue;
            }
            let p = &mut pixels[(py * w + px) as usize];
            let a = f32::from(a) / 255.0;
            let blend = |old: u8, new: f32| (f32::from(old) + (new - f32::from(old)) * a).round() as u8;
            let (r, g, b) = (blend(p.red(), ink[0]), blend(p.green(), ink[1]), blend(p.blue(), ink[2]));
            if let Some(new) = PremultipliedColorU8::from_rgba(r, g, b, 255) {
                *p = new;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_font_is_there_and_has_what_we_write() {
        let font = FONT.as_ref().expect("the embedded font");
        for c in "abzABZ0189 .,-×·…éüß".chars() {
            assert!(font.has_glyph(c), "{c}");
        }
    }

    #[test]
    fn text_fits_or_is_shortened() {
        assert_eq!(fitted("front", 16.0, 200.0), "front");
        let long = "a very long name of a style that nobody would choose";
        for room in [0.0, 5.0, 40.0, 100.0] {
            let short = fitted(long, 16.0, room);
            assert!(width(&short, 16.0) <= room);
            assert!(short.is_empty() || short.ends_with('…'));
        }
    }

    #[test]
    fn writing_stays_inside_its_box_and_the_picture() {
        let mut pixmap = Pixmap::new(60, 30).unwrap();
        pixmap.fill(tiny_skia::Color::WHITE);
        write(&mut pixmap, "Top", 10.0, 20.0, 16.0, Anchor::Start, Colour::hex(0));
        let right = 10.0 + width("Top", 16.0) + 1.0;
        let mut dark = 0;
        for (i, p) in pixmap.pixels().iter().enumerate() {
            let (x, y) = ((i % 60) as f32, (i / 60) as f32);
            if p.red() < 255 {
                dark += 1;
                assert!(x >= 9.0 && x <= right && (4.0..=25.0).contains(&y), "{x} {y}");
            }
        }
        assert!(dark > 40);
        // Outside and half outside: nothing breaks.
        for (x, y) in [(-20.0, 5.0), (55.0, 2.0), (1e6, -1e6), (f32::NAN, 3.0)] {
            write(&mut pixmap, "Top\u{4e2d}", x, y, 16.0, Anchor::Middle, Colour::hex(0));
        }
    }
}
