//! Where a loaded model's frames stand.

use kinopt::kinematics::ForwardKinematics;
use kinopt::model::{FrameId, UnknownName};
use kinopt::spatial::Placement;

use crate::frame_name::BareName;
use crate::frame_report::{FramePlacement, FrameReport};
use crate::loaded_model::LoadedModel;

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
            (name, FramePlacement::of(&at(frame)).with_ends(ends))
        });
        Ok(FrameReport::new(report.collect()))
    }

    /// world_from_frame of every frame of the model, by index; none for a `q` of the wrong length,
    /// which the reader of `q` has ruled out.
    pub(crate) fn all_frames(&self, q: &[f64]) -> Vec<Placement<f64>> {
        let mut kinematics = ForwardKinematics::new(&self.model);
        kinematics.place(q).map(<[_]>::to_vec).unwrap_or_default()
    }
}
