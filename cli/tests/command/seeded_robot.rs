//! Robots of models/, with targets from seeded configurations.

use crate::forked_rig::{commas, model};
use kinopt::kinematics::ForwardKinematics;
use kinopt::robot::Robot;
use kinopt::spatial::{Placement, Quaternion, rotation_log};
use serde_json::{Value, json};

/// Robot with its file, its base frame and its tip frame.
pub(crate) struct Seeded {
    pub(crate) file: String,
    pub(crate) robot: Robot,
    pub(crate) base: &'static str,
    pub(crate) tip: &'static str,
}

/// The file's path, for command lines.
impl std::fmt::Display for Seeded {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.file)
    }
}

impl Seeded {
    pub(crate) fn new(name: &str, base: &'static str, tip: &'static str) -> Self {
        let file = model(&format!("{name}.urdf"));
        let robot = Robot::read(&file).unwrap();
        Self {
            file,
            robot,
            base,
            tip,
        }
    }

    pub(crate) fn panda() -> Self {
        Self::new("franka_panda", "base", "tool")
    }

    /// Configuration within the limits, with consistent mimic joints.
    pub(crate) fn configuration(&self, seed: u64) -> Vec<f64> {
        let map = self.robot.map();
        let mut q = self.robot.model().random_configuration(seed);
        let mut x = vec![0.0; map.variables()];
        map.reduce(&q, &mut x).unwrap();
        map.expand_within_limits(&x, &mut q).unwrap();
        q
    }

    pub(crate) fn base_from(&self, frame: &str, q: &[f64]) -> Placement<f64> {
        let model = self.robot.model();
        let frames = [model.frame(self.base).unwrap(), model.frame(frame).unwrap()];
        let mut kinematics = ForwardKinematics::of_frames(model, &frames).unwrap();
        let placed = kinematics.place(q).unwrap();
        placed[0].inverse() * placed[1]
    }

    /// Pose of the tip as seven numbers.
    pub(crate) fn pose(&self, q: &[f64]) -> Vec<f64> {
        seven(&self.base_from(self.tip, q))
    }

    pub(crate) fn poses(&self, count: u64) -> Vec<Vec<f64>> {
        let pose = |seed| self.pose(&self.configuration(seed));
        (1..=count).map(pose).collect()
    }

    /// Content of a file of `count` targets, without starts.
    pub(crate) fn targets(&self, count: u64) -> Value {
        json!({"targets": self.poses(count), "tip_link": self.tip, "base_link": self.base})
    }

    /// Asserts that a configuration is exactly within the limits and puts the tip on a pose.
    pub(crate) fn check(&self, q: &[f64], pose: &[f64]) {
        for (value, limits) in q.iter().zip(self.robot.model().limits()) {
            assert!(limits.contains(*value), "{value} is not within {limits:?}");
        }
        let [position, orientation] = self.errors(q, pose);
        assert!(position <= 1.001e-6, "{position} m");
        assert!(orientation <= 1.001e-6, "{orientation} rad");
    }

    /// Position and orientation error of the tip, in metres and radians.
    pub(crate) fn errors(&self, q: &[f64], pose: &[f64]) -> [f64; 2] {
        let target = placement(pose);
        let miss = target.inverse() * self.base_from(self.tip, q);
        [miss.translation.norm(), rotation_log(&miss.rotation).norm()]
    }
}

pub(crate) fn seven(placement: &Placement<f64>) -> Vec<f64> {
    let Quaternion { w, v } = Quaternion::from_matrix(&placement.rotation);
    let position = placement.translation.to_array();
    position.into_iter().chain([w, v.x, v.y, v.z]).collect()
}

fn placement(pose: &[f64]) -> Placement<f64> {
    let quaternion = Quaternion {
        w: pose[3],
        v: [pose[4], pose[5], pose[6]].into(),
    };
    let position = [pose[0], pose[1], pose[2]];
    Placement::new(quaternion.to_matrix(), position.into())
}

/// `FRAME=…` with all digits.
pub(crate) fn typed(frame: &str, numbers: &[f64]) -> String {
    format!("--target={frame}={}", commas(numbers))
}
