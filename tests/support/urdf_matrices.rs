//! Forward kinematics from a URDF's XML with plain 4 × 4 matrices, independent of the library. Angles are in radians,
//! lengths in metres, matrices in row-major order.

use std::collections::HashMap;

use kinopt::spatial::{Matrix3, Placement, Vector3};

/// Rigid transform in row-major order.
pub type Matrix = [[f64; 4]; 4];

pub const IDENTITY: Matrix = [
    [1.0, 0.0, 0.0, 0.0],
    [0.0, 1.0, 0.0, 0.0],
    [0.0, 0.0, 1.0, 0.0],
    [0.0, 0.0, 0.0, 1.0],
];

struct Joint {
    name: String,
    kind: String,
    parent: String,
    origin: Matrix,
    axis: [f64; 3],
    limits: (f64, f64),
    /// Source joint, multiplier and offset.
    mimic: Option<(String, f64, f64)>,
}

/// Joints of a file by their child link.
pub struct Tree {
    by_child: HashMap<String, Joint>,
}

impl Tree {
    pub fn read(path: impl AsRef<std::path::Path>) -> Self {
        Self::parse(&std::fs::read_to_string(path).unwrap())
    }

    pub fn parse(text: &str) -> Self {
        let document = roxmltree::Document::parse(text).unwrap();
        let robot = document.root_element();
        let joints = robot.children().filter(|node| node.has_tag_name("joint"));
        let by_child = joints.map(|node| {
            let child = |tag: &str| node.children().find(|child| child.has_tag_name(tag));
            let text = |tag: &str, name: &str| child(tag).and_then(|c| c.attribute(name));
            let numbers = |text: Option<&str>, default: [f64; 3]| {
                text.map_or(default, |text| {
                    let all: Vec<f64> = text
                        .split_whitespace()
                        .map(|v| v.parse().unwrap())
                        .collect();
                    all.try_into().unwrap()
                })
            };
            let number = |tag: &str, name: &str, default: f64| {
                text(tag, name).map_or(default, |v| v.trim().parse().unwrap())
            };
            let kind = node.attribute("type").unwrap().to_owned();
            let bounded = kind == "revolute" || kind == "prismatic";
            let limits = match bounded {
                true => (number("limit", "lower", 0.0), number("limit", "upper", 0.0)),
                false => (f64::NEG_INFINITY, f64::INFINITY),
            };
            let joint = Joint {
                name: node.attribute("name").unwrap().to_owned(),
                kind,
                parent: text("parent", "link").unwrap().to_owned(),
                origin: origin(
                    numbers(text("origin", "xyz"), [0.0; 3]),
                    numbers(text("origin", "rpy"), [0.0; 3]),
                ),
                axis: numbers(text("axis", "xyz"), [1.0, 0.0, 0.0]),
                limits,
                mimic: text("mimic", "joint").map(|master| {
                    (
                        master.to_owned(),
                        number("mimic", "multiplier", 1.0),
                        number("mimic", "offset", 0.0),
                    )
                }),
            };
            (text("child", "link").unwrap().to_owned(), joint)
        });
        Self {
            by_child: by_child.collect(),
        }
    }

    fn joint(&self, name: &str) -> &Joint {
        self.by_child.values().find(|j| j.name == name).unwrap()
    }

    /// Limits as given in the file.
    pub fn limits(&self, joint: &str) -> (f64, f64) {
        self.joint(joint).limits
    }

    /// Value of a joint: its own, its source joint's times the multiplier, or 0.
    fn value(&self, joint: &Joint, values: &[(&str, f64)]) -> f64 {
        match &joint.mimic {
            Some((master, multiplier, offset)) => {
                multiplier * self.value(self.joint(master), values) + offset
            }
            None => {
                let given = values.iter().find(|(name, _)| *name == joint.name);
                given.map_or(0.0, |(_, value)| *value)
            }
        }
    }

    pub fn root_from_link(&self, link: &str, values: &[(&str, f64)]) -> Matrix {
        let Some(joint) = self.by_child.get(link) else {
            return IDENTITY;
        };
        let value = self.value(joint, values);
        let motion = match joint.kind.as_str() {
            "fixed" => IDENTITY,
            "prismatic" => {
                let mut slide = IDENTITY;
                for (row, axis) in slide.iter_mut().zip(unit(joint.axis)) {
                    row[3] = axis * value;
                }
                slide
            }
            _ => about(joint.axis, value),
        };
        product(
            &self.root_from_link(&joint.parent, values),
            &product(&joint.origin, &motion),
        )
    }

    /// Placement base_from_tip at these joint values; all other joints are at 0.
    pub fn base_from_tip(&self, base: &str, tip: &str, values: &[(&str, f64)]) -> Matrix {
        product(
            &inverse(&self.root_from_link(base, values)),
            &self.root_from_link(tip, values),
        )
    }
}

/// Rotations about fixed axes: roll about x, then pitch about y, then yaw about z.
fn origin(xyz: [f64; 3], [roll, pitch, yaw]: [f64; 3]) -> Matrix {
    let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    let mut all = product(&about(z, yaw), &product(&about(y, pitch), &about(x, roll)));
    for (row, value) in all.iter_mut().zip(xyz) {
        row[3] = value;
    }
    all
}

fn unit(axis: [f64; 3]) -> [f64; 3] {
    // Squares of numbers above 1e154 overflow.
    let largest = axis.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    let axis = axis.map(|v| v / largest);
    let length = axis.iter().map(|v| v * v).sum::<f64>().sqrt();
    axis.map(|v| v / length)
}

/// Rodrigues' formula about an axis of any length.
pub fn about(axis: [f64; 3], angle: f64) -> Matrix {
    let [x, y, z] = unit(axis);
    let (s, c) = angle.sin_cos();
    let d = 1.0 - c;
    [
        [c + d * x * x, d * x * y - s * z, d * x * z + s * y, 0.0],
        [d * x * y + s * z, c + d * y * y, d * y * z - s * x, 0.0],
        [d * x * z - s * y, d * y * z + s * x, c + d * z * z, 0.0],
        [0.0, 0.0, 0.0, 1.0],
    ]
}

pub fn product(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..4).map(|k| a[i][k] * b[k][j]).sum()))
}

pub fn inverse(a: &Matrix) -> Matrix {
    let mut inverse = IDENTITY;
    for i in 0..3 {
        for j in 0..3 {
            inverse[i][j] = a[j][i];
        }
        inverse[i][3] = -(0..3).map(|k| a[k][i] * a[k][3]).sum::<f64>();
    }
    inverse
}

/// Distance (m) and angle (rad) between two placements. The angle is from the chord ‖A − B‖, which is accurate near 0.
pub fn apart(a: &Matrix, b: &Matrix) -> (f64, f64) {
    let (mut distance, mut chord) = (0.0, 0.0);
    for (a, b) in a.iter().zip(b).take(3) {
        distance += (a[3] - b[3]).powi(2);
        chord += (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>();
    }
    let half_sine = (chord / 8.0).sqrt().min(1.0);
    (distance.sqrt(), 2.0 * half_sine.asin())
}

/// Matrix of x, y, z and a quaternion w, x, y, z of any length.
pub fn from_quaternion([x, y, z, qw, qx, qy, qz]: [f64; 7]) -> Matrix {
    let half = [qx, qy, qz].iter().map(|v| v * v).sum::<f64>().sqrt();
    let mut all = match half > 0.0 {
        true => about([qx, qy, qz], 2.0 * half.atan2(qw)),
        false => IDENTITY,
    };
    for (row, value) in all.iter_mut().zip([x, y, z]) {
        row[3] = value;
    }
    all
}

/// Placement of the library's type.
pub fn placement(matrix: &Matrix) -> Placement<f64> {
    let column = |j: usize| Vector3::new(matrix[0][j], matrix[1][j], matrix[2][j]);
    let rotation = Matrix3 {
        x: column(0),
        y: column(1),
        z: column(2),
    };
    Placement::new(rotation, column(3))
}

pub fn from_placement(placement: &Placement<f64>) -> Matrix {
    let Placement {
        rotation,
        translation,
    } = placement;
    let columns = [rotation.x, rotation.y, rotation.z, *translation].map(Vector3::to_array);
    let mut matrix = IDENTITY;
    for (i, row) in matrix.iter_mut().take(3).enumerate() {
        for (value, column) in row.iter_mut().zip(columns) {
            *value = column[i];
        }
    }
    matrix
}
