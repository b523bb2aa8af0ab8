//! Types of image files by their first bytes, as glTF 2.0 (section 3.8.2.1) recognises them.

/// Media type of a glTF image, and the test of a file's first bytes.
type ImageType = (&'static str, fn(&[u8]) -> bool);

const IMAGE_TYPES: [ImageType; 6] = [
    ("image/png", |bytes| bytes.starts_with(b"\x89PNG\r\n\x1a\n")),
    ("image/jpeg", |bytes| bytes.starts_with(b"\xff\xd8\xff")),
    ("image/webp", |bytes| {
        bytes.starts_with(b"RIFF") && bytes.get(8..12) == Some(b"WEBP")
    }),
    ("image/ktx2", |bytes| {
        bytes.starts_with(b"\xabKTX 20\xbb\r\n\x1a\n")
    }),
    ("image/vnd-ms.dds", |bytes| {
        bytes.starts_with(b"DDS \x7c\0\0\0")
    }),
    ("image/avif", |bytes| bytes.get(4..12) == Some(b"ftypavif")),
];

/// The media type of an image file. `declared` is the type that the document states, if it states one.
///
/// # Errors
/// The first bytes match no type, or not the declared one.
pub(super) fn media_type(bytes: &[u8], declared: Option<&str>) -> Result<&'static str, String> {
    let detected = IMAGE_TYPES.iter().find(|(_, begins)| begins(bytes));
    let detected = detected.map(|(name, _)| *name);
    match (detected, declared) {
        (Some(detected), None) => Ok(detected),
        (Some(detected), Some(declared)) if detected == declared => Ok(detected),
        (_, Some(declared)) => Err(format!("does not begin as an {declared} file")),
        (None, None) => {
            let names = IMAGE_TYPES.map(|(name, _)| name).join(", ");
            Err(format!("does not begin as an image file: {names}"))
        }
    }
}
