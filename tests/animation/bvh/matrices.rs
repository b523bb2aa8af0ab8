//! Reference evaluation of BVH files by 3 × 3 matrices in double precision, independent of the library.

use std::fmt::Write;

pub(crate) type Vector = [f64; 3];
pub(crate) type Matrix = [[f64; 3]; 3];

const IDENTITY: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Joint, or End Site if `is_end` is true.
#[derive(Clone, Debug)]
pub(crate) struct Joint {
    pub(crate) name: String,
    pub(crate) parent: Option<usize>,
    pub(crate) offset: Vector,
    pub(crate) channels: Vec<String>,
    pub(crate) is_end: bool,
}

#[derive(Clone, Debug)]
pub(crate) struct File {
    /// Joints in depth-first order.
    pub(crate) joints: Vec<Joint>,
    pub(crate) frame_time: f64,
    pub(crate) frames: Vec<Vec<f64>>,
}

impl Joint {
    pub(crate) fn new(name: &str, parent: Option<usize>, offset: Vector, channels: &str) -> Self {
        Self {
            name: name.to_owned(),
            parent,
            offset,
            channels: channels.split_whitespace().map(str::to_owned).collect(),
            is_end: false,
        }
    }

    pub(crate) fn end(joint: &str, parent: usize, offset: Vector) -> Self {
        let is_end = true;
        let joint = Self::new(&format!("{joint}/tip"), Some(parent), offset, "");
        Self { is_end, ..joint }
    }
}

impl File {
    /// Text with one line for each keyword and each frame.
    pub(crate) fn text(&self) -> String {
        let mut text = "HIERARCHY\n".to_owned();
        let mut open: Vec<usize> = Vec::new();
        for (index, joint) in self.joints.iter().enumerate() {
            while open.last().copied() != joint.parent {
                open.pop().unwrap();
                text.push_str("}\n");
            }
            open.push(index);
            let Joint { name, offset, .. } = joint;
            match (joint.is_end, joint.parent) {
                (true, _) => text.push_str("End Site\n"),
                (_, None) => writeln!(text, "ROOT {name}").unwrap(),
                (_, Some(_)) => writeln!(text, "JOINT {name}").unwrap(),
            }
            writeln!(text, "{{\nOFFSET {} {} {}", offset[0], offset[1], offset[2]).unwrap();
            if !joint.is_end {
                let channels = &joint.channels;
                writeln!(text, "CHANNELS {} {}", channels.len(), channels.join(" ")).unwrap();
            }
        }
        text.push_str(&"}\n".repeat(open.len()));
        let (count, time) = (self.frames.len(), self.frame_time);
        write!(text, "MOTION\nFrames: {count}\nFrame Time: {time}\n").unwrap();
        for frame in &self.frames {
            let numbers: Vec<String> = frame.iter().map(f64::to_string).collect();
            writeln!(text, "{}", numbers.join(" ")).unwrap();
        }
        text
    }

    /// Reads text with one line for each keyword and each frame, as common programs write it.
    pub(crate) fn parse(text: &str) -> Self {
        let mut joints: Vec<Joint> = Vec::new();
        let mut open: Vec<usize> = Vec::new();
        let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
        for line in lines.by_ref() {
            let words: Vec<&str> = line.split_whitespace().collect();
            let parent = open.last().copied();
            match words[0] {
                "ROOT" | "JOINT" => joints.push(Joint::new(words[1], parent, [0.0; 3], "")),
                "End" => {
                    let parent = parent.unwrap();
                    let name = joints[parent].name.clone();
                    joints.push(Joint::end(&name, parent, [0.0; 3]));
                }
                "{" => open.push(joints.len() - 1),
                "}" => drop(open.pop().unwrap()),
                "OFFSET" => {
                    let last = joints.last_mut().unwrap();
                    last.offset = std::array::from_fn(|axis| words[axis + 1].parse().unwrap());
                }
                "CHANNELS" => {
                    let names = words[2..].iter().map(|word| (*word).to_owned());
                    joints.last_mut().unwrap().channels = names.collect();
                }
                "MOTION" => break,
                word => assert_eq!(word, "HIERARCHY"),
            }
        }
        let last_word = |line: &str| line.split_whitespace().last().unwrap().to_owned();
        let count: usize = last_word(lines.next().unwrap()).parse().unwrap();
        let frame_time = last_word(lines.next().unwrap()).parse().unwrap();
        let numbers = |line: &str| {
            line.split_whitespace()
                .map(|w| w.parse().unwrap())
                .collect()
        };
        let frames: Vec<Vec<f64>> = lines.map(numbers).collect();
        assert_eq!(frames.len(), count);
        Self {
            joints,
            frame_time,
            frames,
        }
    }

    /// Position and rotation of every joint and End Site in a frame.
    pub(crate) fn placed(&self, frame: usize) -> Vec<(Vector, Matrix)> {
        let mut values = self.frames[frame].iter().copied();
        let mut placed: Vec<(Vector, Matrix)> = Vec::new();
        for joint in &self.joints {
            let (mut position, mut turn) = (joint.offset, IDENTITY);
            for channel in &joint.channels {
                let value = values.next().unwrap();
                let axis = match channel.to_lowercase().as_bytes()[0] {
                    b'x' => 0,
                    b'y' => 1,
                    _ => 2,
                };
                if channel.to_lowercase().ends_with("position") {
                    position[axis] = value;
                } else {
                    turn = product(&turn, &about(axis, value));
                }
            }
            let placement = match joint.parent.map(|parent| placed[parent]) {
                Some((at, turned)) => (sum(at, apply(&turned, position)), product(&turned, &turn)),
                None => (position, turn),
            };
            placed.push(placement);
        }
        assert_eq!(values.next(), None);
        placed
    }
}

/// Rotation matrix about a coordinate axis.
pub(crate) fn about(axis: usize, degrees: f64) -> Matrix {
    let (s, c) = (degrees * std::f64::consts::PI / 180.0).sin_cos();
    match axis {
        0 => [[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]],
        1 => [[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]],
        _ => [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]],
    }
}

pub(crate) fn product(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

pub(crate) fn apply(a: &Matrix, v: Vector) -> Vector {
    std::array::from_fn(|i| (0..3).map(|k| a[i][k] * v[k]).sum())
}

pub(crate) fn sum(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|i| a[i] + b[i])
}

pub(crate) fn distance(a: Vector, b: Vector) -> f64 {
    let squares = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b));
    squares.sum::<f64>().sqrt()
}
