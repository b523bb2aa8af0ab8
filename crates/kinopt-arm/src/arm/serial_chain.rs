//! Serial chain of an arm from base to tool as a model, with constant transforms combined.

use super::ArmError;
use super::kinematic_path::Part;
use crate::simd_ik::{Chain, ChainJoint};
use kinopt_kinematics::model::{
    FrameId, JointId, Limits, Model, ModelBuilder, ParameterMap, Source,
};
use kinopt_kinematics::spatial::Placement;

/// Name of the tool's frame in the chain's model.
pub(super) const TOOL: &str = "tool";

/// Chain from base to tool, whose world is the base.
#[derive(Clone, Debug)]
pub(super) struct Serial {
    pub(super) model: Model,
    /// Map with coupled mimic joints; its variables are the arm's joints, base to tip.
    pub(super) map: ParameterMap,
    pub(super) tool: FrameId,
    /// Constant transform from the last joint to the tip, which carries the tool.
    last_from_tip: Placement<f64>,
    /// Chain for the SIMD solver, if it supports the chain.
    pub(super) chain: Option<Chain>,
    /// Joint of the source model for every variable.
    pub(super) joints: Vec<JointId>,
    /// Flags of the variables that drive a mimic joint of the chain.
    pub(super) drives_mimic: Vec<bool>,
    /// Sum of the lengths of all translations from base to tip, with free prismatic joints at zero; metres.
    extent_to_tip: f64,
    /// Sum of the lengths of all translations from base to tool, with free prismatic joints at zero; metres.
    pub(super) extent: f64,
}

/// Builder of a chain from its parts.
struct Assembly<'a> {
    source: &'a Model,
    full: &'a ParameterMap,
    builder: ModelBuilder,
    last: Option<JointId>,
    last_from_next: Placement<f64>,
    chain: Vec<ChainJoint>,
    extent: f64,
    /// Joint of the chain for every variable of the full map.
    source_joints: Vec<Option<JointId>>,
    /// Source joint of every variable, base to tip.
    joints: Vec<JointId>,
    /// Mimic joints: (joint, variable of the full map, ratio, offset).
    mimic_joints: Vec<(JointId, usize, f64, f64)>,
}

/// Source of a coordinate's value; a variable whose bounds are equal is a constant.
pub(super) fn source_of(full: &ParameterMap, coordinate: usize) -> Source {
    let source = full.sources()[coordinate];
    let is_fixed = |(variable, _): (usize, f64)| full.lower()[variable] == full.upper()[variable];
    match source.slope().is_some_and(is_fixed) {
        true => Source::Constant(source.at(full.lower())),
        false => source,
    }
}

impl Serial {
    /// Radians that a radian or metre of each variable counts as, by the metres that weigh as much as a radian.
    pub(super) fn scales(&self, metres_per_radian: f64) -> Vec<f64> {
        let joint_index = |&c: &usize| self.model.moving_joints()[c].index();
        let joint_indices = self.map.leaders().iter().map(joint_index);
        let scale = |joint: usize| match self.model.joints()[joint].kind.slides() {
            true => metres_per_radian.recip(),
            false => 1.0,
        };
        joint_indices.map(scale).collect()
    }

    /// Combines the parts into a chain; `full` gives the free joints of `source`.
    pub(super) fn new(
        source: &Model,
        full: &ParameterMap,
        parts: &[Part],
        tip_from_tool: Placement<f64>,
        name: (&str, &str),
    ) -> Result<Self, ArmError> {
        let mut balls = parts.iter().filter_map(|part| match *part {
            Part::Joint { id, .. } => Some(&source.joints()[id.index()]),
            Part::Fixed(_) => None,
        });
        if let Some(ball) = balls.find(|joint| joint.kind.is_ball()) {
            return Err(ArmError::BallJoint {
                joint: ball.name.clone(),
            });
        }
        let mut assembly = Assembly {
            source,
            full,
            builder: Model::builder(format!("{} from {} to {}", source.name(), name.0, name.1)),
            last: None,
            last_from_next: Placement::identity(),
            chain: Vec::new(),
            extent: 0.0,
            source_joints: vec![None; full.variables()],
            joints: Vec::new(),
            mimic_joints: Vec::new(),
        };
        for part in parts {
            assembly.add(part, parts);
        }
        assembly.finish(tip_from_tool, name)
    }

    /// The same chain with another tool.
    pub(super) fn with_tool(&self, tip_from_tool: Placement<f64>) -> Result<Self, ArmError> {
        let last_from_tool = self.last_from_tip * tip_from_tool;
        let extent = self.extent_to_tip + tip_from_tool.translation.norm();
        let chain = self.chain.as_ref();
        let chain = chain.and_then(|chain| chain.with_tip(last_from_tool).ok());
        Ok(Self {
            model: self.model.with_frame_at(self.tool, last_from_tool)?,
            map: self.map.clone(),
            tool: self.tool,
            last_from_tip: self.last_from_tip,
            chain: chain.map(|chain| chain.with_extent(extent)),
            extent_to_tip: self.extent_to_tip,
            extent,
            joints: self.joints.clone(),
            drives_mimic: self.drives_mimic.clone(),
        })
    }
}

impl Assembly<'_> {
    fn add(&mut self, part: &Part, parts: &[Part]) {
        let (id, reversed) = match *part {
            Part::Fixed(placement) => {
                self.extent += placement.translation.norm();
                self.last_from_next = self.last_from_next * placement;
                return;
            }
            Part::Joint { id, reversed } => (id, reversed),
        };
        let joint = &self.source.joints()[id.index()];
        let axis = if reversed { -joint.axis } else { joint.axis };
        let Some(coordinate) = self.source.coordinate(id) else {
            return;
        };
        match source_of(self.full, coordinate) {
            // `Serial::new` returned an error for it.
            Source::Rotation { .. } => {}
            Source::Constant(value) => {
                let motion = joint.kind.joint_from_moved(axis, value);
                self.extent += motion.translation.norm();
                self.last_from_next = self.last_from_next * motion;
            }
            Source::Variable {
                variable,
                ratio,
                offset,
            } => {
                let source_joint = self.source.moving_joints()[self.full.leaders()[variable]];
                let is_source = source_joint == id;
                let limits = if is_source {
                    Limits::new(self.full.lower()[variable], self.full.upper()[variable])
                } else {
                    joint.limits
                };
                let is_on_chain = parts.iter().any(|part| part.is_joint(source_joint));
                if !is_source && self.source_joints[variable].is_none() && !is_on_chain {
                    self.add_outside_source(source_joint, variable);
                }
                let mut chain_joint = joint.clone();
                chain_joint.parent = self.last;
                chain_joint.parent_from_joint = self.last_from_next;
                chain_joint.kind = joint.kind.within(&limits);
                chain_joint.axis = axis;
                chain_joint.limits = limits;
                chain_joint.ball = None;
                let chain_joint = self.builder.joint(chain_joint);
                self.chain.push(ChainJoint {
                    parent_from_joint: self.last_from_next,
                    axis,
                    kind: joint.kind,
                    lower: limits.lower,
                    upper: limits.upper,
                });
                self.last_from_next = Placement::identity();
                self.last = Some(chain_joint);
                if is_source {
                    self.source_joints[variable] = Some(chain_joint);
                    self.joints.push(id);
                } else {
                    self.mimic_joints
                        .push((chain_joint, variable, ratio, offset));
                }
            }
        }
    }

    /// Adds the source of a mimic joint that is outside the chain, as a joint without a parent.
    fn add_outside_source(&mut self, source_joint: JointId, variable: usize) {
        let joint = &self.source.joints()[source_joint.index()];
        let limits = Limits::new(self.full.lower()[variable], self.full.upper()[variable]);
        let mut chain_joint = joint.clone();
        chain_joint.parent = None;
        chain_joint.kind = joint.kind.within(&limits);
        chain_joint.limits = limits;
        let chain_joint = self.builder.joint(chain_joint);
        self.source_joints[variable] = Some(chain_joint);
        self.joints.push(source_joint);
    }

    fn finish(
        mut self,
        tip_from_tool: Placement<f64>,
        name: (&str, &str),
    ) -> Result<Serial, ArmError> {
        if self.joints.is_empty() {
            return Err(ArmError::NoFreeJoint {
                base: name.0.to_owned(),
                tip: name.1.to_owned(),
            });
        }
        let last_from_tool = self.last_from_next * tip_from_tool;
        let extent = self.extent + tip_from_tool.translation.norm();
        let tool = self.builder.frame(TOOL, self.last, last_from_tool);
        let model = self.builder.build()?;
        let mut map = ParameterMap::builder(&model);
        let mut drives_mimic = vec![false; self.joints.len()];
        for &(mimic_joint, variable, ratio, offset) in &self.mimic_joints {
            if let Some(source_joint) = self.source_joints[variable] {
                map = map.with_coupled(mimic_joint, source_joint, ratio, offset);
                let source = self.source.moving_joints()[self.full.leaders()[variable]];
                for (drives_mimic, &joint) in drives_mimic.iter_mut().zip(&self.joints) {
                    *drives_mimic |= joint == source;
                }
            }
        }
        let map = map.build()?;
        // The general solver handles chains with bounds beyond a million radians.
        let chain = match self.mimic_joints.is_empty() {
            true => Chain::new(self.chain, last_from_tool).ok(),
            false => None,
        };
        let chain = chain.map(|chain| chain.with_extent(extent));
        Ok(Serial {
            model,
            map,
            tool,
            last_from_tip: self.last_from_next,
            chain,
            joints: self.joints,
            drives_mimic,
            extent_to_tip: self.extent,
            extent,
        })
    }
}
