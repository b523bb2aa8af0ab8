//! How long limbs are, of a person and of a model, and where a capture's joints are on a body of the model's size.

use super::{BodyMap, Capture, RetargetError, UpAxis};
use crate::bad_option::{BadOption, NOT_NEGATIVE, POSITIVE};
use crate::kinematics::ForwardKinematics;
use crate::model::{FrameId, JointId, Model, UnknownName};
use crate::spatial::Vector3;

/// Frames of a capture, and configurations of a model, that lengths are measured in.
const MEASURED: usize = 256;
/// Lengths are those that so many of them do not exceed: a limb of two bones is as long as it gets.
const QUANTILE: f64 = 0.9;
/// A limb shorter than this share of the body is none: it is as long as the model's.
const NO_LIMB: f64 = 1e-6;
/// The ground is as high as so many of the lowest places of what stands.
const GROUND_QUANTILE: f64 = 0.05;

/// A driven frame, and the limb that it ends.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Limb {
    /// The captured joint.
    pub(super) joint: usize,
    pub(super) frame: FrameId,
    pub(super) offset: Vector3<f64>,
    pub(super) weight: f64,
    /// The limb that it hangs on, before it; `None` for the root.
    pub(super) parent: Option<usize>,
    /// How many times as long as the person's the model's is.
    pub(super) scale: f64,
    /// Whether it stands on something at times.
    pub(super) stands: bool,
    /// How high it is over the ground that the model stands on, metres.
    pub(super) clearance: f64,
    /// How high the person's is when it stands on the ground, in the capture's unit.
    ground: f64,
}

/// All driven frames, parents first, and how a capture's places become theirs.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Limbs {
    pub(super) all: Vec<Limb>,
    up: UpAxis,
    /// How many times as large as the person's the model's steps are.
    pub(super) stride: f64,
}

impl Limbs {
    pub(super) fn new(
        model: &Model,
        map: &BodyMap,
        capture: &Capture,
        up: UpAxis,
        stance: &[f64],
    ) -> Result<Self, RetargetError> {
        let mut all = of_map(model, map, capture)?;
        order(model, &mut all);
        let lengths_of_model = lengths(&all, &model_places(model, &all)?);
        let captured = capture_places(capture, &all, up);
        let lengths_of_person = lengths(&all, &captured);
        let size: f64 = lengths_of_person.iter().sum();
        for (limb, (own, person)) in all
            .iter_mut()
            .zip(lengths_of_model.iter().zip(&lengths_of_person))
        {
            if limb.scale == 0.0 {
                let real = *person > NO_LIMB * size && *own > 0.0;
                limb.scale = if real { own / person } else { 1.0 };
            }
        }
        // Of the legs, from what stands up to the root: so steps and boxes fit them.
        let stands = all.iter().any(|limb| limb.stands);
        let in_legs = leg_limbs(&all, stands);
        let total = |lengths: &[f64]| -> f64 { in_legs.iter().map(|&limb| lengths[limb]).sum() };
        let (own, person) = (total(&lengths_of_model), total(&lengths_of_person));
        let stride = if person > 0.0 && own > 0.0 {
            own / person
        } else {
            1.0
        };
        let count = all.len();
        for (k, limb) in all.iter_mut().enumerate() {
            let own = captured.iter().skip(k).step_by(count);
            let mut heights: Vec<f64> = own.map(|at| at.z).collect();
            limb.ground = quantile(&mut heights, GROUND_QUANTILE);
        }
        let mut kinematics = ForwardKinematics::new(model);
        let placed = kinematics
            .place(stance)
            .map_err(|error| RetargetError::Map(error.to_string()))?;
        let heights = all
            .iter()
            .map(|limb| placed[limb.frame.index()].apply(limb.offset).z);
        let heights: Vec<f64> = heights.collect();
        let lowest = placed
            .iter()
            .map(|frame| frame.translation.z)
            .fold(f64::INFINITY, f64::min);
        for (limb, height) in all.iter_mut().zip(heights) {
            limb.clearance = height - lowest;
        }
        // The root is as much over what stands as the person's is.
        let standing = all.iter().filter(|limb| limb.stands || !stands);
        let lowest = standing.min_by(|a, b| a.ground.total_cmp(&b.ground));
        let (ground, sole) = lowest.map_or((0.0, 0.0), |limb| (limb.ground, limb.clearance));
        if let Some(root) = all.first_mut().filter(|root| !root.stands) {
            (root.ground, root.clearance) = (ground, sole);
        }
        Ok(Self { all, up, stride })
    }

    /// Whether a limb is placed in the world, as the root and feet are, rather than at the end of its limb.
    fn is_in_world(&self, limb: &Limb) -> bool {
        limb.parent
            .is_none_or(|parent| limb.stands && !self.all[parent].stands)
    }

    /// Where the driven frames should be, metres: the root and feet in a world scaled as the
    /// legs are, what hangs on them by the lengths of limbs.
    pub(super) fn place(&self, captured: &[Vector3<f64>], to: &mut Vec<Vector3<f64>>) {
        to.clear();
        for limb in &self.all {
            let at = upright(captured[limb.joint], self.up);
            to.push(match limb.parent {
                Some(parent) if !self.is_in_world(limb) => {
                    let from = upright(captured[self.all[parent].joint], self.up);
                    to[parent] + (at - from) * limb.scale
                }
                _ => {
                    let over_ground = Vector3::new(at.x, at.y, at.z - limb.ground);
                    over_ground * self.stride + Vector3::new(0.0, 0.0, limb.clearance)
                }
            });
        }
    }
}

/// A capture's vector with z upward.
fn upright(at: Vector3<f64>, up: UpAxis) -> Vector3<f64> {
    match up {
        UpAxis::Z => at,
        UpAxis::Y => Vector3::new(at.x, -at.z, at.y),
    }
}

/// The driven frames in the map's order, without limbs yet.
fn of_map(model: &Model, map: &BodyMap, capture: &Capture) -> Result<Vec<Limb>, RetargetError> {
    let mut all: Vec<Limb> = Vec::with_capacity(map.drives.len());
    for drive in &map.drives {
        BadOption::check("weight", drive.weight, NOT_NEGATIVE)?;
        if let Some(scale) = drive.scale {
            BadOption::check("scale", scale, POSITIVE)?;
        }
        let frame = model.frame(&drive.frame)?;
        if let Some(other) = all
            .iter()
            .find(|limb| limb.frame == frame && limb.offset == drive.offset)
        {
            return Err(RetargetError::DrivenTwice {
                frame: drive.frame.clone(),
                first: capture.names()[other.joint].clone(),
                second: drive.joint.clone(),
            });
        }
        all.push(Limb {
            joint: capture.joint(&drive.joint)?,
            frame,
            offset: drive.offset,
            weight: drive.weight,
            parent: None,
            scale: drive.scale.unwrap_or(0.0),
            stands: match &map.contacts {
                Some(contacts) => contacts.contains(&drive.joint),
                None => drive.is_of_a_foot(),
            },
            clearance: 0.0,
            ground: 0.0,
        });
    }
    for contact in map.contacts.iter().flatten() {
        let driving = map.drives.iter().map(|drive| drive.joint.as_str());
        if !map.drives.iter().any(|drive| drive.joint == *contact) {
            return Err(UnknownName::new("driving joint", contact, driving).into());
        }
    }
    match all.is_empty() {
        true => Err(RetargetError::NoDrives {
            model: model.name().to_owned(),
        }),
        false => Ok(all),
    }
}

/// The joints from a frame up to the root.
fn joints_above(model: &Model, frame: FrameId) -> Vec<JointId> {
    let mut above = model.frames()[frame.index()].joint;
    let joints = std::iter::from_fn(|| {
        let joint = above?;
        above = model.joints()[joint.index()].parent;
        Some(joint)
    });
    joints.collect()
}

/// Puts parents first and finds them: the nearest driven frame towards the model's root, or the one nearest to it.
fn order(model: &Model, all: &mut [Limb]) {
    let moving = |limb: &Limb| {
        let above = joints_above(model, limb.frame);
        let moves = |joint: &JointId| model.joints()[joint.index()].kind.moves();
        above.into_iter().filter(moves).collect::<Vec<_>>()
    };
    // Of those that one joint moves, the nearest to it first: a knee before the ankle at the shin's end.
    let off = |limb: &Limb| {
        model.frames()[limb.frame.index()]
            .joint_from_frame
            .apply(limb.offset)
    };
    all.sort_by(|a, b| {
        let lengths = [a, b].map(|limb| moving(limb).len());
        let offs = [a, b].map(|limb| off(limb).norm());
        lengths[0]
            .cmp(&lengths[1])
            .then(offs[0].total_cmp(&offs[1]))
    });
    let chains: Vec<Vec<JointId>> = all.iter().map(moving).collect();
    for k in 1..all.len() {
        let carried_by = |other: &usize| {
            let tip = chains[*other].first();
            tip.is_some_and(|tip| chains[k].contains(tip))
        };
        all[k].parent = Some((0..k).rev().find(carried_by).unwrap_or(0));
    }
}

/// The limbs between what stands and the root, without those at the root, which are hips; without any that stands, all.
fn leg_limbs(all: &[Limb], stands: bool) -> Vec<usize> {
    let mut found: Vec<usize> = Vec::new();
    for (end, limb) in all.iter().enumerate() {
        let mut at = if limb.stands || !stands {
            Some(end)
        } else {
            None
        };
        while let Some(own) = at {
            at = all[own].parent;
            let is_hip = own != end && at.is_some_and(|parent| all[parent].parent.is_none());
            if at.is_some() && !is_hip && !found.contains(&own) {
                found.push(own);
            }
        }
    }
    found
}

/// Where the driven frames are in random configurations of a model.
fn model_places(model: &Model, all: &[Limb]) -> Result<Vec<Vector3<f64>>, RetargetError> {
    let mut kinematics = ForwardKinematics::new(model);
    let mut places = Vec::with_capacity(MEASURED * all.len());
    for seed in 0..MEASURED {
        let q = model.random_configuration(seed as u64);
        let placed = kinematics
            .place(&q)
            .map_err(|error| RetargetError::Map(error.to_string()))?;
        places.extend(
            all.iter()
                .map(|limb| placed[limb.frame.index()].apply(limb.offset)),
        );
    }
    Ok(places)
}

/// Where the driving joints are in frames all over a capture.
fn capture_places(capture: &Capture, all: &[Limb], up: UpAxis) -> Vec<Vector3<f64>> {
    let step = capture.frames().div_ceil(MEASURED).max(1);
    let frames = (0..capture.frames())
        .step_by(step)
        .filter_map(|frame| capture.frame(frame));
    let places = frames.flat_map(|at| all.iter().map(|limb| upright(at[limb.joint], up)));
    places.collect()
}

/// How long each limb is at its most, but for outliers; 0 for the root.
fn lengths(all: &[Limb], places: &[Vector3<f64>]) -> Vec<f64> {
    let of_limb = |(k, limb): (usize, &Limb)| {
        let Some(parent) = limb.parent else {
            return 0.0;
        };
        let frames = places.chunks_exact(all.len());
        let mut lengths: Vec<f64> = frames.map(|at| (at[k] - at[parent]).norm()).collect();
        quantile(&mut lengths, QUANTILE)
    };
    all.iter().enumerate().map(of_limb).collect()
}

fn quantile(values: &mut [f64], share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let last = values.len().saturating_sub(1);
    let at = (share * last as f64) as usize;
    values.get(at).copied().unwrap_or(0.0)
}
