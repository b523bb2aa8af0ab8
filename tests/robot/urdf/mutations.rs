//! Promise: each of thousands of damaged copies of the shipped files is an error with the file's name, or a consistent
//! model. Never a panic or a hang.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::collections::BTreeMap;

use kinopt::kinematics::ForwardKinematics;
use kinopt::robot::{Robot, RobotFileError};
use support::random::{Random, case_count};

const FILES: [&str; 8] = [
    "../models/adept_cobra_s600.urdf",
    "../models/aldebaran_nao.urdf",
    "../models/franka_panda.urdf",
    "../models/kuka_iiwa14.urdf",
    "../models/rethink_baxter.urdf",
    "../models/universal_ur10e.urdf",
    "../models/universal_ur5e.urdf",
    "reference/oblique.urdf",
];

const VALUES: [&str; 22] = [
    "",
    " ",
    "0",
    "-0",
    "1",
    "nan",
    "-inf",
    "1e400",
    "1e308",
    "-1e308",
    "4e-324",
    "0 0 0",
    "1 2",
    "1 2 3 4",
    "0x10",
    "1,5",
    "joint1",
    "torso",
    "${x}",
    "&lt;",
    "\u{1F916}",
    "fixed",
];
const TYPES: [&str; 9] = [
    "revolute",
    "continuous",
    "prismatic",
    "fixed",
    "floating",
    "planar",
    "spherical",
    "Fixed",
    "screw",
];
const PIECES: [&str; 14] = [
    "<",
    ">",
    "\"",
    "/>",
    "</joint>",
    "<joint>",
    "<mimic joint=\"joint1\"/>",
    "<axis xyz=\"0 0 0\"/>",
    "<limit lower=\"1\" upper=\"0\" velocity=\"1\"/>",
    "<!--",
    "]]>",
    "<?x?>",
    "\0",
    "&#x41;",
];

/// Byte ranges of attribute values.
fn values(text: &str) -> Vec<(usize, usize)> {
    let quotes: Vec<usize> = text.match_indices('"').map(|(at, _)| at).collect();
    quotes
        .chunks_exact(2)
        .map(|pair| (pair[0] + 1, pair[1]))
        .collect()
}

fn mutate(text: &str, random: &mut Random) -> String {
    let boundary = |mut at: usize| {
        while !text.is_char_boundary(at) {
            at -= 1;
        }
        at
    };
    match random.below(8) {
        // Replaces a value by another value.
        0 | 1 => {
            let (from, to) = *random.pick(&values(text));
            let value = *random.pick(&VALUES);
            format!("{}{value}{}", &text[..from], &text[to..])
        }
        // Replaces a value by one from elsewhere in the file, which mixes links and joints.
        2 | 3 => {
            let all = values(text);
            let ((from, to), (a, b)) = (*random.pick(&all), *random.pick(&all));
            format!("{}{}{}", &text[..from], &text[a..b], &text[to..])
        }
        4 => {
            let kinds: Vec<_> = text
                .match_indices("type=\"")
                .map(|(at, _)| at + 6)
                .collect();
            let from = *random.pick(&kinds);
            let to = from + text[from..].find('"').unwrap_or(0);
            format!("{}{}{}", &text[..from], random.pick(&TYPES), &text[to..])
        }
        // Removes, doubles or moves a line.
        5 => {
            let mut lines: Vec<&str> = text.lines().collect();
            let (from, to) = (
                random.below(lines.len().max(1)),
                random.below(lines.len().max(1)),
            );
            match random.below(3) {
                0 => drop(lines.remove(from)),
                1 => lines.insert(to, lines[from]),
                _ => lines.swap(from, to),
            }
            lines.join("\n")
        }
        6 => {
            let at = boundary(random.below(text.len().max(1)));
            format!("{}{}{}", &text[..at], random.pick(&PIECES), &text[at..])
        }
        // Removes a range.
        _ => {
            let from = boundary(random.below(text.len().max(1)));
            let to = boundary((from + random.below(40)).min(text.len()));
            format!("{}{}", &text[..from], &text[to.max(from)..])
        }
    }
}

fn assert_sound(robot: &Robot) {
    let model = robot.model();
    for joint in model.joints() {
        let [x, y, z] = joint.axis.to_array();
        assert!(((x * x + y * y + z * z).sqrt() - 1.0).abs() < 1e-12);
        assert!(joint.limits.is_valid());
    }
    let map = robot.map();
    for (lower, upper) in map.lower().iter().zip(map.upper()) {
        assert!(lower <= upper);
    }
    let mut x = vec![0.0; map.variables()];
    map.reduce(&model.neutral(), &mut x).unwrap();
    let mut q = vec![0.0; model.configuration_len()];
    map.expand_within_limits(&x, &mut q).unwrap();
    for (value, limits) in q.iter().zip(model.limits()) {
        assert!(limits.contains(*value), "{value} outside {limits:?}");
    }
    let frames: Vec<_> = model.frame_ids().collect();
    let mut kinematics = ForwardKinematics::under(model, map, &frames).unwrap();
    assert_eq!(kinematics.place(&x).unwrap().len(), frames.len());
}

#[test]
fn damaged_file_is_an_error_or_a_valid_model() {
    let mut outcomes: BTreeMap<&str, u32> = BTreeMap::new();
    let copies = case_count(600, 300) as u64;
    for (number, file) in FILES.iter().enumerate() {
        let text = std::fs::read_to_string(file).unwrap();
        for copy in 0..copies {
            let mut random = Random::split_mix(1_000_000 * number as u64 + copy);
            let mut damaged = text.clone();
            for _ in 0..=random.below(3) {
                damaged = mutate(&damaged, &mut random);
            }
            let outcome = match Robot::parse(&damaged, "damaged.urdf") {
                Ok(robot) => {
                    assert_sound(&robot);
                    "read"
                }
                Err(error) => {
                    let message = error.to_string();
                    assert!(message.starts_with("damaged.urdf:"), "{message}");
                    match error {
                        RobotFileError::NotXml { .. } => "not XML",
                        RobotFileError::Xacro { .. } => "xacro",
                        RobotFileError::Element { .. } => "element",
                        RobotFileError::Model { .. } => "model",
                        other => panic!("{file}, copy {copy}: {other}"),
                    }
                }
            };
            *outcomes.entry(outcome).or_default() += 1;
        }
    }
    // Enough copies are damaged, and some are still readable.
    let kinds: Vec<_> = outcomes.keys().copied().collect();
    assert_eq!(kinds, ["element", "model", "not XML", "read", "xacro"]);
    let often = |outcome, sixths| 6 * u64::from(outcomes[outcome]) > sixths * copies;
    assert!(often("read", 3) && often("element", 6), "{outcomes:?}");
}
