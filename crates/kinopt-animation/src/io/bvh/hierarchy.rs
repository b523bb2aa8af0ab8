//! HIERARCHY section of a BVH file: joints, offsets and channels.

use std::collections::BTreeSet;

use super::MAX_COORDINATE;
use super::channel::{self, BvhChannel};
use super::lexer::{Lexer, Word};
use super::note::BvhNote;
use crate::io::ReadError;

/// Joint or End Site, in file order: parents before children.
#[derive(Debug)]
pub(super) struct HierarchyJoint {
    pub(super) name: String,
    pub(super) parent: Option<usize>,
    /// Offset from the parent, in the file's unit.
    pub(super) offset: [f64; 3],
    /// Channels in file order.
    pub(super) channels: Vec<BvhChannel>,
    /// Line of the joint.
    line: usize,
    /// Number of an End Site among those of its joint, from 1.
    end_site: Option<usize>,
}

/// Block with an open brace.
#[derive(Debug)]
struct OpenBlock {
    joint: usize,
    is_end_site: bool,
    has_offset: bool,
    has_channels: bool,
    joints: usize,
    end_sites: usize,
}

/// Reads up to and including the word `MOTION`. Also returns notes about renamed joints.
pub(super) fn read(lexer: &mut Lexer) -> Result<(Vec<HierarchyJoint>, Vec<BvhNote>), ReadError> {
    lexer.expect("HIERARCHY")?;
    let mut reader = HierarchyReader::default();
    loop {
        let word = lexer.word();
        let Some(open) = reader.open.last_mut() else {
            match word {
                Some(word) if word.is("ROOT") => reader.joint(lexer, word)?,
                Some(word) if word.is("MOTION") && !reader.joints.is_empty() => {
                    let mut joints = reader.joints;
                    let notes = make_names_unique(&mut joints);
                    return Ok((joints, notes));
                }
                _ if reader.joints.is_empty() => return Err(lexer.unexpected("`ROOT`", word)),
                _ => return Err(lexer.unexpected("`ROOT` or `MOTION`", word)),
            }
            continue;
        };
        let joint = &mut reader.joints[open.joint];
        match word {
            Some(word) if word.is("OFFSET") => {
                check_once(lexer, word, open, open.has_offset)?;
                open.has_offset = true;
                joint.offset = offset(lexer, &joint.name)?;
            }
            Some(word) if word.is("CHANNELS") && !open.is_end_site => {
                check_once(lexer, word, open, open.has_channels)?;
                open.has_channels = true;
                joint.channels = channels(lexer, &joint.name)?;
            }
            Some(word) if !open.has_offset => {
                return Err(lexer.unexpected("`OFFSET`", Some(word)));
            }
            Some(word) if word.is("}") => {
                reader.open.pop();
            }
            Some(word) if word.is("JOINT") && !open.is_end_site => {
                open.joints += 1;
                reader.joint(lexer, word)?;
            }
            Some(word) if word.is("End") && !open.is_end_site => {
                open.end_sites += 1;
                reader.end_site(lexer, word)?;
            }
            word if open.is_end_site => return Err(lexer.unexpected("`}`", word)),
            word => {
                let expected = "`OFFSET`, `CHANNELS`, `JOINT`, `End Site` or `}`";
                return Err(lexer.unexpected(expected, word));
            }
        }
    }
}

#[derive(Debug, Default)]
struct HierarchyReader {
    joints: Vec<HierarchyJoint>,
    /// OpenBlock blocks, from a root inwards.
    open: Vec<OpenBlock>,
}

impl HierarchyReader {
    /// Reads `ROOT name {` or `JOINT name {` after its first word.
    fn joint(&mut self, lexer: &mut Lexer, keyword: Word) -> Result<(), ReadError> {
        let Some(name) = lexer.name() else {
            let problem = format!("expected a name after `{}`", keyword.text);
            return Err(lexer.error(keyword.line, problem));
        };
        self.enter(lexer, keyword, name, None)
    }

    /// Reads `End Site {` after its first word.
    fn end_site(&mut self, lexer: &mut Lexer, keyword: Word) -> Result<(), ReadError> {
        lexer.expect("Site")?;
        let number = self.open.last().map(|open| open.end_sites);
        self.enter(lexer, keyword, String::new(), number)
    }

    fn enter(
        &mut self,
        lexer: &mut Lexer,
        keyword: Word,
        name: String,
        end_site: Option<usize>,
    ) -> Result<(), ReadError> {
        lexer.expect("{")?;
        let parent = self.open.last().map(|open| open.joint);
        self.open.push(OpenBlock {
            joint: self.joints.len(),
            is_end_site: end_site.is_some(),
            has_offset: false,
            has_channels: false,
            joints: 0,
            end_sites: 0,
        });
        self.joints.push(HierarchyJoint {
            name,
            parent,
            offset: [0.0; 3],
            channels: Vec::new(),
            line: keyword.line,
            end_site,
        });
        Ok(())
    }
}

/// Names End Sites after their joints, and renames joints with a name already taken. A unique name in the file does not
/// change.
fn make_names_unique(joints: &mut [HierarchyJoint]) -> Vec<BvhNote> {
    let file_names: BTreeSet<String> = joints.iter().map(|joint| joint.name.clone()).collect();
    let mut used_names: BTreeSet<String> = BTreeSet::new();
    let mut notes = Vec::new();
    for index in 0..joints.len() {
        let joint = &joints[index];
        let parent = joint.parent.map(|parent| joints[parent].name.as_str());
        let name = match (joint.end_site, parent) {
            (Some(number), Some(parent)) => end_site_name(parent, number),
            _ => joint.name.clone(),
        };
        let is_free = |name: &String| !used_names.contains(name) && !file_names.contains(name);
        let is_first = !used_names.contains(&name) && (name == joint.name || is_free(&name));
        let bone = match is_first {
            true => name,
            false => {
                let mut candidates = (2..).map(|number: usize| format!("{name}_{number}"));
                let bone = candidates.find(is_free).unwrap_or_default();
                notes.push(BvhNote::Renamed {
                    line: joint.line,
                    name,
                    bone: bone.clone(),
                });
                bone
            }
        };
        used_names.insert(bone.clone());
        joints[index].name = bone;
    }
    notes
}

/// Name of the bone at a joint's End Site; `number` counts the joint's End Sites from 1.
pub(super) fn end_site_name(joint: &str, number: usize) -> String {
    match number {
        1 => format!("{joint}/tip"),
        _ => format!("{joint}/tip/{number}"),
    }
}

/// Checks that a line occurs once in its block and before the children of the joint. The order of the channels is that
/// of the joints.
fn check_once(
    lexer: &Lexer,
    word: Word,
    open: &OpenBlock,
    is_second: bool,
) -> Result<(), ReadError> {
    let problem = match (is_second, open.joints + open.end_sites) {
        (false, 0) => return Ok(()),
        (true, _) => format!("a second `{}` of one joint", word.text),
        (false, _) => format!("`{}` must come before the joint's children", word.text),
    };
    Err(lexer.error(word.line, problem))
}

fn offset(lexer: &mut Lexer, joint: &str) -> Result<[f64; 3], ReadError> {
    let mut offset = [0.0; 3];
    for (number, axis) in offset.iter_mut().zip(["x", "y", "z"]) {
        *number = lexer.number(|| format!("{axis} of the OFFSET of `{joint}`"))?;
        if number.abs() > MAX_COORDINATE {
            let problem = format!("an OFFSET must be within ±{MAX_COORDINATE:e}, not {number:e}");
            return Err(lexer.error(lexer.line(), problem));
        }
    }
    Ok(offset)
}

fn channels(lexer: &mut Lexer, joint: &str) -> Result<Vec<BvhChannel>, ReadError> {
    let number = lexer.count("the number of CHANNELS")?;
    if number > 6 {
        let problem = format!("a joint has at most 6 CHANNELS, not {number}");
        return Err(lexer.error(lexer.line(), problem));
    }
    let mut channels: Vec<BvhChannel> = Vec::new();
    for _ in 0..number {
        let word = lexer.word();
        let named = word.and_then(|word| BvhChannel::of_name(word.text));
        let Some(channel) = named else {
            let expected = "a channel: Xposition, Yposition, Zposition, Xrotation, Yrotation or \
                            Zrotation";
            return Err(lexer.unexpected(expected, word));
        };
        channels.push(channel);
        if let Some(fault) = channel::channel_error(&channels) {
            return Err(lexer.error(lexer.line(), format!("`{joint}` has {fault}")));
        }
    }
    Ok(channels)
}
