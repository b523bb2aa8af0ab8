//! A model as serde writes it. One that is read is built and checked anew.

use super::{Frame, Joint, JointId, LengthUnit, Model, ModelError};

/// How far what is built may be from what was written for that to count as the same number.
const ROUNDING: f64 = 1e-14;

#[derive(serde::Serialize, serde::Deserialize)]
pub(super) struct Parts {
    name: String,
    length_unit: LengthUnit,
    joints: Vec<Joint>,
    frames: Vec<Frame>,
    configuration_order: Vec<JointId>,
}

impl From<Model> for Parts {
    fn from(model: Model) -> Self {
        Self {
            name: model.name,
            length_unit: model.length_unit,
            joints: model.joints,
            frames: model.frames,
            configuration_order: model.moving,
        }
    }
}

impl TryFrom<Parts> for Model {
    type Error = ModelError;

    fn try_from(parts: Parts) -> Result<Self, ModelError> {
        let mut builder = Self::builder(parts.name);
        builder.length_unit(parts.length_unit);
        let axes: Vec<_> = parts.joints.iter().map(|joint| joint.axis).collect();
        for joint in parts.joints {
            builder.joint(joint);
        }
        for frame in parts.frames {
            builder.frame(frame.name, frame.joint, frame.joint_from_frame);
        }
        builder.configuration_order(parts.configuration_order);
        let mut model = builder.build()?;
        // An axis of unit length keeps its bits, which normalising it once more need not.
        for (joint, written) in model.joints.iter_mut().zip(axes) {
            if (joint.axis - written).norm() <= ROUNDING {
                joint.axis = written;
            }
        }
        Ok(model)
    }
}
