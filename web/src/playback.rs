//! Playback modes outside the span of a clip.

use kinopt::animation::Playback;
use kinopt::model::UnknownName;

use crate::error::{Exception, raise};

/// Returns a playback mode by its name; the default is "hold".
pub(crate) fn playback(name: Option<&str>) -> Result<Playback, Exception> {
    match name {
        None | Some("hold") => Ok(Playback::Hold),
        Some("loop") => Ok(Playback::Loop),
        Some("ping-pong") => Ok(Playback::PingPong),
        Some(other) => {
            let names = ["hold", "loop", "ping-pong"];
            Err(raise(UnknownName::new("playback", other, names)))
        }
    }
}
