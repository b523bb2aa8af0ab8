//! MOTION section of a BVH file: a number for each channel and frame.

use super::MAX_COORDINATE;
use super::channel::BvhChannel;
use super::hierarchy::HierarchyJoint;
use super::lexer::Lexer;
use super::note::BvhNote;
use crate::io::ReadError;

/// Least number of bytes of a number: a digit and white space before it.
const NUMBER_WIDTH: usize = 2;

/// Numbers of all frames.
#[derive(Debug)]
pub(super) struct MotionSection {
    pub(super) frames: usize,
    /// Time between frames, seconds.
    pub(super) frame_time: f64,
    /// Line of the `Frame Time`.
    pub(super) frame_time_line: usize,
    /// Channel values by frame, then in file order; degrees or the file's unit of length.
    pub(super) values: Vec<f64>,
    pub(super) note: Option<BvhNote>,
}

/// Reads from after the word `MOTION` to the end of the file.
pub(super) fn read(
    lexer: &mut Lexer,
    joints: &[HierarchyJoint],
) -> Result<MotionSection, ReadError> {
    lexer.label(&["Frames"])?;
    let frames = lexer.count("the number of frames")?;
    let frames_line = lexer.line();
    lexer.label(&["Frame", "Time"])?;
    let frame_time = lexer.number(|| "the time from frame to frame in seconds".to_owned())?;
    let frame_time_line = lexer.line();
    // Key times are in single precision.
    if frame_time as f32 <= 0.0 {
        let problem = format!("the frame time must be more than 0 s, not {frame_time}");
        return Err(lexer.error(frame_time_line, problem));
    }
    let channels: Vec<(&HierarchyJoint, BvhChannel)> = joints
        .iter()
        .flat_map(|joint| joint.channels.iter().map(move |channel| (joint, *channel)))
        .collect();
    let (values, whole_frames) = values(lexer, frames, &channels)?;
    let width = channels.len();
    let note = match whole_frames {
        Some(0) => {
            let problem = format!(
                "{frames} frames of {width} numbers are announced, but the file ends in the first"
            );
            return Err(lexer.error(frames_line, problem));
        }
        Some(whole) => Some(BvhNote::MissingFrames {
            line: lexer.line(),
            announced: frames,
            whole,
        }),
        None => surplus(lexer, frames, width)?,
    };
    Ok(MotionSection {
        frames: whole_frames.unwrap_or(frames),
        frame_time,
        frame_time_line,
        values,
        note,
    })
}

/// Reads the numbers of the announced frames. If the file ends early, returns the numbers and count of its whole
/// frames.
fn values(
    lexer: &mut Lexer,
    frames: usize,
    channels: &[(&HierarchyJoint, BvhChannel)],
) -> Result<(Vec<f64>, Option<usize>), ReadError> {
    let width = channels.len();
    // Without channels there are no numbers, for any number of frames.
    let Some(max_frames) = (lexer.remaining_bytes() / NUMBER_WIDTH).checked_div(width) else {
        return Ok((Vec::new(), None));
    };
    let mut values = Vec::with_capacity(max_frames.min(frames) * width);
    for frame in 1..=frames {
        let start = values.len();
        for &(joint, channel) in channels {
            if is_truncated(lexer) {
                lexer.skip_space();
                values.truncate(start);
                return Ok((values, Some(frame - 1)));
            }
            values.push(value(lexer, frame, joint, channel)?);
        }
    }
    Ok((values, None))
}

/// Returns true if the file ends before the next number or within it.
fn is_truncated(lexer: &Lexer) -> bool {
    let rest = lexer.rest().trim_ascii_start();
    let is_of_number = |byte: u8| byte.is_ascii_digit() || b"+-.eE".contains(&byte);
    rest.is_empty() || rest.bytes().all(is_of_number) && rest.parse::<f64>().is_err()
}

/// Reads the text after the announced frames: nothing, or surplus whole frames.
fn surplus(
    lexer: &mut Lexer,
    announced: usize,
    channels: usize,
) -> Result<Option<BvhNote>, ReadError> {
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

fn value(
    lexer: &mut Lexer,
    frame: usize,
    joint: &HierarchyJoint,
    channel: BvhChannel,
) -> Result<f64, ReadError> {
    let what = || {
        let (channel, name) = (channel.name(), &joint.name);
        format!("{channel} of `{name}` in frame {frame}")
    };
    let value = lexer.number(what)?;
    if !channel.is_rotation() && value.abs() > MAX_COORDINATE {
        let problem = format!(
            "{} must be within ±{MAX_COORDINATE:e}, not {value:e}",
            what()
        );
        return Err(lexer.error(lexer.line(), problem));
    }
    Ok(value)
}
