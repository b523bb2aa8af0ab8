//! Options, entry point and result of inverse kinematics on keyframes.

use nalgebra::DVector;

use super::basis::{KeyAngle, Row, limit_rows};
use super::beyond_limit::BeyondLimit;
use super::cost::KeyCost;
use super::interior::minimise;
use super::within::limited_change;
use crate::motion::clip_ik::root_bone::{ancestors, branching_above};
use crate::motion::clip_ik::{ClipIkError, EditReport, Reach, ReachResult};
use kinopt_animation::animation::{Armature, EulerClip, EulerTrack};
use kinopt_kinematics::bad_option::{BadOption, POSITIVE};
use kinopt_kinematics::skeleton::{ANGLES_PER_BONE, BoneId, Skeleton};

/// Inverse kinematics that edits the existing keyframes of a rig.
///
/// Tips of bones reach points or follow curves over spans, as in [`ClipIk`](super::super::ClipIk). Only keys within
/// those spans change, and only of bones that carry the tips. No key is added, and the spline between keys keeps its
/// kind.
///
/// Joint limits also hold between keys, because the spline's control points are bounded. With few keys a tip may not
/// reach its target; the sum of squared distances over the span is minimal.
///
/// Keys within the spans that exceed a limit are brought within it. Other keys, such as one outside a span, may leave
/// the clip beyond a limit. [`EditReport::beyond`] lists these limits.
///
/// ```
/// # std::env::set_current_dir("../..")?;
/// use kinopt::io::rig::Rig;
/// use kinopt::motion::clip_ik::{KeyframeIk, Reach};
///
/// let rig = Rig::read("models/humanoid/humanoid.json")?;
/// let hand = rig.skeleton.bone("right_hand")?;
/// let reach = Reach::to(hand, [0.3, -0.25, 1.2])?.with_span(1.2..=2.8).with_fade(0.3);
/// let edited = KeyframeIk::new(&rig.skeleton).with_reach(reach).solve(&rig.clip)?;
/// assert!(edited.keys_changed > 0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct KeyframeIk<'a> {
    skeleton: &'a Skeleton,
    reaches: Vec<Reach>,
    root: Option<BoneId>,
    rate: f64,
}

/// Edited keyframes. Lengths are in the rig's unit.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct EditedKeys {
    /// Clip with the edited keyframes.
    pub clip: EulerClip,
    /// Number of changed keys.
    pub keys_changed: usize,
    /// Errors of the clip, at the sample times with full weight.
    pub report: EditReport,
}

/// Weight of a key's displacement of one radian, as a fraction of the skeleton's size.
const CHANGE_WEIGHT_RATIO: f64 = 1e-3;
/// Number of sample times above which a rate is rejected as a mistake.
const MAX_SAMPLES: f64 = 1e6;

impl<'a> KeyframeIk<'a> {
    /// Creates a solver for a skeleton without reaches, with 60 sample times per second.
    #[must_use]
    pub fn new(skeleton: &'a Skeleton) -> Self {
        Self {
            skeleton,
            reaches: Vec::new(),
            root: None,
            rate: 60.0,
        }
    }

    /// Adds a reach.
    #[must_use]
    pub fn with_reach(mut self, reach: Reach) -> Self {
        self.reaches.push(reach);
        self
    }

    /// Sets the root: only keys of bones below it change. Default: the topmost bone that carries all tips and has
    /// more than one child.
    #[must_use]
    pub fn with_root(mut self, bone: BoneId) -> Self {
        self.root = Some(bone);
        self
    }

    /// Sets the number of sample times per second.
    #[must_use]
    pub fn with_moments_per_second(mut self, rate: f64) -> Self {
        self.rate = rate;
        self
    }

    /// Solves for the keys of a clip.
    ///
    /// # Errors
    /// Returns an error for:
    /// - no reach, or no key of a bone that carries a tip within its span,
    /// - a bone of another skeleton, or a bone with two reaches at one time,
    /// - spans and fades that are not within the clip,
    /// - a rate out of range.
    pub fn solve(&self, clip: &EulerClip) -> Result<EditedKeys, ClipIkError> {
        BadOption::check("moments_per_second", self.rate, POSITIVE)?;
        let span = clip.time_span().ok_or(ClipIkError::NoKeys)?;
        let armature = Armature::of_skeleton(self.skeleton);
        self.check(&armature, span)?;
        let keys = self.keys(clip, &armature, span)?;
        if keys.is_empty() {
            return Err(ClipIkError::NoKeys);
        }
        let change_weight = CHANGE_WEIGHT_RATIO * self.skeleton.size();
        let times = self.times(span)?;
        let mut cost = KeyCost::new(
            (self.skeleton, clip),
            &self.reaches,
            &keys,
            &times,
            (span, change_weight),
        )?;
        let limits = |key: &KeyAngle| {
            let bone = clip.tracks()[key.track].bone;
            self.skeleton.bones()[bone.index()].limits[key.angle]
        };
        let original = |key: &KeyAngle| clip.tracks()[key.track].keys[key.key].angles[key.angle];
        let clamped = keys
            .iter()
            .map(|key| limits(key).clamp(original(key)) - original(key));
        let clamped = DVector::from_iterator(keys.len(), clamped);
        let mut rows = self.rows(clip, &keys)?;
        let start = limited_change(&mut rows, clamped);
        let enforced = rows.iter().filter(|row| row.allowed.is_finite());
        let hard: Vec<Row> = enforced.cloned().collect();
        let mut changes = minimise(&mut cost, &hard, start)?;
        // Clamping makes the values satisfy the limits exactly.
        let values: Vec<f64> = keys
            .iter()
            .zip(&changes)
            .map(|(key, change)| limits(key).clamp(original(key) + change))
            .collect();
        for ((change, value), key) in changes.iter_mut().zip(&values).zip(&keys) {
            *change = value - original(key);
        }
        let misses = cost.misses(&changes)?;
        let results = self.reaches.iter().enumerate().map(|(k, reach)| {
            let errors = misses.iter().zip(&times);
            let errors = errors.filter_map(|(miss, time)| Some((miss[k]?, *time)));
            let worst = errors.max_by(|one, other| one.0.total_cmp(&other.0));
            let (miss, at) = worst.unwrap_or((0.0, span[0]));
            ReachResult {
                bone: reach.bone,
                miss,
                at,
            }
        });
        let mut tracks = clip.tracks().to_vec();
        for (key, value) in keys.iter().zip(values) {
            tracks[key.track].keys[key.key].angles[key.angle] = value;
        }
        let changed = tracks
            .iter()
            .zip(clip.tracks())
            .flat_map(|(new, old)| new.keys.iter().zip(&old.keys));
        let keys_changed = changed.filter(|(new, old)| new != old).count();
        let keyless = clip.keyless().iter().map(|&bone| EulerTrack {
            bone,
            keys: Vec::new(),
        });
        let clip = EulerClip::new(tracks.into_iter().chain(keyless).collect())
            .and_then(|new| new.interpolated(|track| clip.interpolation(track.bone).clone()))
            .map_err(ClipIkError::Keys)?;
        Ok(EditedKeys {
            clip,
            keys_changed,
            report: EditReport {
                led: results.collect(),
                beyond: BeyondLimit::all(&rows, &changes),
                ..EditReport::default()
            },
        })
    }

    fn check(&self, armature: &Armature, span: [f64; 2]) -> Result<(), ClipIkError> {
        if self.reaches.is_empty() {
            return Err(ClipIkError::Nothing);
        }
        let bones = armature.bones();
        for (k, reach) in self.reaches.iter().enumerate() {
            let bone = reach.bone.index();
            let name = armature
                .names()
                .get(bone)
                .ok_or(ClipIkError::UnknownBone { bone, bones })?;
            reach.check(span)?;
            if self.reaches[..k]
                .iter()
                .any(|other| reach.clashes(other, span))
            {
                return Err(ClipIkError::Twice { bone: name.clone() });
            }
            if let Some(root) = self
                .root
                .filter(|&root| !ancestors(armature, reach.bone).contains(&root))
            {
                let root = armature.names().get(root.index());
                return Err(ClipIkError::NotBelowRoot {
                    bone: name.clone(),
                    root: root.cloned().unwrap_or_default(),
                });
            }
        }
        Ok(())
    }

    /// Returns the angles of the keys that may change.
    fn keys(
        &self,
        clip: &EulerClip,
        armature: &Armature,
        span: [f64; 2],
    ) -> Result<Vec<KeyAngle>, ClipIkError> {
        let tips: Vec<BoneId> = self.reaches.iter().map(|reach| reach.bone).collect();
        let root = self
            .root
            .or_else(|| branching_above(armature, &tips, |_| true));
        let carries = |bone: BoneId, reach: &Reach| {
            let mut chain = vec![reach.bone];
            chain.extend(ancestors(armature, reach.bone));
            chain
                .into_iter()
                .take_while(|ancestor| Some(*ancestor) != root)
                .any(|ancestor| ancestor == bone)
        };
        let mut keys = Vec::new();
        for (index, track) in clip.tracks().iter().enumerate() {
            let Some(skeleton_bone) = self.skeleton.bones().get(track.bone.index()) else {
                let (bone, bones) = (track.bone.index(), armature.bones());
                return Err(ClipIkError::UnknownBone { bone, bones });
            };
            for (key, keyframe) in track.keys.iter().enumerate() {
                let within = |reach: &Reach| {
                    let [from, to] = reach.span(span);
                    (from..=to).contains(&keyframe.time) && carries(track.bone, reach)
                };
                if !self.reaches.iter().any(within) {
                    continue;
                }
                for angle in
                    (0..ANGLES_PER_BONE).filter(|&angle| !skeleton_bone.limits[angle].is_locked())
                {
                    keys.push(KeyAngle::new(clip, index, key, angle)?);
                }
            }
        }
        Ok(keys)
    }

    /// Returns the sample times, seconds.
    fn times(&self, span: [f64; 2]) -> Result<Vec<f64>, ClipIkError> {
        let mut times = Vec::new();
        for reach in &self.reaches {
            let [from, to] = reach.span(span);
            let (from, to) = (from.max(span[0]), to.min(span[1]));
            let steps = ((to - from) * self.rate).ceil().max(1.0);
            BadOption::check(
                "sample times of a span",
                steps,
                (|n| n <= MAX_SAMPLES, "at most a million"),
            )?;
            times.extend((0..=steps as usize).map(|k| from + (to - from) * k as f64 / steps));
        }
        times.sort_by(f64::total_cmp);
        times.dedup();
        Ok(times)
    }

    fn rows(&self, clip: &EulerClip, keys: &[KeyAngle]) -> Result<Vec<Row>, ClipIkError> {
        let mut rows = Vec::new();
        for (index, track) in clip.tracks().iter().enumerate() {
            for angle in 0..ANGLES_PER_BONE {
                let angle_keys = keys.iter().enumerate();
                let angle_keys: Vec<_> = angle_keys
                    .filter(|(_, key)| key.track == index && key.angle == angle)
                    .collect();
                if !angle_keys.is_empty() {
                    let limits = self.skeleton.bones()[track.bone.index()].limits[angle];
                    rows.extend(limit_rows(clip, track, angle, limits, &angle_keys)?);
                }
            }
        }
        Ok(rows)
    }
}
