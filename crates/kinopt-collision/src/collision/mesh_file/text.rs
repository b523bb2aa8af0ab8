//! Text decoding and number parsing.

use kinopt_kinematics::file::{FileLocation, ReadError};

/// Decodes a file's bytes as UTF-8.
pub(super) fn of<'a>(bytes: &'a [u8], file: &str) -> Result<&'a str, ReadError> {
    std::str::from_utf8(bytes).map_err(|error| {
        let at = FileLocation::Byte(error.valid_up_to());
        ReadError::malformed(file, at, "is not UTF-8 text")
    })
}

/// The next three words as finite numbers.
pub(super) fn three<'a>(words: &mut impl Iterator<Item = &'a str>) -> Option<[f64; 3]> {
    let mut next = || words.next()?.parse::<f64>().ok().filter(|x| x.is_finite());
    Some([next()?, next()?, next()?])
}
