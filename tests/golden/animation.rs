//! Curves, poses, blends, state machines, limbs, skinning and automatic weights.

use glam::{Affine3A, Quat, Vec3, Vec3A, Vec4};
use kinopt::animation::curve::KeyedCurve;
use kinopt::animation::rotation::RotationCurve;
use kinopt::animation::{Armature, LimbGoal, LocalTransform, Pose, blend_poses};
use kinopt::skinning::{
    AutomaticWeights, Deformation, DualQuaternionBlend, HeatWeights, LinearBlend,
    PackedDualQuaternionBlend, PackedLinearBlend, PackedWeights, SkinWeights, bone_volumes,
};
use support::armatures::{bone, vector};
use support::bones::humanoid;
use support::limbs::{arm, limb};
use support::random::Random;
use support::skins::{Vertices, weights};
use support::state_machines::run_of;

use super::record::{Case, Record};

pub(crate) const CASES: &[Case] = &[
    Case::single("animation_curves", curves),
    Case::single("animation_poses", poses),
    Case::single("animation_state_machine", state_machine),
    Case::single("animation_limb", two_bone_limb),
    Case::single("skinning_linear_blend", linear_blend),
    Case::single("skinning_dual_quaternions", dual_quaternions),
    Case::single("skinning_packed", packed),
    Case::double("skinning_weights", automatic_weights),
];

/// Random unit quaternion by a square root alone.
fn rotation(random: &mut Random) -> Quat {
    let [x, y, z, w] = [(); 4].map(|()| random.within(-1.0, 1.0) as f32);
    Quat::from_vec4(Vec4::new(x, y, z, w).normalize())
}

fn curves(record: &mut Record) {
    let mut random = Random::new(61);
    let times = vec![0.0, 0.3, 1.1, 1.5, 2.75];
    let samples: Vec<f32> = (0..30).map(|k| 0.1 * k as f32).collect();
    let points: Vec<Vec3A> = times.iter().map(|_| vector(&mut random, 1.0)).collect();
    let turns: Vec<Quat> = times.iter().map(|_| rotation(&mut random)).collect();
    for (field, curve) in [
        ("linear", KeyedCurve::linear(times.clone(), points.clone())),
        (
            "Catmull-Rom",
            KeyedCurve::catmull_rom(times.clone(), points),
        ),
    ] {
        let curve = curve.unwrap();
        record.singles(
            field,
            samples.iter().flat_map(|&time| curve.at(time).to_array()),
        );
    }
    for (field, curve) in [
        ("slerp", RotationCurve::slerp(times.clone(), turns.clone())),
        ("squad", RotationCurve::squad(times, turns)),
    ] {
        let curve = curve.unwrap();
        record.singles(
            field,
            samples.iter().flat_map(|&time| curve.at(time).to_array()),
        );
    }
}

/// A chain with branches and two random poses.
fn posed_chain(random: &mut Random) -> (Armature, [Pose; 2]) {
    let bones = (0..17).map(|k| {
        bone(
            &format!("bone {k}"),
            (k > 0).then_some(k / 2),
            [0.1, 0.2, 0.3],
        )
    });
    let armature = Armature::new(bones.collect(), Vec::new()).unwrap();
    let poses = [(); 2].map(|()| {
        let mut pose = armature.rest().clone();
        for bone in armature.bone_ids() {
            let local = LocalTransform {
                translation: vector(random, 1.0),
                rotation: rotation(random),
                scale: Vec3A::ONE + vector(random, 0.3),
            };
            pose.set_local(bone, local).unwrap();
        }
        pose
    });
    (armature, poses)
}

fn poses(record: &mut Record) {
    let (armature, [a, b]) = posed_chain(&mut Random::new(62));
    let mut transforms = Vec::new();
    armature.local_to_model(&a, &mut transforms).unwrap();
    record.affines("model space", &transforms);
    let mut faded = a.clone();
    faded.cross_fade(&b, 0.3).unwrap();
    record.poses("cross-fade", [&faded]);
    let mut blended = a.clone();
    blend_poses(&[(&a, 0.2), (&b, 0.5), (&faded, 0.3)], &mut blended).unwrap();
    record.poses("blend", [&blended]);
}

fn state_machine(record: &mut Record) {
    let gait = r#"{"parameters": {"speed": 0.5, "hop": "trigger"}, "initial": "move",
      "states": [
       {"name": "move", "speed": 1.25, "blend": {"parameter": "speed", "clips": [
         {"at": 0, "clip": "stand"}, {"at": 1, "clip": "walk"}, {"at": 3, "clip": "run"}]}},
       {"name": "hop", "clip": "jump", "playback": "hold"}],
      "transitions": [
       {"to": "hop", "seconds": 0.25, "when": [{"parameter": "hop"}], "easing": "cubic_in_out"},
       {"from": "hop", "to": "move", "after": 0.8, "seconds": 0.2}]}"#;
    let mut run = run_of(gait);
    let (mut poses, mut texts) = (Vec::new(), String::new());
    for step in 0..60 {
        run.set_number("speed", 0.05 * step as f32).unwrap();
        if step % 25 == 7 {
            run.trigger("hop").unwrap();
        }
        run.update(0.07, |passed| texts += &format!("{} ", passed.event.name))
            .unwrap();
        texts += &format!("{} ", run.state());
        poses.push(run.pose().clone());
    }
    record.poses("poses", &poses);
    record.text("states and events", &texts);
}

fn two_bone_limb(record: &mut Record) {
    let armature = arm();
    let limb = limb(&armature);
    let mut random = Random::new(63);
    let mut poses = Vec::new();
    for _ in 0..8 {
        let mut pose = armature.rest().clone();
        let target = vector(&mut random, 1.5);
        let goal = LimbGoal::at(target);
        limb.reach(&armature, &mut pose, &goal).unwrap();
        poses.push(pose);
    }
    record.poses("poses", &poses);
}

const VERTICES: usize = 53;
const BONES: usize = 6;

/// Vertices, weights of up to four bones, and rigid transforms.
fn skin() -> (Vertices, SkinWeights, Vec<Affine3A>) {
    let mut random = Random::new(64);
    let rest = Vertices::random(&mut random, VERTICES);
    let weights = weights(&mut random, VERTICES, BONES, 4);
    let rigid = |_| {
        let turn = rotation(&mut random);
        Affine3A::from_rotation_translation(turn, vector(&mut random, 1.0).into())
    };
    (rest, weights, (0..BONES).map(rigid).collect())
}

fn vertices(record: &mut Record, field: &str, rest: &Vertices, blend: &impl Deformation) {
    let posed = rest.deformed(blend);
    let singles = |list: &[Vec3]| -> Vec<f32> { list.iter().flat_map(|v| v.to_array()).collect() };
    record.singles(&format!("{field}.positions"), singles(&posed.positions));
    record.singles(&format!("{field}.normals"), singles(&posed.normals));
    let tangents = posed.tangents.iter().flat_map(|t| t.to_array());
    record.singles(&format!("{field}.tangents"), tangents);
}

fn linear_blend(record: &mut Record) {
    let (rest, weights, transforms) = skin();
    let blend = LinearBlend::new(&weights, &transforms).unwrap();
    vertices(record, "linear", &rest, &blend);
}

fn dual_quaternions(record: &mut Record) {
    let (rest, weights, transforms) = skin();
    let blend = DualQuaternionBlend::new(&weights, &transforms).unwrap();
    vertices(record, "dual quaternions", &rest, &blend);
}

fn packed(record: &mut Record) {
    let (rest, weights, transforms) = skin();
    let weights = PackedWeights::new(&weights).unwrap();
    let blend = PackedLinearBlend::new(&weights, &transforms).unwrap();
    vertices(record, "linear", &rest, &blend);
    let blend = PackedDualQuaternionBlend::new(&weights, &transforms).unwrap();
    vertices(record, "dual quaternions", &rest, &blend);
}

fn automatic_weights(record: &mut Record) {
    let rig = humanoid();
    let mesh = rig.mesh.as_ref().unwrap();
    let by_distance = AutomaticWeights::default().for_skeleton(mesh, &rig.skeleton);
    let by_heat = HeatWeights::default()
        .for_skeleton(mesh, &rig.skeleton)
        .unwrap();
    let numbers = |weights: &SkinWeights| -> Vec<f64> {
        let influences = weights.iter().flatten();
        influences
            .flat_map(|i| [f64::from(i.bone), i.weight])
            .collect()
    };
    record.numbers("by distance", numbers(&by_distance.unwrap()));
    record.numbers("by heat", numbers(&by_heat));
    let volumes = bone_volumes(mesh, &by_heat).unwrap();
    record.numbers("volumes", volumes.iter().map(|bone| bone.volume));
}
