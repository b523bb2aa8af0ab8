//! Conversion of the bodies, joints and sites of a document to a model.

use std::collections::HashSet;
use std::f64::consts::PI;

use super::attributes::Attributes;
use super::body::BodyElement;
use super::equality::{self, Coupling};
use super::joint::{JointElement, JointType};
use super::names::{self, ElementNames, FreshNames, WORLD};
use super::orientation::direction;
use crate::robot::xml::{ParseIssue, Read, Repair, RepairKind, RobotFileError};
use crate::robot::{DriveLimits, Mimic};
use kinopt_kinematics::model::{BallLimits, FrameId, JointId, Limits, Model, ModelBuilder};
use kinopt_kinematics::scalar::elementary::clean_sin_cos;
use kinopt_kinematics::spatial::{Matrix3, Placement, Quaternion, Vector3};

/// A model under construction, and data that is stored next to it.
pub(super) struct Build<'a> {
    pub(super) builder: ModelBuilder,
    pub(super) names: ElementNames<'a>,
    /// MuJoCo's `qpos0`: the configuration in which the body poses are those of the file.
    pub(super) reference_configuration: Vec<f64>,
    pub(super) drives: Vec<DriveLimits>,
    /// Notes on attributes that are read differently from what they seem to state.
    pub(super) notes: Vec<Repair>,
    /// Line and name of the element of each mimic joint, in the order of [`couple`](Self::couple).
    pub(super) couplings: Vec<(u32, String)>,
}

/// Angle π rounded up as in files, radians.
const ROUNDED_PI: f64 = PI + 1e-3;

/// The carrying joint, and a pose in its frame.
type CarriedPose = (Option<JointId>, Placement<f64>);

impl<'a> Build<'a> {
    pub(super) fn new(name: &str) -> Self {
        Self {
            builder: Model::builder(name),
            names: ElementNames::default(),
            reference_configuration: Vec::new(),
            drives: Vec::new(),
            notes: Vec::new(),
            couplings: Vec::new(),
        }
    }

    /// Adds bodies, their joints and their sites. Frames of bodies come first because link indices equal body indices.
    pub(super) fn add(&mut self, bodies: &[BodyElement<'a>]) -> Read<()> {
        let [mut joint_names, mut frame_names] = names::file_names(bodies)?;
        let mut carried_poses: Vec<CarriedPose> = Vec::with_capacity(bodies.len());
        let mut body_names: Vec<String> = Vec::with_capacity(bodies.len());
        for (index, body) in bodies.iter().enumerate() {
            let parent = body
                .parent
                .and_then(|parent| carried_poses.get(parent).copied());
            let (carrier, carrier_from_parent) = parent.unwrap_or((None, Placement::identity()));
            let name = match (index, body.tag.text("name")) {
                (0, _) => WORLD.to_owned(),
                (_, Some(name)) => name.to_owned(),
                (index, None) => frame_names.fresh(format!("body/{index}")),
            };
            let mut carried_pose = (carrier, carrier_from_parent * body.parent_from_body);
            for joint in &body.joints {
                carried_pose = self.joint(joint, carried_pose, &name, &mut joint_names);
            }
            let frame = self
                .builder
                .frame(name.as_str(), carried_pose.0, carried_pose.1);
            self.names.add_body(body.tag, frame);
            carried_poses.push(carried_pose);
            body_names.push(name);
        }
        let body_name_set: HashSet<&str> = body_names.iter().map(String::as_str).collect();
        for ((body, (carrier, carrier_from_parent)), body_name) in
            bodies.iter().zip(&carried_poses).zip(&body_names)
        {
            for site in &body.sites {
                let name = match site.tag.text("name") {
                    Some(name) if body_name_set.contains(name) => {
                        frame_names.fresh(format!("site/{name}"))
                    }
                    Some(name) => name.to_owned(),
                    None => frame_names.fresh(format!("{body_name}/site")),
                };
                let frame: FrameId =
                    self.builder
                        .frame(name, *carrier, *carrier_from_parent * site.body_from_site);
                self.names.add_site(site.tag, frame);
            }
        }
        Ok(())
    }

    /// Adds a joint of a body, at the pose after the joints of the body that come earlier.
    fn joint(
        &mut self,
        element: &JointElement<'a>,
        (carrier, at): CarriedPose,
        body: &str,
        joint_names: &mut FreshNames,
    ) -> CarriedPose {
        let name = match element.tag.text("name") {
            Some(name) => name.to_owned(),
            None => joint_names.fresh(format!("{body}/{}", element.kind.name())),
        };
        let anchored = at * Placement::translation(element.anchor);
        let axis = element.axis;
        let id = match element.kind {
            // The coordinates of a free joint are absolute poses; the pose of the file is only the initial one.
            JointType::Free => {
                let Vector3 { x, y, z } = at.translation;
                let Quaternion { w, v } = Quaternion::from_matrix(&at.rotation);
                self.reference_configuration
                    .extend([x, y, z, w, v.x, v.y, v.z]);
                let bounds = [Limits::UNBOUNDED; 3];
                self.builder.free(name, None, Placement::identity(), bounds)
            }
            JointType::Ball => {
                self.reference_configuration.extend([1.0, 0.0, 0.0, 0.0]);
                let angle = element.range.map(|range| range.upper);
                let oversized = angle.filter(|angle| *angle > ROUNDED_PI);
                self.notes.extend(oversized.map(|angle| Repair {
                    line: element.tag.line(),
                    element: element.tag.label(),
                    mended: RepairKind::StopsNothing { angle },
                }));
                let limits = angle
                    .filter(|angle| *angle < PI)
                    .map(BallLimits::within_angle);
                self.builder.ball(name, carrier, anchored, axis, limits)
            }
            JointType::Slide | JointType::Hinge => {
                self.reference_configuration.push(element.reference);
                let is_prismatic = element.kind == JointType::Slide;
                let unit = direction(axis).unwrap_or(axis);
                let sin_cos = clean_sin_cos(-element.reference);
                let reference_motion = match is_prismatic {
                    true => Placement::translation(unit * -element.reference),
                    false => Placement::new(Matrix3::rotation(unit, sin_cos), Vector3::zero()),
                };
                let at = anchored * reference_motion;
                match (is_prismatic, element.range) {
                    (true, range) => {
                        let limits = range.unwrap_or(Limits::UNBOUNDED);
                        self.builder.prismatic(name, carrier, at, axis, limits)
                    }
                    (false, Some(limits)) => self.builder.revolute(name, carrier, at, axis, limits),
                    (false, None) => self.builder.continuous(name, carrier, at, axis),
                }
            }
        };
        self.names.add_joint(element, id);
        self.drives.resize(id.index(), DriveLimits::default());
        self.drives.push(DriveLimits {
            effort: element.effort,
            ..DriveLimits::default()
        });
        match element.kind {
            JointType::Free => (Some(id), Placement::identity()),
            _ => (Some(id), Placement::translation(-element.anchor)),
        }
    }

    /// Reads the mimic joints. Equalities of other kinds go to `left_out`.
    pub(super) fn couple(
        &mut self,
        equalities: &[Attributes<'_>],
        left_out: &mut Vec<RobotFileError>,
    ) -> Read<Vec<Mimic>> {
        let mut mimics = Vec::new();
        for equality in equalities {
            match equality.tag.name() {
                "joint" => {}
                "connect" | "weld" => continue,
                other => {
                    let element = other.to_owned();
                    left_out.push(equality.fault(ParseIssue::UnsupportedElement { element }));
                    continue;
                }
            }
            let coupling: Result<Coupling, _> = equality::coupling(equality, &self.names);
            let result = coupling.and_then(|coupling| {
                equality::add_coupling(equality, coupling, &mut mimics, &mut self.builder)
            });
            match result {
                Err(RobotFileError::Element {
                    fault: ParseIssue::NotLinear | ParseIssue::FollowsAlready { .. },
                    ..
                }) => left_out.extend(result.err()),
                other => other?,
            }
            if mimics.len() > self.couplings.len() {
                let tag = equality.tag;
                self.couplings.push((tag.line(), tag.label()));
            }
        }
        Ok(mimics)
    }
}
