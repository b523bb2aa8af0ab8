//! Report of inverse kinematics over a clip.

use kinopt::animation::Armature;
use kinopt::glam::Vec3;
use kinopt::motion::clip_ik::EditReport;
use kinopt::skeleton::{BoneId, Skeleton};
use serde::Serialize;

/// Foot plants, position errors and root displacement, as text and as JSON. Lengths are in the file's unit.
#[derive(Serialize)]
pub(super) struct IkReport {
    stances: Vec<StanceReport>,
    led: Vec<LedReport>,
    /// Largest displacement of the root from its motion in the clip, in the file's unit.
    root_moved: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    root_velocity: Option<[f32; 3]>,
    /// Limit violations of a rig's joints by its keys.
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
    /// Largest foot sliding at the keys.
    slide: f64,
    /// Largest drift between keys.
    stray: f64,
}

#[derive(Serialize)]
struct LedReport {
    bone: String,
    miss: f64,
    at: f64,
}

impl IkReport {
    /// Report of a clip; of the keys of a rig with its skeleton.
    pub(super) fn new(
        report: &EditReport,
        armature: &Armature,
        skeleton: Option<&Skeleton>,
        root_velocity: Option<Vec3>,
    ) -> Self {
        let name = |bone: BoneId| armature.names()[bone.index()].clone();
        let stances = report.stances.iter().map(|stance| StanceReport {
            bone: name(stance.bone),
            span: stance.span,
            place: stance.place.to_array(),
            slide: stance.slide,
            stray: stance.stray,
        });
        let led = report.led.iter().map(|result| LedReport {
            bone: name(result.bone),
            miss: result.miss,
            at: result.at,
        });
        let limits = report.beyond.iter().zip(skeleton.iter().copied().cycle());
        let beyond = limits.map(|(limit, skeleton)| {
            let joint = skeleton.joints(limit.bone)[limit.angle];
            BeyondReport {
                joint: skeleton.model().joints()[joint.index()].name.clone(),
                by: limit.by,
                at: limit.at,
            }
        });
        Self {
            stances: stances.collect(),
            led: led.collect(),
            root_moved: report.root_moved,
            root_velocity: root_velocity.map(|velocity| velocity.to_array()),
            beyond: beyond.collect(),
        }
    }

    /// Report as text lines.
    pub(super) fn text(&self) -> String {
        let mut lines = Vec::new();
        if !self.stances.is_empty() {
            let max_of = |value: fn(&StanceReport) -> f64| {
                self.stances.iter().map(value).fold(0.0, f64::max)
            };
            lines.push(format!(
                "{} foot plants: sliding at most {:.2e} at keys, {:.2e} between keys",
                self.stances.len(),
                max_of(|stance| stance.slide),
                max_of(|stance| stance.stray)
            ));
        }
        for result in &self.led {
            lines.push(format!(
                "`{}`: largest position error {:.2e}, at {:.3} s",
                result.bone, result.miss, result.at
            ));
        }
        for limit in &self.beyond {
            lines.push(format!(
                "`{}`: up to {:.2e} rad beyond its limit, at {:.3} s",
                limit.joint, limit.by, limit.at
            ));
        }
        if let Some([x, y, z]) = self.root_velocity {
            lines.push(format!("root velocity {x:.4}, {y:.4}, {z:.4} per second"));
        }
        lines.push(format!("largest root displacement {:.2e}", self.root_moved));
        lines.join("\n") + "\n"
    }
}
