//! Serialised form of sphere models.

use serde::{Deserialize, Serialize};

use super::{SphereGroup, SphereModel};
use crate::collision::Ball;
use kinopt_kinematics::bad_option::{BadOption, NOT_NEGATIVE, POSITIVE};
use kinopt_kinematics::model::FrameId;
use kinopt_kinematics::spatial::Vector3;

/// Serialised sphere model.
#[derive(Serialize, Deserialize)]
pub(super) struct SphereModelDocument {
    groups: Vec<GroupDocument>,
    pairs: Vec<[usize; 2]>,
    max_protrusion: f64,
    #[serde(default)]
    notes: Vec<String>,
}

#[derive(Serialize, Deserialize)]
struct GroupDocument {
    link: FrameId,
    name: String,
    /// x, y, z and radius, metres.
    spheres: Vec<[f64; 4]>,
    #[serde(default)]
    gap: f64,
}

impl From<SphereModel> for SphereModelDocument {
    fn from(model: SphereModel) -> Self {
        let numbers = |Ball { centre, radius }: &Ball| [centre.x, centre.y, centre.z, *radius];
        let group = |group: SphereGroup| GroupDocument {
            link: group.link,
            gap: group.gap,
            spheres: group.spheres.iter().map(numbers).collect(),
            name: group.name,
        };
        Self {
            groups: model.groups.into_iter().map(group).collect(),
            pairs: model.pairs,
            max_protrusion: model.max_protrusion,
            notes: model.notes,
        }
    }
}

impl TryFrom<SphereModelDocument> for SphereModel {
    type Error = BadOption;

    fn try_from(parts: SphereModelDocument) -> Result<Self, BadOption> {
        BadOption::check("max_protrusion", parts.max_protrusion, NOT_NEGATIVE)?;
        let ball = |[x, y, z, radius]: [f64; 4]| {
            BadOption::check("radius of a sphere", radius, POSITIVE)?;
            let centre = Vector3::new(x, y, z);
            Ok(Ball { centre, radius })
        };
        let group = |group: GroupDocument| {
            let spheres = group.spheres.into_iter().map(ball);
            let spheres = spheres.collect::<Result<_, BadOption>>()?;
            BadOption::check("gap", group.gap, NOT_NEGATIVE)?;
            Ok(SphereGroup::new(group.link, &group.name, spheres).with_gap(group.gap))
        };
        let groups = parts.groups.into_iter().map(group);
        let groups: Vec<_> = groups.collect::<Result<_, BadOption>>()?;
        for index in parts.pairs.iter().flatten() {
            let never: fn(f64) -> bool = |index| index < 0.0;
            if *index >= groups.len() {
                BadOption::check(
                    "group of a pair",
                    *index as f64,
                    (never, "one of the groups"),
                )?;
            }
        }
        Ok(Self {
            groups,
            pairs: parts.pairs,
            max_protrusion: parts.max_protrusion,
            notes: parts.notes,
        })
    }
}
