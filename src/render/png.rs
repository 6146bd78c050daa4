//! Pictures as PNG files.

use super::sheet::Picture;

/// What matters more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Speed {
    /// Time: a few milliseconds, for a picture that is looked at once.
    Fast,
    /// Size: a tenth of a second, for a file that is kept.
    Balanced,
}

/// A picture that cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum PngError {
    /// From the `png` crate.
    #[error("the picture of {width} x {height} cannot be coded: {source}")]
    Coding {
        /// Pixels.
        width: u32,
        /// Pixels.
        height: u32,
        /// What the coder says.
        source: ::png::EncodingError,
    },
}

/// The bytes of a PNG file.
///
/// # Errors
/// [`PngError::Coding`] for a picture without pixels or whose pixels do not fit its size.
pub fn encode(picture: &Picture, speed: Speed) -> Result<Vec<u8>, PngError> {
    let mut bytes = Vec::new();
    let (width, height) = (picture.width, picture.height);
    let written = (|| {
        let mut writer = encoder(&mut bytes, (width, height), speed).write_header()?;
        writer.write_image_data(&picture.pixels)?;
        writer.finish()
    })();
    written.map_err(|source| PngError::Coding { width, height, source })?;
    Ok(bytes)
}

/// An encoder of sRGB pictures of a size, still or animated.
pub(super) fn encoder(
    bytes: &mut Vec<u8>,
    (width, height): (u32, u32),
    speed: Speed,
) -> ::png::Encoder<'_, &mut Vec<u8>> {
    let mut encoder = ::png::Encoder::new(bytes, width, height);
    encoder.set_color(::png::ColorType::Rgb);
    encoder.set_depth(::png::BitDepth::Eight);
    encoder.set_source_srgb(::png::SrgbRenderingIntent::Perceptual);
    encoder.set_compression(match speed {
        Speed::Fast => ::png::Compression::Fast,
        Speed::Balanced => ::png::Compression::Balanced,
    });
    encoder
}

/// Most pixels of a picture that is read back.
const MOST_PIXELS: u64 = 64_000_000;

/// The picture in a PNG file; an alpha channel is dropped.
///
/// # Errors
/// What is wrong with the file.
pub fn decode(bytes: &[u8]) -> Result<Picture, String> {
    let mut decoder = ::png::Decoder::new(std::io::Cursor::new(bytes));
    decoder.set_transformations(::png::Transformations::normalize_to_color8());
    let mut reader = decoder.read_info().map_err(|e| e.to_string())?;
    let (width, height) = reader.info().size();
    if u64::from(width) * u64::from(height) > MOST_PIXELS {
        return Err(format!("{width} x {height} pixels are too many"));
    }
    let mut raw = vec![0; reader.output_buffer_size().ok_or("it is too large")?];
    let info = reader.next_frame(&mut raw).map_err(|e| e.to_string())?;
    let channels = info.color_type.samples();
    let colour = |p: &[u8]| if channels < 3 { [p[0]; 3] } else { [p[0], p[1], p[2]] };
    let pixels = raw[..info.buffer_size()].chunks_exact(channels).flat_map(colour).collect();
    Ok(Picture { width, height, pixels })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_back() {
        let pixels: Vec<u8> = (0..37 * 11 * 3).map(|i| (i * i % 251) as u8).collect();
        let picture = Picture { width: 37, height: 11, pixels };
        for speed in [Speed::Fast, Speed::Balanced] {
            let bytes = encode(&picture, speed).unwrap();
            let mut reader = ::png::Decoder::new(std::io::Cursor::new(&bytes)).read_info().unwrap();
            let mut back = vec![0; reader.output_buffer_size().unwrap()];
            let info = reader.next_frame(&mut back).unwrap();
            assert_eq!((info.width, info.height, info.color_type), (37, 11, ::png::ColorType::Rgb));
            assert_eq!(back, picture.pixels);
            assert_eq!(decode(&bytes).unwrap(), picture);
            assert!(decode(&bytes[..bytes.len() / 2]).is_err());
        }
    }

    #[test]
    fn a_picture_that_is_none_is_refused() {
        assert!(encode(&Picture { width: 0, height: 3, pixels: Vec::new() }, Speed::Fast).is_err());
        assert!(encode(&Picture { width: 2, height: 2, pixels: vec![0; 5] }, Speed::Fast).is_err());
    }
}
