//! Conversion of configurations to the coordinate orders of other libraries.

use kinopt::Model;
use kinopt::model::{JointId, JointKind};

/// Consecutive numbers of another library's configuration, with the first coordinate in kinopt's order.
#[derive(Clone, Copy)]
enum Part {
    /// One number, equal in both orders.
    Value(usize),
    /// Cosine and sine of an angle of kinopt.
    Angle(usize),
    /// A quaternion x, y, z, w; in kinopt w, x, y, z.
    Quaternion(usize),
}

/// Coordinate order of another library's configuration.
pub struct CoordinateOrder(Vec<Part>);

impl CoordinateOrder {
    /// Order of the model.
    pub fn same(model: &Model) -> Self {
        Self((0..model.configuration_len()).map(Part::Value).collect())
    }

    /// Order of Pinocchio: depth first, siblings by name.
    pub fn of_pinocchio(model: &Model, is_continuous: impl Fn(&str) -> bool) -> Self {
        let mut parts = Vec::new();
        for id in depth_first(model, true) {
            let joint = &model.joints()[id.index()];
            let Some(at) = model.coordinate(id) else {
                continue;
            };
            parts.push(match joint.kind {
                JointKind::Ball => Part::Quaternion(at),
                _ if is_continuous(&joint.name) || is_yaw_of_planar(model, id) => Part::Angle(at),
                _ => Part::Value(at),
            });
        }
        Self(parts)
    }

    /// Order of MuJoCo: depth first, siblings in the order of the file.
    pub fn of_mujoco(model: &Model) -> Self {
        let joints = depth_first(model, false).into_iter();
        let coordinates = joints.filter_map(|id| {
            let at = model.coordinate(id)?;
            Some(at..at + model.joints()[id.index()].kind.coordinates())
        });
        Self(coordinates.flatten().map(Part::Value).collect())
    }

    /// Length of the other library's configuration.
    pub fn coordinates(&self) -> usize {
        let lengths = self.0.iter().map(|part| match part {
            Part::Value(_) => 1,
            Part::Angle(_) => 2,
            Part::Quaternion(_) => 4,
        });
        lengths.sum()
    }

    /// Converts a configuration of the model to the other library's order. The caller checks the lengths.
    pub fn write(&self, q: &[f64], other: &mut [f64]) {
        let mut next = 0;
        let mut push = |value: f64| {
            other[next] = value;
            next += 1;
        };
        for part in &self.0 {
            match *part {
                Part::Value(at) => push(q[at]),
                Part::Angle(at) => {
                    push(q[at].cos());
                    push(q[at].sin());
                }
                Part::Quaternion(at) => {
                    (at + 1..at + 4).for_each(|at| push(q[at]));
                    push(q[at]);
                }
            }
        }
    }

    /// Converts a configuration of the other library to the model's order. The caller checks the lengths.
    pub fn read(&self, other: &[f64], q: &mut [f64]) {
        let mut next = 0;
        let mut pull = || {
            next += 1;
            other[next - 1]
        };
        for part in &self.0 {
            match *part {
                Part::Value(at) => q[at] = pull(),
                Part::Angle(at) => {
                    let cosine = pull();
                    q[at] = pull().atan2(cosine);
                }
                Part::Quaternion(at) => {
                    (at + 1..at + 4).for_each(|at| q[at] = pull());
                    q[at] = pull();
                }
            }
        }
    }
}

/// All joints, parents before children, siblings by name or in the order of the file.
fn depth_first(model: &Model, by_name: bool) -> Vec<JointId> {
    let joints = model.joints();
    let mut children: Vec<Vec<JointId>> = vec![Vec::new(); joints.len() + 1];
    for id in model.joint_ids() {
        let parent = joints[id.index()].parent;
        children[parent.map_or(joints.len(), JointId::index)].push(id);
    }
    if by_name {
        for siblings in &mut children {
            siblings.sort_by_key(|id| file_name(&joints[id.index()].name));
        }
    }
    let mut order = Vec::with_capacity(joints.len());
    let mut waiting: Vec<JointId> = children[joints.len()].iter().rev().copied().collect();
    while let Some(id) = waiting.pop() {
        order.push(id);
        waiting.extend(children[id.index()].iter().rev());
    }
    order
}

/// Name of a joint in the file; for a free or planar joint, the name of its first prismatic joint without the suffix.
fn file_name(name: &str) -> &str {
    name.strip_suffix("/x").unwrap_or(name)
}

/// True if a joint is the last of the chain that represents a planar joint.
fn is_yaw_of_planar(model: &Model, id: JointId) -> bool {
    let joints = model.joints();
    let joint = &joints[id.index()];
    let name = joint.name.strip_suffix("/yaw");
    let slide = joint.parent.map(|parent| &joints[parent.index()].name);
    name.is_some_and(|name| slide.is_some_and(|slide| slide.strip_suffix("/y") == Some(name)))
}
