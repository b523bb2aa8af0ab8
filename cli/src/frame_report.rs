//! Where frames stand, for people and for programs.

use kinopt::kinematics::ForwardKinematics;
use kinopt::model::{FrameId, UnknownName};
use kinopt::spatial::{Placement, Quaternion};
use serde::{Serialize, Serializer};

use crate::frame_name::BareName;
use crate::loaded_model::LoadedModel;
use crate::number_format::{LengthFormat, six_digits};
use crate::table::{Align, Table};

/// One frame's placement in the world, or in another frame.
#[derive(Debug, Serialize)]
pub(crate) struct FramePlacement {
    position: [f64; 3],
    /// w, x, y, z with w ≥ 0.
    quaternion: [f64; 4],
    /// The bone's ends, for a rig.
    #[serde(skip_serializing_if = "Option::is_none")]
    tail: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    tip: Option<[f64; 3]>,
}

/// Frames by name, in the order asked for.
#[derive(Debug)]
pub(crate) struct FrameReport(Vec<(String, FramePlacement)>);

impl Serialize for FrameReport {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, placement)| (name, placement)))
    }
}

impl LoadedModel {
    /// Places the named frames, or all of them, for `q` (radians and metres, within limits or not),
    /// in the world or in the frame named `base`.
    pub(crate) fn frame_report(
        &self,
        names: &[String],
        base: Option<&str>,
        q: &[f64],
    ) -> Result<FrameReport, UnknownName> {
        let names = match (&self.rig, names) {
            (Some(rig), []) => rig
                .skeleton
                .bones()
                .iter()
                .map(|b| b.name.clone())
                .collect(),
            (None, []) => self.model.frames().iter().map(|f| f.name.clone()).collect(),
            (_, names) => names.to_vec(),
        };
        let wanted = names
            .into_iter()
            .map(|name| Ok((self.frame(&name, BareName::Tail)?, name)))
            .collect::<Result<Vec<_>, UnknownName>>()?;
        let base = base
            .map(|name| self.frame(name, BareName::Tail))
            .transpose()?;
        let placements = self.all_frames(q);
        let world_from_base = base.and_then(|base| placements.get(base.index()));
        let base_from_world = world_from_base.map(|placement| placement.inverse());
        let at = |frame: FrameId| {
            let placement = placements.get(frame.index());
            let placement = placement.copied().unwrap_or_else(Placement::identity);
            match base_from_world {
                Some(base_from_world) => base_from_world * placement,
                None => placement,
            }
        };
        let report = wanted.into_iter().map(|(frame, name)| {
            let ends = self.rig.as_ref().and_then(|rig| {
                let (bone, _) = rig.skeleton.bone_of_frame(frame)?;
                Some([rig.skeleton.tail(bone), rig.skeleton.tip(bone)])
            });
            let ends = ends.map(|ends| ends.map(|end| at(end).translation.to_array()));
            let placed = FramePlacement {
                tail: ends.map(|[tail, _]| tail),
                tip: ends.map(|[_, tip]| tip),
                ..FramePlacement::of(&at(frame))
            };
            (name, placed)
        });
        Ok(FrameReport(report.collect()))
    }

    /// world_from_frame of every frame of the model, by index; none for a `q` of the wrong length,
    /// which the reader of `q` has ruled out.
    pub(crate) fn all_frames(&self, q: &[f64]) -> Vec<Placement<f64>> {
        let mut kinematics = ForwardKinematics::new(&self.model);
        kinematics.place(q).map(<[_]>::to_vec).unwrap_or_default()
    }
}

/// Of the two quaternions of a rotation the one with w ≥ 0.
fn quaternion(placement: &Placement<f64>) -> [f64; 4] {
    let Quaternion { w, v } = Quaternion::from_matrix(&placement.rotation);
    let quaternion = [w, v.x, v.y, v.z];
    // Adding zero turns −0 into 0.
    quaternion.map(|c| if w < 0.0 { -c + 0.0 } else { c + 0.0 })
}

impl FramePlacement {
    fn of(placement: &Placement<f64>) -> Self {
        Self {
            position: placement.translation.to_array(),
            quaternion: quaternion(placement),
            tail: None,
            tip: None,
        }
    }
}

impl FrameReport {
    /// Frames without ends.
    pub(crate) fn of_placements(frames: Vec<(String, Placement<f64>)>) -> Self {
        let frames = frames.into_iter();
        let placed = frames.map(|(name, placement)| (name, FramePlacement::of(&placement)));
        Self(placed.collect())
    }

    /// An aligned table.
    pub(crate) fn text(&self, format: LengthFormat) -> String {
        let rigs = self.0.iter().any(|(_, placement)| placement.tip.is_some());
        let [x, y, z] = [
            ("x", Align::Right),
            ("y", Align::Right),
            ("z", Align::Right),
        ];
        let rest = ["qw", "qx", "qy", "qz"].map(|name| (name, Align::Right));
        let tip = ["tip x", "tip y", "tip z"].map(|name| (name, Align::Right));
        let [qw, qx, qy, qz] = rest;
        let [tip_x, tip_y, tip_z] = tip;
        let frame = ("frame", Align::Left);
        let mut table = if rigs {
            Table::new([frame, x, y, z, qw, qx, qy, qz, tip_x, tip_y, tip_z])
        } else {
            Table::new([frame, x, y, z, qw, qx, qy, qz])
        };
        for (name, placement) in &self.0 {
            let [x, y, z] = format.vector(placement.position);
            let [qw, qx, qy, qz] = placement.quaternion.map(six_digits);
            let name = name.clone();
            match placement.tip {
                Some(tip) => {
                    let [tip_x, tip_y, tip_z] = format.vector(tip);
                    table.row([name, x, y, z, qw, qx, qy, qz, tip_x, tip_y, tip_z]);
                }
                None => table.row([name, x, y, z, qw, qx, qy, qz]),
            }
        }
        table.text()
    }
}
