//! Clips and armatures for tests of state machines.

use std::sync::Arc;

use glam::Vec3A;
use kinopt::animation::curve::KeyedCurve;
use kinopt::animation::{
    Armature, ArmatureBone, Channel, Clip, LocalTransform, StateMachine, StateMachineRun,
};
use kinopt::io::{ReadError, state_machine};

pub fn armature() -> Armature {
    let bone = ArmatureBone {
        name: "hips".into(),
        parent: None,
        rest: LocalTransform::IDENTITY,
    };
    Armature::new(vec![bone], Vec::new()).unwrap()
}

/// Clips that move the hips along x, each at its own height, so that a pose identifies its clip.
pub fn clips() -> Vec<Arc<Clip>> {
    let armature = armature();
    let heights = [
        ("stand", 0.0, 1.0),
        ("walk", 10.0, 2.0),
        ("run", 20.0, 1.0),
        ("jump", 30.0, 0.5),
    ];
    let clip = |(name, height, length): (&str, f32, f32)| {
        let keys = [0.0, length].map(|x| Vec3A::new(x, height, 0.0)).to_vec();
        let curve = KeyedCurve::linear(vec![0.0, length], keys).unwrap();
        let mut builder = Clip::builder(name, &armature);
        let hips = armature.bone("hips").unwrap();
        builder.channel(hips, Channel::Translation(curve)).unwrap();
        builder.event(0.5 * length, format!("{name} half")).unwrap();
        Arc::new(builder.build())
    };
    heights.map(clip).to_vec()
}

/// State machine that plays these clips.
pub fn machine(json: &str) -> Result<StateMachine, ReadError> {
    state_machine::from_bytes(json.as_bytes(), "machine.json", &clips())
}

pub fn run_of(json: &str) -> StateMachineRun {
    let machine = Arc::new(machine(json).unwrap());
    StateMachineRun::new(machine, armature().rest()).unwrap()
}

/// Position of the hips: x by time, y by the clip.
pub fn hips(run: &StateMachineRun) -> [f32; 2] {
    let at = run.pose().translations()[0];
    [at.x, at.y]
}
