//! Report of inverse kinematics over a clip.

use kinopt::animation::Armature;
use kinopt::glam::Vec3;
use kinopt::motion::clip_ik::{EditedClip, EditedKeys, ReachResult};
use kinopt::skeleton::{BoneId, Skeleton};
use serde::Serialize;

/// Stances, misses and how far the root moves, for people and as JSON.
#[derive(Serialize)]
pub(super) struct IkReport {
    stances: Vec<StanceReport>,
    led: Vec<LedReport>,
    /// How far the root moves at most from where the clip has it, in the file's unit.
    root_moved: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    travel: Option<[f32; 3]>,
    /// Joints of a rig that its keys leave beyond their limits.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    beyond: Vec<BeyondReport>,
}

#[derive(Serialize)]
struct BeyondReport {
    joint: String,
    by: f64,
    at: f64,
}

#[derive(Serialize)]
struct StanceReport {
    bone: String,
    span: [f64; 2],
    place: [f64; 3],
    /// At keys.
    slide: f64,
    /// Between keys.
    stray: f64,
}

#[derive(Serialize)]
struct LedReport {
    bone: String,
    miss: f64,
    at: f64,
}

impl IkReport {
    /// Of a clip.
    pub(super) fn of_clip(edited: &EditedClip, armature: &Armature, travel: Option<Vec3>) -> Self {
        let name = |bone: BoneId| armature.names()[bone.index()].clone();
        let stances = edited.stances.iter().map(|stance| StanceReport {
            bone: name(stance.bone),
            span: stance.span,
            place: stance.place.to_array(),
            slide: stance.slide,
            stray: stance.stray,
        });
        Self {
            stances: stances.collect(),
            led: led(&edited.led, armature),
            root_moved: edited.root_moved,
            travel: travel.map(|by| by.to_array()),
            beyond: Vec::new(),
        }
    }

    /// Of a rig's keys.
    pub(super) fn of_keys(edited: &EditedKeys, skeleton: &Skeleton, armature: &Armature) -> Self {
        let beyond = edited.beyond.iter().map(|limit| {
            let joint = skeleton.joints(limit.bone)[limit.angle];
            BeyondReport {
                joint: skeleton.model().joints()[joint.index()].name.clone(),
                by: limit.by,
                at: limit.at,
            }
        });
        Self {
            stances: Vec::new(),
            led: led(&edited.led, armature),
            root_moved: 0.0,
            travel: None,
            beyond: beyond.collect(),
        }
    }

    /// What it says to people.
    pub(super) fn text(&self) -> String {
        let mut lines = Vec::new();
        if !self.stances.is_empty() {
            let most =
                |off: fn(&StanceReport) -> f64| self.stances.iter().map(off).fold(0.0, f64::max);
            lines.push(format!(
                "{} stances, which slide by {:.2e} at most, {:.2e} between keys",
                self.stances.len(),
                most(|stance| stance.slide),
                most(|stance| stance.stray)
            ));
        }
        for led in &self.led {
            lines.push(format!(
                "`{}` misses by {:.2e} at most, at {:.3} s",
                led.bone, led.miss, led.at
            ));
        }
        for limit in &self.beyond {
            lines.push(format!(
                "`{}` stays up to {:.2e} rad beyond its limit, at {:.3} s",
                limit.joint, limit.by, limit.at
            ));
        }
        if let Some([x, y, z]) = self.travel {
            lines.push(format!("it travels by {x:.4}, {y:.4}, {z:.4} a second"));
        }
        lines.push(format!("the root moves by {:.2e} at most", self.root_moved));
        lines.join("\n") + "\n"
    }
}

fn led(all: &[ReachResult], armature: &Armature) -> Vec<LedReport> {
    let each = all.iter().map(|led| LedReport {
        bone: armature.names()[led.bone.index()].clone(),
        miss: led.miss,
        at: led.at,
    });
    each.collect()
}
