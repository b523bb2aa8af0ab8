//! Frame poses of a loaded model.

use kinopt::kinematics::ForwardKinematics;
use kinopt::model::{FrameId, UnknownName};
use kinopt::spatial::Placement;

use crate::frame_name::BareName;
use crate::frame_report::FrameReport;
use crate::loaded_model::LoadedModel;

impl LoadedModel {
    /// Placements of the named frames, or of all, in the world or in the frame named `base`.
    ///
    /// `q` is in radians and metres, within limits or not.
    pub(crate) fn frame_report(
        &self,
        names: &[String],
        base: Option<&str>,
        q: &[f64],
    ) -> Result<FrameReport, UnknownName> {
        let all = self.frame_names();
        let names = match names {
            [] => all,
            names => names.iter().map(String::as_str).collect(),
        };
        let placements = self.all_frames(q);
        let at = |frame: FrameId| {
            let placement = placements.get(frame.index()).copied();
            placement.unwrap_or_else(Placement::identity)
        };
        FrameReport::new(&names, base, |name| {
            let frame = self.frame(name, BareName::Tail)?;
            let ends = self.rig.as_ref().and_then(|rig| {
                let (bone, _) = rig.skeleton.bone_of_frame(frame)?;
                Some([rig.skeleton.tail(bone), rig.skeleton.tip(bone)].map(at))
            });
            Ok((at(frame), ends))
        })
    }

    /// world_from_frame of every frame of the model, by index; empty for a `q` of the wrong length, which its reader
    /// rejects.
    pub(crate) fn all_frames(&self, q: &[f64]) -> Vec<Placement<f64>> {
        let mut kinematics = ForwardKinematics::new(&self.model);
        kinematics.place(q).map(<[_]>::to_vec).unwrap_or_default()
    }
}
