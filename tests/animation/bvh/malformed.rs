//! Promise: a damaged motion capture file gives an error with its name, the line and the fault, or a valid capture. It
//! never causes a panic, and no memory is allocated for counts without data.

use std::ops::Range;

use kinopt::animation::{Cursor, Playback};
use kinopt::io::FileLocation;
use kinopt::io::bvh::{self, BvhNote, MotionCapture};
use support::fault_tables::{ExpectedError, faults};

static VALID_FILE: &str = "HIERARCHY
ROOT Hips
{
  OFFSET 0 9 0.5
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT Chest
  {
    OFFSET 0 5 0.25
    CHANNELS 3 Zrotation Yrotation Xrotation
    End Site
    {
      OFFSET 0 3 0
    }
  }
  JOINT Leg
  {
    OFFSET 1 -4 0.125
    CHANNELS 1 Xrotation
    End Site
    {
      OFFSET 0 -4 0
    }
  }
}
MOTION
Frames: 2
Frame Time: 0.04
1.5 9.25 2 10 20 30 40 50 60 70
1.25 9 3 11 21 31 41 51 61 71
";

/// Reads damaged text. An error begins with the file's name and one of its lines; a capture can be played and contains
/// finite numbers only.
fn read(text: &str) -> Result<MotionCapture, String> {
    match bvh::from_bytes(text.as_bytes(), "damaged.bvh") {
        Ok(capture) => {
            let mut pose = capture.armature.rest().clone();
            let mut cursor = Cursor::new();
            for frame in 0..capture.frames.min(3) {
                let seconds = frame as f64 * capture.frame_time;
                (capture.clip)
                    .sample(seconds, Playback::Hold, &mut cursor, &mut pose)
                    .unwrap();
                assert!(
                    pose.translations()
                        .iter()
                        .all(|translation| translation.is_finite())
                );
                assert!(pose.rotations().iter().all(|turn| turn.is_normalized()));
            }
            Ok(capture)
        }
        Err(error) => {
            let lines = 1..=1 + text.matches('\n').count();
            assert!(matches!(&error.place, FileLocation::Line(line) if lines.contains(line)));
            let message = error.to_string();
            assert!(message.starts_with("damaged.bvh: line "), "{message}");
            Err(message)
        }
    }
}

fn refused(text: &str, parts: &str) {
    read(text).says(parts);
}

/// Byte range of each word.
fn words() -> Vec<Range<usize>> {
    let start = |word: &str| word.as_ptr() as usize - VALID_FILE.as_ptr() as usize;
    let words = VALID_FILE.split_whitespace();
    words
        .map(|word| start(word)..start(word) + word.len())
        .collect()
}

fn with(range: &Range<usize>, new: &str) -> String {
    format!(
        "{}{new}{}",
        &VALID_FILE[..range.start],
        &VALID_FILE[range.end..]
    )
}

fn line_of(range: &Range<usize>) -> usize {
    1 + VALID_FILE[..range.start].matches('\n').count()
}

/// True for names, which may be anything, and numbers of an `OFFSET` or a frame, which may have any value.
fn is_name(range: &Range<usize>) -> bool {
    matches!(&VALID_FILE[range.clone()], "Hips" | "Chest" | "Leg")
}

fn is_value(range: &Range<usize>) -> bool {
    let number = VALID_FILE[range.clone()].parse::<f64>().is_ok();
    let before = VALID_FILE[..range.start].split_whitespace().last();
    number && !matches!(before, Some("CHANNELS" | "Frames:" | "Time:"))
}

#[test]
fn valid_file_is_read() {
    let capture = read(VALID_FILE).unwrap();
    let names = ["Hips", "Chest", "Chest/tip", "Leg", "Leg/tip"];
    assert_eq!(
        (capture.armature.names(), capture.frames),
        (&names.map(String::from)[..], 2)
    );
}

#[test]
fn replaced_words_are_errors_with_their_line() {
    let good = read(VALID_FILE).unwrap();
    for word in words() {
        for new in [
            "NaN", "-1", "1e400", "-inf", "1e39", "{", "}", "0x1", "1,5", "Stop", "Å",
        ] {
            let text = with(&word, new);
            let is_brace = matches!(new, "{" | "}");
            let case = format!(
                "`{}` of line {}: `{new}`",
                &VALID_FILE[word.clone()],
                line_of(&word)
            );
            match read(&text) {
                Ok(_) if is_name(&word) && !is_brace => (),
                // Angles may be any number, lengths only numbers within single precision.
                Ok(capture) if is_value(&word) && matches!(new, "-1" | "1e39") => {
                    assert_ne!(capture, good, "{case}");
                }
                Ok(_) => assert_eq!(new, &VALID_FILE[word.clone()], "{case}"),
                // A surplus or missing brace may only be noticed on a later line.
                Err(message) if !is_brace => {
                    let line = format!("line {}: ", line_of(&word));
                    assert!(message.contains(&line), "{case}: {message}");
                }
                Err(_) => (),
            }
        }
    }
}

#[test]
fn each_end_is_cut_off() {
    // Within the last number of a frame the rest is a valid number as well.
    let frame_ends = ["70\n", "71\n"].map(|last| VALID_FILE.find(last).unwrap() + 1);
    let whole = read(VALID_FILE).unwrap();
    let start = |capture: &MotionCapture| {
        let mut pose = capture.armature.rest().clone();
        let (clip, mut cursor) = (&capture.clip, Cursor::new());
        clip.sample(0.0, Playback::Hold, &mut cursor, &mut pose)
            .unwrap();
        pose
    };
    for end in 0..frame_ends[0] {
        refused(&VALID_FILE[..end], "");
    }
    for end in frame_ends[0]..frame_ends[1] {
        let cut = read(&VALID_FILE[..end]).unwrap();
        assert_eq!(cut.frames, 1, "cut at {end}");
        for (first, other) in start(&cut)
            .rotations()
            .iter()
            .zip(start(&whole).rotations())
        {
            assert!(end == frame_ends[0] || first.abs_diff_eq(*other, 1e-6));
        }
        let note = cut.notes[0].to_string();
        assert!(
            note.contains("ends after 1 whole frame of 2 announced"),
            "{note}"
        );
    }
}

/// Faults that replace one passage.
const FAULTS: &str = r#"
ROOT Hips => ROOT | line 2: expected a name after `ROOT`
Hips\n{ => Hips\n | line 4: expected `{`, found `OFFSET`
OFFSET 0 9 0.5 => OFFSET 0 9 | line 5: expected z of the OFFSET of `Hips`, a finite number, found `CHANNELS`
OFFSET 0 9 0.5 => OFFSET 0 9 -1e31 | line 4: an OFFSET must be within ±1e30, not -1e31
    OFFSET 0 5 0.25\n =>  | line 9: expected `OFFSET`, found `End`
CHANNELS 1 X => CHANNELS 7 X | line 18: a joint has at most 6 CHANNELS
1 Xrotation => 1 Xrot | line 18: expected a channel: Xposition | Zrotation, found `Xrot`
1 Xrotation => 2 Xrotation Xrotation | line 18: `Leg` has Xrotation twice
1 Xrotation => 2 Xposition Xposition | line 18: `Leg` has Xposition twice
1 Xrotation => 4 Xrotation Yrotation Zrotation Xrotation | line 18: `Leg` has more than three rotations
OFFSET 0 3 0\n => OFFSET 0 3 0 CHANNELS 0\n | line 12: expected `}`
}\nMOTION => MOTION | line 24: expected `OFFSET` | `}`, found `MOTION`
}\nMOTION => }}\nMOTION | line 24: expected `ROOT` or `MOTION`, found `}`
Frames: => Count: | line 26: expected `Frames:`, found `Count:`
Frames: 2 => Frames: 2.5 | line 26:  | a whole number, found `2.5`
Time: 0.04 => Time: 1e39 | line 27:  | must be finite
51 61 => NaN 61 | line 29: expected Yrotation of `Chest` in frame 2, a finite number, found `NaN`
9.25 2 => 9.25e30 2 | line 28: Yposition of `Hips` in frame 1 | ±1e30
61 71\n => 61 71\n\n5 | line 31: expected the end of the file after 2 frames of 10 numbers, found `5`
61 71\n => 61 71\n1 2 3 4 5 6 7 8 9 10 11 | line 30: expected the end of the file after 2 frames of 10 numbers, found `1`
"#;

#[test]
fn errors_name_what_was_expected_and_where() {
    for fault in faults(FAULTS) {
        fault.check(read(&fault.applied(VALID_FILE)));
    }
    let edit = |old: &str, new: &str| {
        assert_eq!(VALID_FILE.matches(old).count(), 1, "{old}");
        VALID_FILE.replace(old, new)
    };
    refused("", "line 1: expected `HIERARCHY`, but the file ends");
    refused("HIERARCHY MOTION", "expected `ROOT`, found `MOTION`");
    let moved = edit("  JOINT Leg\n", "  OFFSET 1 2 3\n  JOINT Leg\n");
    refused(&moved, "line 15: a second `OFFSET` of one joint");
    let channels = "    CHANNELS 1 Xrotation\n";
    let late =
        edit(channels, "").replace("0 -4 0\n    }\n", &format!("0 -4 0\n    }}\n{channels}"));
    refused(
        &late,
        "line 22: `CHANNELS` must come before the joint's children",
    );
    let channels = "  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n";
    let late = edit(channels, "").replace("  JOINT Leg\n", &format!("{channels}  JOINT Leg\n"));
    refused(
        &late,
        "line 14: `CHANNELS` must come before the joint's children",
    );
    for time in ["0", "-0.04", "1e-50"] {
        let text = edit("Time: 0.04", &format!("Time: {time}"));
        refused(&text, "line 27: the frame time must be more than 0 s");
    }
    let long = format!("HIERARCHY {}", "ä".repeat(1000));
    assert!(read(&long).unwrap_err().len() < 200);
}

/// Frames beyond the announced number are ignored, as in three.js and Assimp.
#[test]
fn surplus_frames_are_omitted_with_a_note() {
    let good = read(VALID_FILE).unwrap();
    assert!(good.notes.is_empty());
    let more = format!("{VALID_FILE}\n1 2 3 4 5 6 7 8 9 10\n1 2 3 4 5 6 7 8 9 1e1\n\n");
    let surplus = read(&more).unwrap();
    let note = BvhNote::SurplusFrames {
        line: 31,
        announced: 2,
        surplus: 2,
    };
    assert_eq!((surplus.clip, surplus.frames), (good.clip, 2));
    assert_eq!(
        note.to_string(),
        "line 31: 2 frames more than the 2 announced: left out"
    );
    assert_eq!(surplus.notes, [note]);
    let one = VALID_FILE.replace("Frames: 2", "Frames: 1");
    assert_eq!(read(&one).unwrap().notes.len(), 1);
    // Invalid numbers are no frames.
    refused(
        &more.replace("1e1", "nan"),
        "line 31: expected the end of the file",
    );
}

#[test]
fn frames_missing_whole_ones_stay_with_note() {
    for frames in ["3", "400", "1000000000000", "18446744073709551615"] {
        let text = VALID_FILE.replace("Frames: 2", &format!("Frames: {frames}"));
        let capture = read(&text).unwrap();
        assert_eq!(
            (capture.frames, &capture.clip),
            (2, &read(VALID_FILE).unwrap().clip)
        );
        assert_eq!(
            capture.notes[0].to_string(),
            format!("line 30: the file ends after 2 whole frames of {frames} announced")
        );
    }
    let text = format!(
        "{}\n1 2 3 4 5",
        VALID_FILE.replace("Frames: 2", "Frames: 9")
    );
    let capture = read(&text).unwrap();
    assert_eq!((capture.frames, capture.notes.len()), (2, 1));
    // Damage before the end is no truncation.
    refused(
        &VALID_FILE
            .replace("Frames: 2", "Frames: 3")
            .replace("51 61", "x 61"),
        "line 29: expected Yrotation of `Chest` in frame 2",
    );
}

#[test]
fn first_frame_cut_is_an_error() {
    let text = VALID_FILE.replace(
        "1.5 9.25 2 10 20 30 40 50 60 70\n1.25 9 3 11 21 31 41 51 61 71\n",
        "1 2 3",
    );
    refused(
        &text,
        "line 26: 2 frames of 10 numbers are announced, but the file ends in the first",
    );
}

#[test]
fn duplicate_names_get_a_suffix_with_note() {
    let named = |chest: &str, leg: &str| {
        let text = VALID_FILE.replace("JOINT Chest", &format!("JOINT {chest}"));
        let capture = read(&text.replace("JOINT Leg", &format!("JOINT {leg}"))).unwrap();
        let notes: Vec<String> = capture.notes.iter().map(ToString::to_string).collect();
        (capture.armature.names().join(" "), notes.join("\n"))
    };
    let (names, notes) = named("Leg", "Leg");
    assert_eq!(names, "Hips Leg Leg/tip Leg_2 Leg_2/tip");
    assert_eq!(
        notes,
        "line 15: joint `Leg` is named `Leg_2`, as another joint has its name"
    );
    let (names, _) = named("Hips", "Hips");
    assert_eq!(names, "Hips Hips_2 Hips_2/tip Hips_3 Hips_3/tip");
    // Another joint of the file keeps its own name.
    let (names, _) = named("Hips", "Hips_2");
    assert_eq!(names, "Hips Hips_3 Hips_3/tip Hips_2 Hips_2/tip");
    let (names, notes) = named("Chest", "Chest/tip");
    assert_eq!(names, "Hips Chest Chest/tip_2 Chest/tip Chest/tip/tip");
    assert!(
        notes.starts_with("line 10: joint `Chest/tip` is named"),
        "{notes}"
    );
}

#[test]
fn announced_frames_are_not_allocated() {
    // Without channels frames need no numbers.
    let still = "HIERARCHY ROOT a\n{OFFSET 0 0 0} MOTION Frames: 1000000000000 Frame Time: 0.5";
    let capture = read(still).unwrap();
    assert_eq!(
        (capture.frames, capture.clip.span()[1]),
        (1_000_000_000_000, 5e11)
    );
}

#[test]
fn frame_times_equal_in_f32_are_rejected() {
    // The smallest number is 1.4e-45, and both 1e-45 and 2e-45 round to it.
    let text = VALID_FILE
        .replace("0.04", "1e-45")
        .replace("Frames: 2", "Frames: 3");
    let text = format!("{text}0 0 0 0 0 0 0 0 0 0");
    refused(&text, "line 27: key 2:  | not after the key before it");
}

#[test]
fn nesting_depth_is_unlimited() {
    let depth = 50_000;
    let joints: String = (0..depth)
        .map(|k| format!("JOINT j{k}\n{{OFFSET 0 0 0 "))
        .collect();
    let (body, close) = (&joints[5..], "}".repeat(depth));
    let text = format!("HIERARCHY ROOT{body}{close} MOTION Frames: 0 Frame Time: 1");
    assert_eq!(read(&text).unwrap().armature.bones(), depth);
    refused(
        &text.replace("}}", ""),
        "expected `OFFSET` | found `MOTION`",
    );
}

#[test]
fn bytes_not_utf8_are_latin1_with_note() {
    let mut bytes = VALID_FILE.as_bytes().to_vec();
    let at = VALID_FILE.find("Leg").unwrap();
    bytes[at] = 0xE9;
    let capture = bvh::from_bytes(&bytes, "latin.bvh").unwrap();
    assert_eq!(capture.armature.names()[3], "éeg");
    assert_eq!(
        capture.notes[0].to_string(),
        "line 15: bytes that are not UTF-8 are read as Latin-1"
    );
    // A name in UTF-8 in the same file is unchanged.
    let mut mixed = bytes[..VALID_FILE.find("Hips").unwrap()].to_vec();
    mixed.extend("Hüfte".as_bytes());
    mixed.extend(&bytes[VALID_FILE.find("Hips").unwrap() + 4..]);
    let capture = bvh::from_bytes(&mixed, "latin.bvh").unwrap();
    assert_eq!(capture.armature.names()[0], "Hüfte");
    assert_eq!(capture.armature.names()[3], "éeg");
    let error = bvh::from_bytes(b"\xFF\xFEH\0I\0", "utf16.bvh").unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("utf16.bvh: line 1: expected `HIERARCHY`")
    );
}

#[test]
fn missing_file_is_named() {
    let error = bvh::read("no such.bvh").unwrap_err().to_string();
    assert!(error.starts_with("no such.bvh: "), "{error}");
}

/// Positions are bounded, so that no sum overflows. Angles are periodic, and a rotating sensor counts full turns.
#[test]
fn positions_are_bounded_and_angles_are_not() {
    let text = VALID_FILE.replace("1.25 9 3 11", "1.25 9 3 1e32");
    assert!(read(&text).is_ok());
    for beyond in ["1e32", "-1e32"] {
        let text = VALID_FILE.replace("1.25 9 3 11", &format!("1.25 {beyond} 3 11"));
        refused(&text, "Yposition");
    }
}

/// Line numbers are independent of the line endings.
#[test]
fn line_numbers_are_independent_of_line_endings() {
    for word in words().into_iter().filter(is_value).step_by(3) {
        let text = with(&word, "much");
        let places = ["\n", "\r\n", "\r"].map(|end| {
            let text = text.replace('\n', end);
            let error = bvh::from_bytes(text.as_bytes(), "damaged.bvh").unwrap_err();
            error.place
        });
        assert!(
            places
                .iter()
                .all(|location| *location == FileLocation::Line(line_of(&word))),
            "{places:?}"
        );
    }
}
