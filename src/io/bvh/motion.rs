//! The MOTION of a BVH file: a number for each channel and frame.

use super::LONGEST;
use super::channel::BvhChannel;
use super::hierarchy::Joint;
use super::lexer::Lexer;
use super::note::BvhNote;
use crate::io::{FromFile, Place, ReadError};

/// The fewest bytes that a number takes: a digit and the white space before it.
const TEXT_WIDTH: u128 = 2;

/// The numbers of all frames.
#[derive(Debug)]
pub(super) struct Motion {
    pub(super) frames: usize,
    /// From one frame to the next, in seconds.
    pub(super) frame_time: f64,
    /// The line that `frame_time` stands on.
    pub(super) frame_time_line: usize,
    /// Frame by frame, the joints' channels in the order of the file. In degrees and the file's unit.
    pub(super) values: Vec<f64>,
    pub(super) surplus: Option<BvhNote>,
}

/// Reads what follows the word `MOTION`, to the end of the file.
pub(super) fn read(lexer: &mut Lexer, joints: &[Joint]) -> FromFile<Motion> {
    lexer.label(&["Frames"])?;
    let frames = lexer.count("the number of frames")?;
    let frames_line = lexer.line();
    lexer.label(&["Frame", "Time"])?;
    let frame_time = lexer.number(|| "the time from frame to frame in seconds".to_owned())?;
    let frame_time_line = lexer.line();
    // In single precision too, which key times are in.
    if frame_time as f32 <= 0.0 {
        let problem = format!("the frame time must be more than 0 s, not {frame_time}");
        return Err(lexer.error(frame_time_line, problem));
    }
    let channels = joints.iter().map(|joint| joint.channels.len()).sum();
    check_room(lexer, frames, frames_line, channels)?;
    let mut values = Vec::with_capacity(frames * channels);
    // Without channels there is nothing to read, however many frames there are.
    let rows = if channels == 0 { 0 } else { frames };
    for frame in 1..=rows {
        for joint in joints {
            for &channel in &joint.channels {
                values.push(value(lexer, frame, joint, channel)?);
            }
        }
    }
    let surplus = surplus(lexer, frames, channels)?;
    Ok(Motion {
        frames,
        frame_time,
        frame_time_line,
        values,
        surplus,
    })
}

/// What is there after the frames announced: nothing, or whole frames more.
fn surplus(lexer: &mut Lexer, announced: usize, channels: usize) -> FromFile<Option<BvhNote>> {
    let Some(first) = lexer.word() else {
        return Ok(None);
    };
    let (mut next, mut numbers) = (Some(first), 0);
    while let Some(word) = next {
        if !word.text.parse::<f64>().is_ok_and(f64::is_finite) {
            break;
        }
        numbers += 1;
        next = lexer.word();
    }
    if next.is_some() || channels == 0 || numbers % channels != 0 {
        let expected =
            format!("the end of the file after {announced} frames of {channels} numbers");
        return Err(lexer.unexpected(&expected, Some(first)));
    }
    Ok(Some(BvhNote::SurplusFrames {
        line: first.line,
        announced,
        surplus: numbers / channels,
    }))
}

/// Whether the numbers announced can be in the rest of the file.
fn check_room(lexer: &Lexer, frames: usize, line: usize, channels: usize) -> FromFile<()> {
    let needed = TEXT_WIDTH * frames as u128 * channels as u128;
    let available = lexer.left();
    if needed <= available as u128 {
        return Ok(());
    }
    let what = format!("{frames} frames of {channels} numbers");
    let (file, place) = (lexer.file(), Place::Line(line));
    Err(ReadError::truncated(file, place, what, needed, available))
}

fn value(lexer: &mut Lexer, frame: usize, joint: &Joint, channel: BvhChannel) -> FromFile<f64> {
    let what = || {
        let (channel, name) = (channel.name(), &joint.name);
        format!("{channel} of `{name}` in frame {frame}")
    };
    let value = lexer.number(what)?;
    if !channel.is_rotation() && value.abs() > LONGEST {
        let problem = format!("{} must be within ±{LONGEST:e}, not {value:e}", what());
        return Err(lexer.error(lexer.line(), problem));
    }
    Ok(value)
}
