//! Pictures inside a terminal: as bytes, for whoever prints.
//!
//! What a terminal can do is told from its environment alone. Asking it (`ESC [ c`) would wait for ever on one that
//! does not answer, and would eat what the user types.

mod halves;
mod inline;
mod sixel;

use std::io::Cursor;

/// How pictures get into a terminal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Protocol {
    /// The kitty graphics protocol.
    Kitty,
    /// Inline images as iTerm2 has them.
    Iterm,
    /// Sixel graphics of the DEC terminals.
    Sixel,
    /// Two pixels per character, as coloured half blocks.
    Half,
}

impl Protocol {
    /// Names, in the order of the variants.
    pub const TEXTS: &[&str] = &["kitty", "iterm", "sixel", "half"];

    /// The protocol of a name.
    pub fn parse(text: &str) -> Option<Self> {
        match text {
            "kitty" => Some(Self::Kitty),
            "iterm" => Some(Self::Iterm),
            "sixel" => Some(Self::Sixel),
            "half" => Some(Self::Half),
            _ => None,
        }
    }

    /// The best protocol of the terminal that the environment describes.
    pub fn detect(variable: impl Fn(&str) -> Option<String>) -> Self {
        let is = |name: &str, values: &[&str]| variable(name).is_some_and(|v| values.contains(&v.as_str()));
        let term = variable("TERM").unwrap_or_default();
        // Multiplexers hand on text, not pictures.
        if variable("TMUX").is_some() || term.starts_with("screen") || term.starts_with("tmux") {
            return Self::Half;
        }
        if variable("KITTY_WINDOW_ID").is_some()
            || ["xterm-kitty", "xterm-ghostty"].contains(&term.as_str())
            || is("TERM_PROGRAM", &["ghostty"])
        {
            return Self::Kitty;
        }
        if is("TERM_PROGRAM", &["iTerm.app", "WezTerm", "vscode", "mintty"]) || is("LC_TERMINAL", &["iTerm2"]) {
            return Self::Iterm;
        }
        if ["foot", "mlterm", "contour", "yaft"].iter().any(|t| term.starts_with(t)) || term.contains("sixel") {
            return Self::Sixel;
        }
        // Since 22.04; a terminal of another make that was started from it has another `TERM` or names itself.
        let konsole = variable("KONSOLE_VERSION").and_then(|v| v.parse::<u32>().ok());
        if konsole.is_some_and(|v| v >= 220_400) && term.starts_with("xterm") && variable("XTERM_VERSION").is_none() {
            return Self::Iterm;
        }
        Self::Half
    }
}

/// The window of a terminal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// Characters per line.
    pub columns: u32,
    /// Lines.
    pub rows: u32,
    /// Pixels of a character, if the terminal tells.
    pub cell: Option<(u32, u32)>,
    /// True when colours may have 24 bits; otherwise 256 colours are used.
    pub is_true_colour: bool,
    /// The largest sixel picture that it draws, in pixels; none for no such limit.
    pub most: Option<(u32, u32)>,
}

impl Default for Window {
    fn default() -> Self {
        Self { columns: 80, rows: 24, cell: None, is_true_colour: true, most: None }
    }
}

/// Pixels of a character where the terminal does not tell: about that of the usual fonts.
const USUAL_CELL: (u32, u32) = (9, 18);

/// What xterm draws at most unless its resource `maxGraphicSize` says otherwise; of a larger picture it draws nothing.
pub const XTERM_MOST: (u32, u32) = (1000, 1000);

/// A picture that cannot be shown.
#[derive(Debug, thiserror::Error)]
#[error("the picture cannot be shown: {0}")]
pub struct ShowError(String);

/// An opaque picture.
#[derive(Clone, Debug)]
pub(crate) struct Pixels {
    pub width: u32,
    pub height: u32,
    pub rgb: Vec<[u8; 3]>,
}

/// The bytes that draw a PNG at the cursor, as large as fits into the window less `taken` lines, never enlarged beyond
/// its own pixels. They end with the cursor at the beginning of the line below.
///
/// # Errors
/// [`ShowError`] when it is no PNG of 8 bits per channel.
pub fn draw(png: &[u8], protocol: Protocol, window: &Window, taken: u32) -> Result<Vec<u8>, ShowError> {
    let pixels = decode(png)?;
    let (columns, rows) = fit(&pixels, protocol, window, taken);
    let cell = window.cell.unwrap_or(USUAL_CELL);
    Ok(match protocol {
        Protocol::Kitty => inline::kitty(png, columns, rows),
        Protocol::Iterm => inline::iterm(png, columns, rows),
        Protocol::Sixel => {
            // Whole bands of six, so that the cursor's line is known.
            let most = (columns * cell.0, (rows * cell.1 / 6).max(1) * 6);
            sixel::encode(&shrink(&pixels, scaled(&pixels, most)))
        }
        Protocol::Half => halves::encode(&shrink(&pixels, scaled(&pixels, (columns, rows * 2))), window.is_true_colour),
    })
}

/// Columns and rows that a picture takes.
fn fit(pixels: &Pixels, protocol: Protocol, window: &Window, taken: u32) -> (u32, u32) {
    let cell = match protocol {
        // A half block is taken for a square.
        Protocol::Half => (1, 2),
        Protocol::Kitty | Protocol::Iterm | Protocol::Sixel => window.cell.unwrap_or(USUAL_CELL),
    };
    let rows = window.rows.saturating_sub(taken + 1).max(4);
    let (mut columns, mut rows) = (window.columns.max(4), rows);
    if let (Protocol::Sixel, Some(most)) = (protocol, window.most) {
        (columns, rows) = (columns.min(most.0 / cell.0).max(1), rows.min(most.1 / cell.1).max(1));
    }
    let (width, height) = scaled(pixels, (columns * cell.0, rows * cell.1));
    (width.div_ceil(cell.0).max(1), height.div_ceil(cell.1).max(1))
}

/// The size of a picture that fits into `most` pixels, its shape kept, not enlarged.
fn scaled(pixels: &Pixels, most: (u32, u32)) -> (u32, u32) {
    let (w, h) = (u64::from(pixels.width), u64::from(pixels.height));
    let (mw, mh) = (u64::from(most.0), u64::from(most.1));
    let (width, height) = if w <= mw && h <= mh {
        (w, h)
    } else if w * mh >= h * mw {
        (mw, (h * mw / w).max(1))
    } else {
        ((w * mh / h).max(1), mh)
    };
    (width as u32, height as u32)
}

/// A smaller picture: every pixel is the mean of those that it covers.
fn shrink(pixels: &Pixels, (width, height): (u32, u32)) -> Pixels {
    let span = |i: u32, to: u32, from: u32| {
        let begin = u64::from(i) * u64::from(from) / u64::from(to);
        let end = (u64::from(i + 1) * u64::from(from)).div_ceil(u64::from(to));
        begin as usize..(end.max(begin + 1)).min(u64::from(from)) as usize
    };
    let mut rgb = Vec::with_capacity(width as usize * height as usize);
    for y in 0..height {
        let rows = span(y, height, pixels.height);
        for x in 0..width {
            let columns = span(x, width, pixels.width);
            let mut sum = [0_u64; 3];
            for row in rows.clone() {
                let line = row * pixels.width as usize;
                for pixel in &pixels.rgb[line + columns.start..line + columns.end] {
                    for (s, c) in sum.iter_mut().zip(pixel) {
                        *s += u64::from(*c);
                    }
                }
            }
            let count = (rows.len() * columns.len()).max(1) as u64;
            rgb.push(sum.map(|s| ((s + count / 2) / count) as u8));
        }
    }
    Pixels { width, height, rgb }
}

fn decode(png: &[u8]) -> Result<Pixels, ShowError> {
    let failed = |e: png::DecodingError| ShowError(e.to_string());
    let mut decoder = png::Decoder::new(Cursor::new(png));
    decoder.set_transformations(png::Transformations::normalize_to_color8());
    let mut reader = decoder.read_info().map_err(failed)?;
    let size = reader.output_buffer_size().ok_or_else(|| ShowError("it is too large".to_owned()))?;
    let mut bytes = vec![0; size];
    let info = reader.next_frame(&mut bytes).map_err(failed)?;
    bytes.truncate(info.buffer_size());
    let rgb = match info.color_type {
        png::ColorType::Rgb => bytes.as_chunks::<3>().0.to_vec(),
        png::ColorType::Rgba => bytes.as_chunks::<4>().0.iter().map(|&[r, g, b, _]| [r, g, b]).collect(),
        png::ColorType::Grayscale => bytes.iter().map(|&v| [v; 3]).collect(),
        png::ColorType::GrayscaleAlpha => bytes.as_chunks::<2>().0.iter().map(|&[v, _]| [v; 3]).collect(),
        png::ColorType::Indexed => return Err(ShowError("its colours are indexed".to_owned())),
    };
    Ok(Pixels { width: info.width, height: info.height, rgb })
}

#[cfg(test)]
mod tests;
