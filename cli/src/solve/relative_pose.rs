//! A frame should stand at a placement in another frame that moves too.

use kinopt::Scalar;
use kinopt::model::FrameId;
use kinopt::spatial::{Matrix3, Placement, Vector3, rotation_log};
use kinopt::task::{Quantity, Residual, Rows};

/// Three rows in metres and, where the orientation counts, three in radians, all in the base's
/// axes: x − x_target, and the rotation vector of R R_targetᵀ.
#[derive(Clone, Copy, Debug)]
pub(super) struct RelativePose {
    pub(super) base: FrameId,
    pub(super) tip: FrameId,
    pub(super) base_from_target: Placement<f64>,
    pub(super) turns: bool,
}

impl Residual for RelativePose {
    fn kind(&self) -> &'static str {
        "relative pose"
    }

    fn frames(&self) -> Vec<FrameId> {
        vec![self.base, self.tip]
    }

    fn rows(&self) -> Vec<Rows> {
        let mut rows = vec![Rows::new(Quantity::Metres, 3)];
        if self.turns {
            rows.push(Rows::new(Quantity::Radians, 3));
        }
        rows
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], _joints: &[S], residual: &mut [S]) {
        let [world_from_base, world_from_tip] = frames else {
            return;
        };
        let base_from_tip = world_from_base.inverse() * *world_from_tip;
        let target = &self.base_from_target;
        let miss = base_from_tip.translation - Vector3::constant(target.translation);
        let turn = if self.turns {
            let back = Matrix3::constant(target.rotation.transpose());
            rotation_log(&(base_from_tip.rotation * back)).to_array()
        } else {
            [S::zero(); 3]
        };
        let rows = miss.to_array().into_iter().chain(turn);
        for (row, value) in residual.iter_mut().zip(rows) {
            *row = value;
        }
    }
}
