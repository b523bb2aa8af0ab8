//! Random rigs of twist-bend-twist bones, and their poses by the recursion of the source documents.

use super::random::Random;
use super::{Rigid, placement, rigid};
use kinopt::io::rig::Rig;
use kinopt::model::Limits;
use kinopt::skeleton::{Bone, BoneId};
use kinopt::spatial::Vector3;
use kinopt::task::Point;
use kinopt::{Problem, Skeleton};
use nalgebra as na;

/// Skeleton with the numbers it was built from.
#[derive(Clone, Debug)]
pub struct RandomRig {
    pub skeleton: Skeleton,
    pub parents: Vec<Option<usize>>,
    pub lengths: Vec<f64>,
    pub rests: Vec<Rigid>,
    /// The five bones without children.
    pub tips: Vec<BoneId>,
}

impl RandomRig {
    /// Random rig of 19 to 22 bones: a locked root, a spine and five limbs. It has hinges, balls with asymmetric limits
    /// and stiff twists; all angles of 0 are within the limits.
    pub fn new(seed: u64) -> Self {
        Self::scaled(seed, 1.0)
    }

    /// Problem in which every tip has its own position target.
    pub fn drawn_to<T: Into<Vector3<f64>>>(&self, mut target: impl FnMut() -> T) -> Problem {
        let mut builder = Problem::builder(self.skeleton.model());
        for &tip in &self.tips {
            builder.add(Point::new(self.skeleton.tip(tip), target()));
        }
        builder.build().unwrap()
    }

    /// Rig of the same seed in another unit of length.
    pub fn scaled(seed: u64, unit: f64) -> Self {
        Self::placed(seed, unit, Rigid::identity())
    }

    /// Rig of the same seed, scaled and then moved as a whole.
    pub fn placed(seed: u64, unit: f64, moved: Rigid) -> Self {
        let mut random = Random::new(seed);
        let count = 19 + random.below(4);
        let trunk = 3 + random.below(2);
        let mut parts = Parts::default();
        parts.add(&mut random, None, [(0.0, 0.0); 3]);
        for _ in 1..trunk {
            let parent = parts.parents.len() - 1;
            parts.add(
                &mut random,
                Some(parent),
                [(-0.5, 0.5), (-0.6, 0.6), (-0.5, 0.5)],
            );
        }
        let mut tips = Vec::new();
        for limb in 0..5 {
            let bones_left = count - parts.parents.len();
            let length = bones_left / (5 - limb);
            let mut parent = trunk - 1 - random.below(2);
            for segment in 0..length {
                let limits = match (segment, random.below(3)) {
                    (1, _) => [(0.0, 0.0), (0.0, random.within(1.5, 2.8)), (0.0, 0.0)],
                    (_, 0) => [
                        (random.within(-1.5, -0.3), random.within(0.3, 1.5)),
                        (random.within(-0.6, 0.0), random.within(0.8, 2.2)),
                        (random.within(-1.5, -0.3), random.within(0.3, 1.5)),
                    ],
                    (_, 1) => [(-1.0, 1.0), (0.0, 1.6), (-3.0, 3.0)],
                    _ => [(0.0, 0.0), (-0.8, 0.8), (-1.2, 1.2)],
                };
                parts.add(&mut random, Some(parent), limits);
                parent = parts.parents.len() - 1;
            }
            tips.push(parent);
        }
        parts.build(seed, unit, moved, &tips)
    }

    /// Transform T_i = T_parent T̂_i R_x(θ₃) R_z(θ₂) R_x(θ₁) T̂_i⁻¹ of every bone, as a plain product.
    pub fn transforms(&self, q: &[f64]) -> Vec<Rigid> {
        let turn = |axis: na::Unit<na::Vector3<f64>>, angle: f64| {
            rigid(
                na::Rotation3::from_axis_angle(&axis, angle),
                na::Vector3::zeros(),
            )
        };
        let (x, z) = (na::Vector3::x_axis(), na::Vector3::z_axis());
        let mut all: Vec<Rigid> = Vec::new();
        for (i, rest) in self.rests.iter().enumerate() {
            let parent = self.parents[i].map_or(Rigid::identity(), |p| all[p]);
            let [a, b, c] = [q[3 * i], q[3 * i + 1], q[3 * i + 2]];
            let bent = rest * turn(x, c) * turn(z, b) * turn(x, a) * rest.inverse();
            all.push(parent * bent);
        }
        all
    }

    /// Position of a bone's tip: its rest position times the bone's transform.
    pub fn tip(&self, transforms: &[Rigid], bone: BoneId) -> na::Vector3<f64> {
        let i = bone.index();
        let canonical = na::Point3::new(self.lengths[i], 0.0, 0.0);
        (transforms[i] * self.rests[i] * canonical).coords
    }

    pub fn tail(&self, transforms: &[Rigid], bone: BoneId) -> na::Vector3<f64> {
        let i = bone.index();
        (transforms[i] * self.rests[i] * na::Point3::origin()).coords
    }
}

#[derive(Default)]
struct Parts {
    parents: Vec<Option<usize>>,
    lengths: Vec<f64>,
    rests: Vec<Rigid>,
    limits: Vec<[(f64, f64); 3]>,
}

impl Parts {
    /// Adds a bone whose tail is at its parent's tip.
    fn add(&mut self, random: &mut Random, parent: Option<usize>, limits: [(f64, f64); 3]) {
        let tail = match parent {
            Some(p) => (self.rests[p] * na::Point3::new(self.lengths[p], 0.0, 0.0)).coords,
            None => random.vector(0.5),
        };
        self.parents.push(parent);
        self.lengths.push(random.within(0.1, 0.5));
        self.rests.push(rigid(random.rotation(), tail));
        self.limits.push(limits);
    }

    fn build(mut self, seed: u64, unit: f64, moved: Rigid, tips: &[usize]) -> RandomRig {
        for rest in &mut self.rests {
            rest.translation.vector *= unit;
            *rest = moved * *rest;
        }
        for length in &mut self.lengths {
            *length *= unit;
        }
        // Bones name their parents by id, and ids come from a skeleton, so the skeleton is built bone by bone.
        let mut bones: Vec<Bone> = Vec::new();
        for i in 0..self.parents.len() {
            let parent = self.parents[i].map(|p| {
                let so_far = Skeleton::new("so far", bones.clone()).unwrap();
                so_far.bone_at(p).unwrap()
            });
            bones.push(Bone {
                name: format!("bone/{i}"),
                parent,
                length: self.lengths[i],
                model_from_rest: placement(&self.rests[i]),
                limits: self.limits[i].map(|(lower, upper)| Limits::new(lower, upper)),
            });
        }
        let skeleton = Skeleton::new(format!("rig {seed}"), bones).unwrap();
        let tips = tips.iter().map(|&t| skeleton.bone_at(t).unwrap()).collect();
        RandomRig {
            skeleton,
            parents: self.parents,
            lengths: self.lengths,
            rests: self.rests,
            tips,
        }
    }
}

/// The shipped humanoid.
pub fn humanoid() -> Rig {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../models/humanoid/humanoid.json"
    );
    Rig::read(path).unwrap()
}
