//! Locked joints and tools, for all solvers.

use kinopt::model::{
    FrameId, JointId, Model, ModelBuilder, ParameterMap, ParameterMapBuilder, UnknownName,
};
use kinopt::robot::{Robot, Srdf};
use kinopt::spatial::Placement;
use kinopt_bindings::problem_file::ModelSettings;

use crate::failure::Outcome;
use crate::frame_name::{self, BareName};
use crate::loaded_model::{HeldJoints, LoadedModel};

/// Resolves the names. Joints without a value are locked as in `start`.
pub(crate) fn held_joints(
    settings: &ModelSettings,
    loaded: &LoadedModel,
    start: &[f64],
) -> Outcome<HeldJoints> {
    let model = &loaded.model;
    let is_angle: Vec<bool> = loaded.is_angle().collect();
    let (mut locked, mut locked_balls) = (Vec::new(), Vec::new());
    for lock in &settings.lock {
        let joints = joints(loaded, &lock.joint)?;
        if let (Some(_), [_, _, ..]) = (lock.value, joints.as_slice()) {
            let names = joints.iter().map(|&joint| loaded.joint_name(joint));
            return Err(usage!(
                "--lock: bone `{}` has several angles; give a value to one of them: {}",
                lock.joint,
                names.collect::<Vec<_>>().join(", ")
            ));
        }
        for joint in joints {
            let coordinate = model.coordinate(joint);
            if let Some(first) = coordinate.filter(|_| is_ball(model, joint)) {
                if lock.value.is_some() {
                    return Err(usage!(
                        "--lock: joint `{}` is a ball joint; it takes no value and is locked as in the start",
                        lock.joint
                    ));
                }
                let quaternion = start.get(first..).and_then(<[f64]>::first_chunk);
                locked_balls.push((joint, quaternion.copied().unwrap_or([1.0, 0.0, 0.0, 0.0])));
                continue;
            }
            let at = |list: &[f64]| coordinate.and_then(|c| list.get(c).copied());
            let turns = coordinate.and_then(|c| is_angle.get(c).copied());
            let value = match lock.value {
                Some(value) if lock.degrees && turns == Some(true) => value.to_radians(),
                Some(value) => value,
                None => at(start).unwrap_or_default(),
            };
            locked.push((joint, value));
        }
    }
    let mut only = Vec::new();
    for name in &settings.only {
        for joint in joints(loaded, name.trim())? {
            let is_locked_ball = locked_balls.iter().any(|(id, _)| *id == joint);
            if is_locked_ball || locked.iter().any(|(id, _)| *id == joint) {
                let joint_name = loaded.joint_name(joint);
                return Err(usage!("joint `{joint_name}` is locked and in `only`"));
            }
            only.push(joint);
        }
    }

    if let (Some(srdf), Some(robot)) = (&loaded.srdf, &loaded.robot) {
        take_srdf(settings, srdf, robot, start, (&mut locked, &mut only))?;
    }

    let builder = match &loaded.robot {
        Some(robot) => robot.parameters(),
        None => ParameterMap::builder(model),
    };
    let mut held = HeldJoints {
        map: loaded.own_parameters(),
        locked,
        turned: locked_balls,
        only: (!only.is_empty()).then(|| (only, start.to_vec())),
    };
    held.map = held.add_to(builder, &[]).build()?;
    Ok(held)
}

impl HeldJoints {
    /// Adds the locked joints to a map, except those in `already`.
    pub(super) fn add_to<'m>(
        &self,
        mut builder: ParameterMapBuilder<'m>,
        already: &[JointId],
    ) -> ParameterMapBuilder<'m> {
        for &(joint, value) in self.locked.iter().filter(|(id, _)| !already.contains(id)) {
            builder = builder.with_locked(joint, value);
        }
        for &(joint, rotation) in self.turned.iter().filter(|(id, _)| !already.contains(id)) {
            builder = builder.with_locked_ball(joint, rotation);
        }
        match &self.only {
            Some((only, start)) => builder.with_only(only, start),
            None => builder,
        }
    }
}

fn is_ball(model: &Model, joint: JointId) -> bool {
    let joint = model.joints().get(joint.index());
    joint.is_some_and(|joint| joint.kind.is_ball())
}

/// Locks passive joints and frees the joints of the group. Mimic joints are left out.
fn take_srdf(
    settings: &ModelSettings,
    srdf: &Srdf,
    robot: &Robot,
    start: &[f64],
    (locked, only): (&mut Vec<(JointId, f64)>, &mut Vec<JointId>),
) -> Outcome<()> {
    let follows = |joint: JointId| robot.mimics().iter().any(|mimic| mimic.joint == joint);
    for &joint in &srdf.passive_joints {
        let is_listed = locked.iter().any(|(id, _)| *id == joint) || only.contains(&joint);
        let value = robot
            .model()
            .coordinate(joint)
            .and_then(|coordinate| start.get(coordinate));
        if let (false, Some(value)) = (is_listed || follows(joint), value) {
            locked.push((joint, *value));
        }
    }
    if let Some(group) = &settings.group {
        let joints = srdf.group(group)?.joints.iter().copied();
        let is_held = |joint: JointId| locked.iter().any(|(id, _)| *id == joint);
        only.extend(joints.filter(|&joint| !follows(joint) && !is_held(joint)));
        if only.is_empty() {
            return Err(failure!("group `{group}` has no movable joint"));
        }
    }
    Ok(())
}

/// Joints of a name: one joint, or the joints of a bone that its limits do not lock.
fn joints(loaded: &LoadedModel, wanted: &str) -> Outcome<Vec<JointId>> {
    let model = &loaded.model;
    if let Some(rig) = &loaded.rig {
        if let Some(bone) = frame_name::bone(rig, wanted) {
            if let Some(balls) = &loaded.balls {
                return Ok(balls.joints(bone));
            }
            let ids = rig.skeleton.joints(bone).into_iter();
            let movable = ids.filter(|&id| {
                let limits = model.joints().get(id.index()).map(|joint| joint.limits);
                limits.is_some_and(|limits| !limits.is_locked())
            });
            return Ok(movable.collect());
        }
    }
    match model.joint(wanted) {
        Ok(joint) if model.coordinate(joint).is_some() => Ok(vec![joint]),
        Ok(_) => Err(failure!("joint `{wanted}` is fixed")),
        Err(_) => {
            let bones = loaded.rig.iter().flat_map(|rig| rig.skeleton.bones());
            let bones = bones.map(|bone| bone.name.as_str());
            let kind = match loaded.rig {
                Some(_) => "bone or joint",
                None => "moving joint",
            };
            let names = bones.chain(loaded.joint_names());
            let unknown = UnknownName::new(kind, wanted, names);
            Err(unknown.with_note("`kinopt info` lists all").into())
        }
    }
}

impl LoadedModel {
    /// Adds a tool to a frame. Targets of the frame then apply to the tool.
    pub(super) fn put_tool(&mut self, frame: FrameId, tool: &Placement<f64>) -> Outcome<()> {
        let Some(frame_below) = self.model.frames().get(frame.index()) else {
            return Ok(());
        };
        let mut builder = ModelBuilder::from_model(&self.model);
        let name = format!("tool on {}", frame_below.name);
        let id = builder.frame(
            name,
            frame_below.joint,
            frame_below.joint_from_frame * *tool,
        );
        self.model = builder.build()?;
        self.tool = Some((frame, id));
        Ok(())
    }

    /// The frame under a tool; any other frame itself.
    pub(super) fn under_tool(&self, frame: FrameId) -> FrameId {
        match self.tool {
            Some((frame_below, tool)) if tool == frame => frame_below,
            _ => frame,
        }
    }

    /// Frame of a target by name: the tool, if there is one on the named frame.
    pub(super) fn target_frame(&self, name: &str) -> Result<FrameId, UnknownName> {
        let frame = self.frame(name, BareName::Tip)?;
        Ok(match self.tool {
            Some((frame_below, tool)) if frame_below == frame => tool,
            _ => frame,
        })
    }
}
