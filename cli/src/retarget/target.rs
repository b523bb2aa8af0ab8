//! Targets of retargeting: a robot, or a skeleton on a free base.

use std::path::Path;

use kinopt::motion::retarget::{FigureTarget, HumanBones, UpAxis};
use kinopt::robot::Robot;
use kinopt::skeleton::Skeleton;
use kinopt_bindings::problem_file::ModelSettings;

use super::source::Up;
use crate::animated_armature::AnimatedArmature;
use crate::failure::Outcome;
use crate::loaded_model::LoadedModel;
use crate::output;

/// Robot, or figure on a free base.
#[derive(Debug)]
pub(super) struct Target {
    pub(super) loaded: LoadedModel,
    /// Robot that receives the movement.
    pub(super) robot: Robot,
    /// Conversion of configurations to a figure's poses.
    pub(super) figure: Option<FigureTarget>,
}

impl Target {
    /// Reads a robot with its model options, or a figure on a free base.
    pub(super) fn read(path: &Path, up: Option<Up>, settings: &ModelSettings) -> Outcome<Self> {
        let animated = AnimatedArmature::is_at(path);
        let figure = animated
            || path
                .extension()
                .is_some_and(|extension| extension == "json");
        if !figure {
            if up.is_some() {
                return Err(usage!(
                    "{}: --target-up applies to figures; the up axis of a robot is z",
                    path.display()
                ));
            }
            let loaded = LoadedModel::read(path, settings)?;
            let lacks = || usage!("{}: the file is not a robot", loaded.file);
            let robot = Robot::clone(loaded.robot.as_ref().ok_or_else(lacks)?);
            if settings.base_joint.is_none() && !robot.moves_as_a_whole() {
                output::message(&format!(
                    "note: {}: the root is fixed; --base-joint free lets it follow the subject",
                    loaded.file
                ));
            }
            return Ok(Self {
                loaded,
                robot,
                figure: None,
            });
        }
        if settings.makes_figure() {
            return Err(usage!(
                "{}: retargeting of figures uses Euler angles; omit `joints` and `cones`",
                path.display()
            ));
        }
        let settings = ModelSettings {
            without_scale: settings.without_scale,
            ..ModelSettings::default()
        };
        let mut loaded = LoadedModel::read(path, &settings)?;
        let lacks = || failure!("{}: the file has no bones", loaded.file);
        let rig = loaded.rig.as_ref().ok_or_else(lacks)?;
        let usual_up = if animated { UpAxis::Y } else { UpAxis::Z };
        let detected_up = || FigureTarget::up_axis(&rig.skeleton);
        let up = up.map(UpAxis::from).or_else(detected_up);
        let figure = FigureTarget::new(&rig.skeleton, up.unwrap_or(usual_up))?;
        let robot = figure.robot().clone();
        loaded.model = robot.model().clone();
        Ok(Self {
            loaded,
            robot,
            figure: Some(figure),
        })
    }

    /// Reports a figure whose body is not along the up axis.
    pub(super) fn report_up_axis(&self, along: Option<UpAxis>) {
        let Some(figure) = self.figure.as_ref().filter(|_| along == Some(UpAxis::Y)) else {
            return;
        };
        // The upright rotation maps z to y.
        let (up, along) = match figure.up() {
            UpAxis::Y => ("y", "z"),
            UpAxis::Z => ("z", "y"),
        };
        output::message(&format!(
            "note: {}: the figure is upright along {along}, but the up axis is {up}: --target-up {along} changes it",
            self.loaded.file
        ));
    }

    /// Table of the human bones of a VRM character; empty for other targets.
    pub(super) fn human_bones(&self) -> HumanBones {
        let scene = self.loaded.scene.as_ref();
        scene
            .map(|scene| scene.file.human_bones())
            .unwrap_or_default()
    }

    /// Skeleton of a figure.
    pub(super) fn skeleton(&self) -> Option<&Skeleton> {
        self.loaded.rig.as_ref().map(|rig| &rig.skeleton)
    }

    /// Names of the configuration values.
    pub(super) fn names(&self) -> Vec<String> {
        self.loaded.coordinate_names()
    }

    /// Returns `true` if the configuration begins with a free base.
    pub(super) fn is_free(&self) -> bool {
        let root = self.robot.free_root();
        root.is_some_and(|joint| self.robot.model().coordinate(joint) == Some(0))
    }
}
