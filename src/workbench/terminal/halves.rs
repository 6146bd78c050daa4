//! Half blocks: the upper pixel is the character, the lower one its background.

use std::fmt::Write;

use super::Pixels;

/// The bytes that draw a picture; one line per two rows of pixels.
pub fn encode(pixels: &Pixels, is_true_colour: bool) -> Vec<u8> {
    let mut out = String::new();
    let width = pixels.width as usize;
    for rows in pixels.rgb.chunks(width * 2) {
        let (upper, lower) = rows.split_at(width);
        let mut last = None;
        for (x, &pixel) in upper.iter().enumerate() {
            let colours = (pixel, lower.get(x).copied());
            if last != Some(colours) {
                let _ = write!(out, "\x1b[38;{}", colour(colours.0, is_true_colour));
                let _ = match colours.1 {
                    Some(lower) => write!(out, ";48;{}m", colour(lower, is_true_colour)),
                    None => write!(out, ";49m"),
                };
                last = Some(colours);
            }
            out.push('▀');
        }
        out.push_str("\x1b[0m\r\n");
    }
    out.into_bytes()
}

/// The end of an SGR sequence: 24 bits, or the 6 x 6 x 6 cube of xterm's 256 colours.
fn colour([r, g, b]: [u8; 3], is_true_colour: bool) -> String {
    if is_true_colour {
        return format!("2;{r};{g};{b}");
    }
    let [r, g, b] = [r, g, b].map(|c| (u32::from(c) * 5 + 127) / 255);
    format!("5;{}", 16 + 36 * r + 6 * g + b)
}
