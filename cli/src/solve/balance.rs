//! Tasks for the centre of mass of a whole body.

use kinopt::model::{FrameId, Masses, ModelError};
use kinopt::problem::ProblemBuilder;
use kinopt::spatial::Vector3;
use kinopt::task::{Axis, CentreOfMass, SupportPolygon, Task};
use kinopt_bindings::problem_file::BodySettings;
use kinopt_bindings::problem_file::body::{Centre, Foot};

use super::task_name::TaskName;
use crate::failure::Outcome;
use crate::frame_name::BareName;
use crate::loaded_model::LoadedModel;

/// Density of the bones of skeletons, kilograms per cubic unit; the centre of mass does not depend on it.
const DENSITY: f64 = 1000.0;

/// Index of the world axis that points up.
pub(super) fn up_axis(body: &BodySettings, loaded: &LoadedModel) -> usize {
    match body.up {
        Some(up) => up as usize,
        None if loaded.is_bare_figure() => 1,
        None => 2,
    }
}

/// Masses of a scene's bones by the volume of its meshes at rest.
fn scene_masses(loaded: &LoadedModel) -> Result<Masses, ModelError> {
    let scene = loaded.scene.as_ref().map(|scene| scene.file.scene());
    let scene = scene.ok_or_else(|| ModelError::NoVolume("no scene".into()))?;
    let rest = scene
        .armature
        .turning_skeleton("scene", &scene.turning_bones())?;
    scene.masses(&rest, DENSITY)
}

/// Tasks of the centre of mass.
#[derive(Clone, Debug)]
pub(super) struct Balance {
    masses: Masses,
    centre: Option<CentreOfMass>,
    polygon: Option<SupportPolygon>,
}

impl Balance {
    /// Tasks from the options, or `None` without options.
    ///
    /// # Errors
    /// A model without masses, or an unknown frame.
    pub(super) fn of(loaded: &LoadedModel, body: &BodySettings) -> Outcome<Option<Self>> {
        if !body.has_centre_of_mass() {
            return Ok(None);
        }
        let masses = match (&loaded.robot, &loaded.rig) {
            (Some(robot), _) => robot.masses(),
            (None, Some(_)) if loaded.scene.is_some() => scene_masses(loaded),
            (None, Some(rig)) => rig.masses(DENSITY),
            (None, None) => Masses::new(&loaded.model, []),
        };
        let masses = masses.map_err(|error| failure!("{}: {error}", loaded.file))?;
        let up = up_axis(body, loaded);
        let centre = body.center_of_mass.as_ref();
        let centre = centre.map(|centre| centre_of_mass(centre, &masses, up));
        let polygon = match body.balance.as_slice() {
            [] => None,
            feet => {
                let margin = body.balance_margin.unwrap_or(0.0);
                let mut polygon = SupportPolygon::new(&masses)
                    .with_up(Vector3::UNITS[up])
                    .with_margin(margin);
                for foot in feet {
                    let frame = loaded.frame(&foot.frame, BareName::Tip)?;
                    polygon = polygon.with_points_on(frame, contact_points(foot, loaded, frame));
                }
                Some(polygon)
            }
        };
        Ok(Some(Self {
            masses,
            centre,
            polygon,
        }))
    }

    /// Frames on which the tasks depend.
    pub(super) fn frames(&self) -> impl Iterator<Item = FrameId> + '_ {
        self.masses.points().iter().map(|point| point.frame)
    }

    /// Names of the tasks, in their order.
    pub(super) fn names(&self) -> impl Iterator<Item = TaskName> {
        let centre = self.centre.iter().map(|_| "center of mass");
        let names = centre.chain(self.polygon.iter().map(|_| "balance"));
        names.map(|name| TaskName {
            frame: name.to_owned(),
            held: false,
        })
    }

    /// Adds the tasks, each with its priority level.
    pub(super) fn add(
        &self,
        builder: &mut ProblemBuilder<'_>,
        mut levels: impl Iterator<Item = usize>,
    ) {
        let mut level = || levels.next().unwrap_or_default();
        if let Some(centre) = &self.centre {
            builder.add(
                Task::new(centre.clone())
                    .named("center of mass")
                    .at_level(level()),
            );
        }
        if let Some(polygon) = &self.polygon {
            builder.add(
                Task::new(polygon.clone())
                    .named("balance")
                    .at_level(level()),
            );
        }
    }
}

fn centre_of_mass(centre: &Centre, masses: &Masses, up: usize) -> CentreOfMass {
    let mut position = [None; 3];
    match *centre {
        Centre::At(at) => position = at,
        Centre::Above(at) => {
            let across = (0..3).filter(|&axis| axis != up);
            for (axis, value) in across.zip(at) {
                position[axis] = Some(value);
            }
        }
    }
    let task = CentreOfMass::new(masses, position.map(Option::unwrap_or_default));
    let axes = [Axis::X, Axis::Y, Axis::Z].into_iter().zip(position);
    axes.fold(task, |task, (axis, position)| match position {
        None => task.free_along(axis),
        Some(_) => task,
    })
}

/// Contact points of a foot, in its frame.
fn contact_points(foot: &Foot, loaded: &LoadedModel, frame: FrameId) -> Vec<Vector3<f64>> {
    if let Some(at) = foot.at {
        return vec![at.into()];
    }
    let sole = loaded.robot.as_ref().map(|robot| robot.sole(frame));
    sole.unwrap_or_else(|| vec![Vector3::zero()])
}
