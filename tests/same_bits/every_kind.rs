//! Promise: the same question has the same answer to the bit on every x86-64 processor, of whatever
//! maker, with every system's mathematical library, in debug and in release (docs/internals/reproducibility.md).
//!
//! The other files go on with what is counted and reported on the way, among obstacles and of whole bodies.
#![allow(clippy::unwrap_used)]

use std::path::Path;

use glam::{Affine3A, Quat, Vec3, Vec4};
use kinopt::animation::rotation::{EulerOrder, RotationHermite, slerp, squad, squad_control};
use kinopt::animation::{Armature, Clip, Cursor, Playback};
use kinopt::geometric::{Ccd, Fabrik, Geometric};
use kinopt::ik::Restarts;
use kinopt::io::rig::Rig;
use kinopt::simd_ik::{Chain, ChainJoint, JointKind, LaneOptions, PoseOutcome, PoseSolver, Prefer};
use kinopt::skinning::{
    AutomaticWeights, Deformation, DualQuaternionBlend, LinearBlend, PackedDualQuaternionBlend,
    PackedLinearBlend, PackedWeights,
};
use kinopt::solver::Stopping;
use kinopt::spatial::{Matrix3, Placement, Vector3};
use kinopt::task::{LookAt, Orientation, Point};
use kinopt::{Problem, Scalar};
use support::methods::solvers;
use support::random::Random;

use crate::digest::{Digest, Value, check};

/// Unit quaternions by additions, products and roots only.
fn rotation(random: &mut Random) -> Quat {
    let v = Vec4::from([(); 4].map(|()| random.within(-1.0, 1.0) as f32));
    Quat::from_vec4(v.normalize())
}

fn elementary() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(1));
    for _ in 0..2000 {
        let [x, y] = [random.within(-20.0, 20.0), random.within(-3.0, 3.0)];
        let (sin, cos) = Scalar::sin_cos(x);
        digest.doubles([sin, cos, Scalar::atan2(x, y), Scalar::exp(y)]);
        digest.doubles([Scalar::ln(x * x + 1e-3), Scalar::sqrt(x * x)]);
    }
    digest.value()
}

fn rotations() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(2));
    for _ in 0..300 {
        let [a, b, c, d] = [(); 4].map(|()| rotation(&mut random));
        let t = random.unit() as f32;
        let controls = [squad_control(d, a, b), squad_control(a, b, c)];
        let rates = [a.xyz(), c.xyz()];
        let between = RotationHermite::new(a, rates[0], b, rates[1]).at(t);
        for q in [slerp(a, b, t), squad(a, controls, b, t), between] {
            digest.singles(q.to_array());
        }
        for order in EulerOrder::ALL {
            let angles = order.from_quaternion(c.as_dquat().normalize()).angles;
            digest.doubles(angles);
            digest.doubles(order.to_quaternion(angles).to_array());
        }
    }
    digest.value()
}

/// Seven joints at right angles, as arms have them.
fn chain() -> Chain {
    let x = Matrix3::from_columns(
        Vector3::new(1.0, 0.0, 0.0),
        Vector3::new(0.0, 0.0, 1.0),
        Vector3::new(0.0, -1.0, 0.0),
    );
    let joint = |turned: bool, place: [f64; 3]| ChainJoint {
        parent_from_joint: Placement::new(
            if turned { x } else { Matrix3::identity() },
            place.into(),
        ),
        axis: [0.0, 0.0, 1.0].into(),
        kind: JointKind::Revolute,
        lower: -2.8,
        upper: 2.8,
    };
    let joints = vec![
        joint(false, [0.0, 0.0, 0.333]),
        joint(true, [0.0, 0.0, 0.0]),
        joint(true, [0.0, -0.316, 0.0]),
        joint(true, [0.0825, 0.0, 0.0]),
        joint(true, [-0.0825, 0.384, 0.0]),
        joint(true, [0.0, 0.0, 0.0]),
        joint(true, [0.088, 0.0, 0.1]),
    ];
    Chain::new(joints, Placement::translation([0.0, 0.0, 0.1].into())).unwrap()
}

fn lanes() -> [Value; 2] {
    let chain = chain();
    let solver = PoseSolver::new(&chain, LaneOptions::default()).unwrap();
    let mut random = Random::new(3);
    let mut draw = || -> Vec<f64> { (0..7).map(|_| random.within(-2.5, 2.5)).collect() };
    let mut targets: Vec<Placement<f64>> = (0..40)
        .map(|_| chain.base_from_tip(&draw()).unwrap())
        .collect();
    targets[7].translation = Vector3::new(2.0, 0.1, 0.4);
    let starts: Vec<f64> = (0..40).flat_map(|_| draw()).collect();
    let (mut alone, mut batch) = (Digest::new(), Digest::new());
    let mut q = vec![0.0; 7];
    for (target, start) in targets.iter().zip(starts.chunks(7)) {
        for search in [Prefer::Start, Prefer::First] {
            let outcome = solver.solve(target, start, search, None, &mut q).unwrap();
            alone.doubles(q.iter().copied());
            alone.doubles([outcome.position_error, outcome.orientation_error]);
            alone.word(outcome.iterations.into());
        }
    }
    let mut all = vec![0.0; 280];
    let mut outcomes = vec![PoseOutcome::default(); 40];
    solver
        .solve_batch(&targets, &starts, Prefer::Start, &mut all, &mut outcomes)
        .unwrap();
    batch.doubles(all);
    [alone.value(), batch.value()]
}

fn bodies(rig: &Rig) -> [Value; 2] {
    let (skeleton, rest) = (&rig.skeleton, rig.skeleton.model().neutral());
    let (hand, head) = (
        skeleton.bone("left_hand").unwrap(),
        skeleton.bone("head").unwrap(),
    );
    let (mut solved, mut questions) = (Digest::new(), Vec::new());
    let stopping = Stopping::default().with_max_iterations(30);
    for solver in solvers() {
        for reach in [[0.35, 0.45, 1.5], [0.9, 0.9, 2.5]] {
            let mut tasks = Problem::builder(skeleton.model());
            tasks.add(Point::new(skeleton.tip(hand), reach));
            tasks.add(LookAt::new(skeleton.tip(head), [0.0, 1.0, 0.0], reach));
            tasks.add(Orientation::new(skeleton.tail(head), Matrix3::identity()));
            let problem = tasks.build().unwrap();
            questions.push(problem);
        }
        let solver = solver.with_stopping(stopping);
        let solver = solver.with_restarts(Restarts::default().with_attempts(2));
        for problem in questions.drain(..) {
            solved.doubles(solver.solve_once(&problem, &rest).unwrap().q);
        }
    }
    let mut tasks = Problem::builder(skeleton.model());
    tasks.add(Point::new(skeleton.tip(hand), [0.35, 0.45, 1.5]));
    let problem = tasks.build().unwrap();
    let mut geometric = Digest::new();
    geometric.doubles(Ccd::default().solve(&problem, &rest).unwrap().q);
    geometric.doubles(Fabrik::default().solve(&problem, &rest).unwrap().q);
    [solved.value(), geometric.value()]
}

fn clip(rig: &Rig) -> Value {
    let armature = Armature::of_skeleton(&rig.skeleton);
    let mut keys = Clip::builder("keys", &armature);
    keys.euler_clip(&rig.clip).unwrap();
    let clip = keys.build();
    let (mut pose, mut cursor) = (armature.rest().clone(), Cursor::new());
    let mut digest = Digest::new();
    for frame in 0..60 {
        let time = f64::from(frame) / 24.0;
        clip.sample(time, Playback::Loop, &mut cursor, &mut pose)
            .unwrap();
        digest.singles(pose.rotations().iter().flat_map(|q| q.to_array()));
    }
    digest.value()
}

/// With the packed kernels, and with those for any number of influences.
fn skins(rig: &Rig) -> [Value; 2] {
    let mesh = rig.mesh.as_ref().unwrap();
    let mut bind = AutomaticWeights::default();
    bind.smoothing_steps = 2;
    let weights = bind.for_skeleton(mesh, &rig.skeleton).unwrap();
    let packed = PackedWeights::new(&weights.pruned(4).unwrap().0).unwrap();
    let mut random = Random::new(4);
    let transforms: Vec<Affine3A> = (0..weights.bone_count())
        .map(|_| {
            let shift = [(); 3].map(|()| random.within(-0.1, 0.1) as f32);
            Affine3A::from_rotation_translation(rotation(&mut random), shift.into())
        })
        .collect();
    let rest: Vec<Vec3> = mesh.positions().to_vec();
    let posed = |blends: [&dyn Deformation; 2]| {
        let mut digest = Digest::new();
        for blend in blends {
            let (mut positions, mut normals) = (rest.clone(), rest.clone());
            blend.positions(&rest, &mut positions).unwrap();
            blend.normals(&rest, &mut normals).unwrap();
            digest.singles(positions.iter().chain(&normals).flat_map(|v| v.to_array()));
        }
        digest.value()
    };
    [
        posed([
            &PackedLinearBlend::new(&packed, &transforms).unwrap(),
            &PackedDualQuaternionBlend::new(&packed, &transforms).unwrap(),
        ]),
        posed([
            &LinearBlend::new(&weights, &transforms).unwrap(),
            &DualQuaternionBlend::new(&weights, &transforms).unwrap(),
        ]),
    ]
}

#[test]
fn digests_of_answers_are_those_of_every_other_machine() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let rig = Rig::read(root.join("../models/humanoid/humanoid.json")).unwrap();
    let ([alone, batch], [solved, geometric], [packed, skin]) =
        (lanes(), bodies(&rig), skins(&rig));
    let found: [(&str, Value); 9] = [
        ("sines, arc tangents, exponentials", elementary()),
        ("rotations and Euler angles", rotations()),
        ("lane engine, one question at a time", alone),
        ("lane engine, a batch", batch),
        ("a figure by every method", solved),
        ("a figure by CCD and FABRIK", geometric),
        ("a clip of Euler keys", clip(&rig)),
        ("packed skin", packed),
        ("skin of any influences", skin),
    ];
    check(&found);
}
