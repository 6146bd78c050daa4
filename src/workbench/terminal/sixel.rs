//! Sixel graphics: bands of six rows, one colour at a time.

use std::fmt::Write;

use super::Pixels;

/// Steps per channel of the fixed palette; 6 x 6 x 6 = 216 colours of the 256 that terminals have.
const STEPS: i32 = 6;

/// Ordered dithering, 4 x 4 (Bayer): smooth shading would show bands in so few colours.
const DITHER: [[i32; 4]; 4] = [[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]];

/// The bytes that draw a picture, and a new line.
pub fn encode(pixels: &Pixels) -> Vec<u8> {
    let (width, height) = (pixels.width as usize, pixels.height as usize);
    let indices: Vec<u8> =
        pixels.rgb.iter().enumerate().map(|(i, &rgb)| index(rgb, DITHER[i / width % 4][i % width % 4])).collect();
    // P2 = 1: pixels that are not drawn stay as they are. Aspect 1:1.
    let mut out = format!("\x1bP0;1;0q\"1;1;{width};{height}");
    let mut is_used = [false; (STEPS * STEPS * STEPS) as usize];
    for &i in &indices {
        is_used[usize::from(i)] = true;
    }
    for i in (0..is_used.len()).filter(|&i| is_used[i]) {
        let percent = |step: usize| step * 100 / (STEPS as usize - 1);
        let (r, g, b) = (percent(i / 36), percent(i / 6 % 6), percent(i % 6));
        let _ = write!(out, "#{i};2;{r};{g};{b}");
    }
    for band in (0..height).step_by(6) {
        let rows = band..(band + 6).min(height);
        let mut masks = vec![vec![]; is_used.len()];
        for y in rows {
            for x in 0..width {
                let mask: &mut Vec<u8> = &mut masks[usize::from(indices[y * width + x])];
                mask.resize(width, 0);
                mask[x] |= 1 << (y - band);
            }
        }
        let mut is_first = true;
        for (i, mask) in masks.iter().enumerate().filter(|(_, m)| !m.is_empty()) {
            // `$` goes back to the beginning of the band.
            let _ = write!(out, "{}#{i}", if is_first { "" } else { "$" });
            is_first = false;
            run_lengths(mask, &mut out);
        }
        out.push('-');
    }
    out.push_str("\x1b\\\r\n");
    out.into_bytes()
}

/// The palette's colour nearest to a colour, dithered by 0..=15.
fn index(rgb: [u8; 3], dither: i32) -> u8 {
    let [r, g, b] =
        rgb.map(|c| ((i32::from(c) * (STEPS - 1) * 16 + (dither * 2 + 1) * 255 / 2) / (255 * 16)).min(STEPS - 1));
    ((r * STEPS + g) * STEPS + b) as u8
}

fn run_lengths(mask: &[u8], out: &mut String) {
    let end = mask.iter().rposition(|&m| m != 0).map_or(0, |i| i + 1);
    for run in mask[..end].chunk_by(|a, b| a == b) {
        let sixel = char::from(63 + run[0]);
        if run.len() > 3 {
            let _ = write!(out, "!{}{sixel}", run.len());
        } else {
            out.extend(std::iter::repeat_n(sixel, run.len()));
        }
    }
}
