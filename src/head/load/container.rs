//! The outside of a glTF: GLB chunks, data URIs, names of sibling files.

use super::{LoadError, MAX_BYTES, Siblings};

/// The JSON of a glTF and, of a GLB, its binary chunk.
pub(super) fn open(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), LoadError> {
    if !bytes.starts_with(b"glTF") {
        return Ok((bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes), None));
    }
    let fail = |offset: usize, problem: String| Err(LoadError::Glb { offset, problem });
    let word = |at: usize| -> Option<u32> { Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?)) };
    let (Some(version), Some(length)) = (word(4), word(8)) else {
        return fail(bytes.len(), format!("the file ends within its header of 12 bytes, after `{}`", bytes.len()));
    };
    if version != 2 {
        return fail(4, format!("glTF version `{version}`, expected 2"));
    }
    let length = length as usize;
    if length > bytes.len() {
        return fail(8, format!("the file says `{length}` bytes, but ends after {}", bytes.len()));
    }
    let (mut json, mut blob, mut at) = (None, None, 12);
    while at < length {
        let (Some(size), Some(kind)) = (word(at), word(at + 4).filter(|_| at + 8 <= length)) else {
            // A few bytes of filling after the last chunk do no harm.
            if json.is_some() {
                break;
            }
            return fail(at, format!("the file ends within a chunk's header, after `{length}` bytes"));
        };
        let start = at + 8;
        let Some(chunk) = start.checked_add(size as usize).filter(|&e| e <= length).and_then(|e| bytes.get(start..e))
        else {
            return fail(at, format!("a chunk of `{size}` bytes, but the file ends {} bytes further", length - start));
        };
        match &kind.to_le_bytes() {
            b"JSON" if json.is_none() => json = Some(chunk),
            b"BIN\0" if blob.is_none() => blob = Some(chunk),
            // The format asks readers to skip chunks they do not know.
            _ => {}
        }
        at = start + size as usize;
    }
    match json {
        Some(json) => Ok((json, blob)),
        None => fail(12, "no `JSON` chunk".into()),
    }
}

/// The bytes of a buffer with a `uri`.
pub(super) fn fetch(uri: &str, siblings: &dyn Siblings) -> Result<Vec<u8>, LoadError> {
    if let Some(data) = uri.strip_prefix("data:") {
        let fail = |problem: &str| LoadError::Sibling { name: shown(uri), problem: problem.to_owned() };
        let (kind, text) = data.split_once(',').ok_or_else(|| fail("a data uri without a comma"))?;
        if !kind.ends_with(";base64") {
            return Err(fail("only base64 data is read"));
        }
        return base64(text).ok_or_else(|| fail("not base64"));
    }
    let fail = |problem: String| LoadError::Sibling { name: shown(uri), problem };
    let name = unescape(uri).ok_or_else(|| fail("a broken % escape".into()))?;
    let is_outside = name.contains([':', '\\', '\0'])
        || name.is_empty()
        || name.starts_with('/')
        || name.split('/').any(|part| part == "..");
    if is_outside {
        return Err(fail("it leads out of the file's folder".into()));
    }
    let bytes = siblings.read(&name).map_err(|e| fail(e.to_string()))?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(LoadError::TooMuch { what: "bytes".into(), count: bytes.len() as u64, limit: MAX_BYTES });
    }
    Ok(bytes)
}

fn shown(uri: &str) -> String {
    if uri.chars().count() <= 60 { uri.to_owned() } else { uri.chars().take(57).chain("...".chars()).collect() }
}

/// Undoes `%20` and its kin.
fn unescape(uri: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, tail @ ..] = rest {
        rest = tail;
        if *first != b'%' {
            bytes.push(*first);
            continue;
        }
        let hex = |b: u8| char::from(b).to_digit(16);
        let [high, low, tail @ ..] = rest else { return None };
        bytes.push((hex(*high)? * 16 + hex(*low)?) as u8);
        rest = tail;
    }
    String::from_utf8(bytes).ok()
}

/// Base64 (RFC 4648, 4 or 5), with or without padding.
fn base64(text: &str) -> Option<Vec<u8>> {
    let text = text.trim_end_matches('=').as_bytes();
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3 + 3);
    for group in text.chunks(4) {
        let mut bits = 0_u32;
        for &b in group {
            let value = match b {
                b'A'..=b'Z' => b - b'A',
                b'a'..=b'z' => b - b'a' + 26,
                b'0'..=b'9' => b - b'0' + 52,
                b'+' | b'-' => 62,
                b'/' | b'_' => 63,
                _ => return None,
            };
            bits = bits << 6 | u32::from(value);
        }
        if group.len() == 1 {
            return None;
        }
        bits <<= 6 * (4 - group.len());
        bytes.extend_from_slice(&bits.to_be_bytes()[1..group.len()]);
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::head::load::NoSiblings;

    #[test]
    fn base64_follows_the_standard() {
        for (text, plain) in
            [("", ""), ("Zg==", "f"), ("Zm8=", "fo"), ("Zm9v", "foo"), ("Zm9vYg", "foob"), ("Zm9vYmE=", "fooba")]
        {
            assert_eq!(base64(text).unwrap(), plain.as_bytes());
        }
        assert_eq!(base64("-_+/").unwrap(), [0xfb, 0xff, 0xbf]);
        assert_eq!((base64("A"), base64("Zm9\u{20}")), (None, None));
    }

    #[test]
    fn siblings_stay_in_the_folder() {
        let read = |name: &str| Ok(name.as_bytes().to_vec());
        assert_eq!(fetch("my%20head/a.bin", &read).unwrap(), b"my head/a.bin");
        for bad in [
            "../a.bin",
            "a/../../b",
            "/etc/passwd",
            "http://x/y",
            "C:\\a",
            "%2e%2e/a",
            "%2Fetc",
            "",
            "a%",
            "a%zz",
            "%ff",
        ] {
            assert!(matches!(fetch(bad, &read), Err(LoadError::Sibling { .. })), "{bad}");
        }
        assert_eq!(
            fetch("a.bin", &NoSiblings).unwrap_err().to_string(),
            "`a.bin` cannot be read: the file stands alone"
        );
        assert_eq!(
            fetch("data:,abc", &read).unwrap_err().to_string(),
            "`data:,abc` cannot be read: only base64 data is read"
        );
    }
}
