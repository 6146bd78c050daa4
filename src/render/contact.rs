//! Contact sheets: pictures in a grid, each with its name under it.

use crate::scene::Background;

use super::lettering::{self, Anchor};
use super::sheet::{MOST_PIXELS, Picture, RenderError, blank, paper, paste, to_pixmap};

/// A picture of a contact sheet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cell {
    /// The picture; all of one sheet have one size.
    pub picture: Picture,
    /// What is written under it.
    pub label: String,
}

/// Lays `cells` out, `columns` to a row, under a title and a quieter second line. Nothing is written into the pictures.
///
/// # Errors
/// [`RenderError::TooLarge`].
pub fn contact(
    title: &str,
    about: &str,
    cells: &[Cell],
    columns: usize,
    background: Background,
) -> Result<Picture, RenderError> {
    let (w, h) = cells.first().map_or((16, 16), |c| (c.picture.width, c.picture.height));
    let columns = columns.clamp(1, cells.len().max(1)) as u32;
    let rows = cells.len().max(1).div_ceil(columns as usize) as u32;
    let letter = (w as f32 / 22.0).clamp(9.0, 22.0);
    let (head, caption, gap) = ((4.2 * letter).round() as u32, (2.2 * letter).round() as u32, 4);
    let width = u64::from(columns) * u64::from(w + gap) + u64::from(gap);
    let height = u64::from(head) + u64::from(rows) * u64::from(h + caption) + u64::from(gap);
    if width * height > MOST_PIXELS * 1_000_000 {
        return Err(RenderError::TooLarge { width, height, most: MOST_PIXELS });
    }
    let paper = paper(background);
    let mut picture = blank(width as u32, height as u32, paper.paper);
    let corner = |i: usize| {
        let (column, row) = (i as u32 % columns, i as u32 / columns);
        (gap + column * (w + gap), head + row * (h + caption))
    };
    for (i, cell) in cells.iter().enumerate().filter(|(_, c)| c.picture.width == w && c.picture.height == h) {
        paste(&mut picture, &cell.picture.pixels, corner(i), w);
    }
    let Some(mut pixmap) = to_pixmap(&picture) else { return Ok(picture) };
    let (margin, room) = (1.5 * letter, width as f32 - 3.0 * letter);
    let title = lettering::fitted(title, 1.5 * letter, room);
    lettering::write(&mut pixmap, &title, margin, 2.0 * letter, 1.5 * letter, Anchor::Start, paper.ink);
    let about = lettering::fitted(about, 0.85 * letter, room);
    lettering::write(&mut pixmap, &about, margin, 3.4 * letter, 0.85 * letter, Anchor::Start, paper.quiet);
    for (i, cell) in cells.iter().enumerate() {
        let (x, y) = corner(i);
        let label = lettering::fitted(&cell.label, letter, w as f32);
        let (middle, base) = (x as f32 + 0.5 * w as f32, (y + h) as f32 + 1.3 * letter);
        lettering::write(&mut pixmap, &label, middle, base, letter, Anchor::Middle, paper.ink);
    }
    for (rgb, p) in picture.pixels.chunks_exact_mut(3).zip(pixmap.pixels()) {
        rgb.copy_from_slice(&[p.red(), p.green(), p.blue()]);
    }
    Ok(picture)
}

/// The pictures side by side, without anything around them; they must be of one height.
pub fn row(pictures: &[Picture]) -> Picture {
    let height = pictures.first().map_or(0, |p| p.height);
    let width: u32 = pictures.iter().map(|p| p.width).sum();
    let mut pixels = Vec::with_capacity(width as usize * height as usize * 3);
    for y in 0..height as usize {
        for picture in pictures {
            let line = picture.width as usize * 3;
            pixels.extend_from_slice(picture.pixels.get(y * line..(y + 1) * line).unwrap_or(&[]));
        }
    }
    Picture { width, height, pixels }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_keep_their_pixels() {
        let cell = |seed: usize| Cell {
            picture: Picture { width: 40, height: 30, pixels: (0..3600).map(|i| (i * seed % 251) as u8).collect() },
            label: format!("seed={seed}"),
        };
        let cells: Vec<Cell> = (1..6).map(cell).collect();
        let sheet = contact("a title", "about", &cells, 2, Background::White).unwrap();
        // Every picture stands somewhere in the sheet, byte for byte, each in its own place.
        let row = sheet.width as usize * 3;
        let mut places = vec![];
        for cell in &cells {
            let lines: Vec<&[u8]> = cell.picture.pixels.chunks_exact(120).collect();
            let is_at = |at: usize| {
                lines
                    .iter()
                    .enumerate()
                    .all(|(i, line)| sheet.pixels.get(at + i * row..at + i * row + 120) == Some(line))
            };
            let at = (0..sheet.pixels.len()).step_by(3).find(|&at| is_at(at));
            places.push(at.expect("the picture is on the sheet"));
        }
        places.dedup();
        assert_eq!(places.len(), 5);
        assert!(places.is_sorted());
    }

    #[test]
    fn nothing_and_too_much() {
        assert!(contact("", "", &[], 3, Background::Dark).is_ok());
        let huge = Picture { width: 100_000, height: 100_000, pixels: vec![] };
        let cells = [Cell { picture: huge, label: String::new() }];
        assert!(matches!(contact("", "", &cells, 1, Background::Dark), Err(RenderError::TooLarge { .. })));
    }
}
