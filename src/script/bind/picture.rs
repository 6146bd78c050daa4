//! PNG files as masks.

use crate::head::Mask;

/// Most pixels of a mask.
const MOST_PIXELS: u64 = 64_000_000;

/// A picture's brightness, 0..=1; an alpha channel counts as "less".
///
/// # Errors
/// What is wrong with the file.
pub fn grey(bytes: &[u8]) -> Result<Mask, String> {
    let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::normalize_to_color8());
    let mut reader = decoder.read_info().map_err(|e| e.to_string())?;
    let (width, height) = reader.info().size();
    if u64::from(width) * u64::from(height) > MOST_PIXELS {
        return Err(format!("{width} x {height} pixels are too many"));
    }
    let size = reader.output_buffer_size().ok_or("it is too large")?;
    let mut pixels = vec![0; size];
    let info = reader.next_frame(&mut pixels).map_err(|e| e.to_string())?;
    let channels = info.color_type.samples();
    let value = |p: &[u8]| {
        let level = |c: usize| f32::from(p[c]) / 255.0;
        match channels {
            1 => level(0),
            2 => level(0) * level(1),
            // Luma of sRGB (ITU-R BT.709).
            3 => 0.2126 * level(0) + 0.7152 * level(1) + 0.0722 * level(2),
            _ => (0.2126 * level(0) + 0.7152 * level(1) + 0.0722 * level(2)) * level(3),
        }
    };
    let values = pixels[..info.buffer_size()].chunks_exact(channels).map(value).collect();
    Ok(Mask { width: width as usize, height: height as usize, values })
}
