//! Drags of a hand of a skeleton while the other tips are pinned.

use std::f64::consts::TAU;

use kinopt::ik::hold_postures;
use kinopt::model::{FrameId, Limits, ModelError, ParameterMap};
use kinopt::problem::{ProblemError, TaskId};
use kinopt::skeleton::BoneId;
use kinopt::spatial::Vector3;
use kinopt::task::{Point, Posture, Quantity, Task};
use kinopt::{Model, Problem, Skeleton};

/// Configuration with every bend slightly off zero: a relaxed standing pose.
#[must_use]
pub fn at_ease(skeleton: &Skeleton) -> Vec<f64> {
    let limits: Vec<Limits> = skeleton.model().limits().collect();
    let relaxed = |(k, limits): (usize, &Limits)| limits.clamp(if k % 3 == 1 { 0.3 } else { 0.0 });
    limits.iter().enumerate().map(relaxed).collect()
}

/// Tip targets in one frame: the tip positions of the pose `q`, except for the second tip, a hand. The hand moves on
/// a circle of 5 cm through its position, with 240 frames per revolution.
#[must_use]
pub fn drag_targets(
    skeleton: &Skeleton,
    tips: &[BoneId],
    q: &[f64],
    frame: u32,
) -> Vec<Vector3<f64>> {
    let pose = skeleton.pose(q).expect("a pose of its own bones");
    let mut targets: Vec<_> = tips
        .iter()
        .map(|&tip| pose.tip(skeleton, tip).expect("a pose of its own bones"))
        .collect();
    let angle = f64::from(frame % 240) * std::f64::consts::TAU / 240.0;
    targets[1] += Vector3::new(-0.1 + 0.05 * angle.cos(), 0.05 * angle.sin(), 0.05);
    targets
}

/// A hand of a rig that moves out of reach, into limits and back, while other tips are pinned.
pub struct DragScene {
    /// Name for the output.
    pub name: String,
    /// Configuration of the first frame.
    pub start: Vec<f64>,
    model: Model,
    hand: FrameId,
    held: Vec<(FrameId, Vector3<f64>)>,
    from: Vector3<f64>,
    size: f64,
    map: ParameterMap,
    postures: Vec<Task<Posture>>,
}

impl DragScene {
    /// The tip of `hand` moves, the tips of the other `held` bones stay at their positions in `start`.
    #[must_use]
    pub fn of_skeleton(
        name: &str,
        skeleton: &Skeleton,
        hand: BoneId,
        held: &[BoneId],
        start: Vec<f64>,
    ) -> Self {
        let pose = skeleton.pose(&start).expect("a pose of its own bones");
        let pinned = held.iter().filter(|&&bone| bone != hand);
        let held = pinned.map(|&bone| {
            (
                skeleton.tip(bone),
                pose.tip(skeleton, bone).expect("a pose of its own bones"),
            )
        });
        Self {
            name: name.to_owned(),
            model: skeleton.model().clone(),
            hand: skeleton.tip(hand),
            held: held.collect(),
            from: pose.tip(skeleton, hand).expect("a pose of its own bones"),
            size: skeleton.size(),
            map: ParameterMap::free(skeleton.model()),
            postures: Vec::new(),
            start,
        }
    }

    /// A skeleton without limits and pins, as in animation files, with the default holds.
    ///
    /// # Errors
    /// None for a start within the limits.
    pub fn of_bare_figure(
        name: &str,
        skeleton: &Skeleton,
        hand: BoneId,
        start: Vec<f64>,
    ) -> Result<Self, ModelError> {
        let holds = skeleton.holds(&[hand]);
        let map = holds.parameters(skeleton, &start)?;
        let postures = hold_postures(&holds, skeleton, &start)?;
        Ok(Self {
            map,
            postures,
            ..Self::of_skeleton(name, skeleton, hand, &holds.ends, start)
        })
    }

    /// The scene with a posture task in the null space of the targets.
    #[must_use]
    pub fn with_posture(mut self) -> Self {
        self.name.push_str(", with a posture");
        let posture = Posture::new(&self.model, &self.start);
        self.postures = vec![Task::new(posture)];
        self
    }

    /// Problem, with the task of the dragged hand.
    ///
    /// # Errors
    /// None for a model whose joints can move.
    pub fn problem(&self) -> Result<(Problem, TaskId<Point>), ProblemError> {
        let mut builder = Problem::builder(&self.model);
        builder.tolerance(Quantity::Metres, 1e-6 * self.size);
        builder.parameters(self.map.clone());
        let hand = builder.add(Point::new(self.hand, self.from));
        for &(frame, position) in &self.held {
            builder.add(Point::new(frame, position));
        }
        for posture in &self.postures {
            builder.add(posture.clone());
        }
        Ok((builder.build()?, hand))
    }

    /// Target of the hand: on a slow closed curve through its initial position, far out of reach and through the body.
    #[must_use]
    pub fn target(&self, frame: u32, frames: u32) -> Vector3<f64> {
        let phase = TAU * f64::from(frame) / f64::from(frames);
        let direction = Vector3::new(
            (2.0 * phase).sin() + 0.3 * (7.0 * phase).sin(),
            (3.0 * phase).sin() + 0.3 * (11.0 * phase).sin(),
            (5.0 * phase).sin() - 0.3 * (13.0 * phase).sin(),
        );
        self.from + direction * (0.6 * self.size)
    }
}
