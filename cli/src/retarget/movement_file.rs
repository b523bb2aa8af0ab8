//! Output file of a retargeted movement.

use std::path::Path;

use kinopt::motion::Trajectory;
use kinopt::motion::retarget::RetargetReport;
use kinopt_bindings::motion_file::write_robot_glb;
use kinopt_bindings::trajectory_file::{
    Contacts, EXTENSIONS, FigureFile, TableLayout, TrajectoryFormat, TrajectoryTable, write_figure,
};

use super::target::Target;
use crate::failure::Outcome;
use crate::mesh_output::Skin;

/// Format of a file, by its extension.
pub(super) fn format_of(path: &Path) -> Outcome<TrajectoryFormat> {
    TrajectoryFormat::of(path).ok_or_else(|| {
        usage!(
            "--out {}: unsupported extension; expected .npz, .json, .csv, .bvh or .glb",
            path.display()
        )
    })
}

/// Value of `--format`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FormatChoice {
    /// Format of the files of a folder.
    Files(TrajectoryFormat),
    /// MuJoCo's `qpos`, in .csv or .npz files.
    Qpos,
}

impl FormatChoice {
    /// Parses `--format`.
    pub(super) fn parse(name: &str) -> Result<Self, String> {
        if name == "qpos" {
            return Ok(Self::Qpos);
        }
        let file = Path::new("file").with_extension(name);
        let format = TrajectoryFormat::of(&file).map(Self::Files);
        format.ok_or_else(|| "expected npz, json, csv, bvh, glb or qpos".to_owned())
    }

    /// Format of the files of a folder.
    pub(super) fn of_files(self) -> TrajectoryFormat {
        match self {
            Self::Files(format) => format,
            Self::Qpos => TrajectoryFormat::Npz,
        }
    }
}

/// File extension of a format, without the dot.
pub(super) fn extension_of(format: TrajectoryFormat) -> &'static str {
    let known = EXTENSIONS.iter().find(|(_, known)| *known == format);
    known.map_or("", |(name, _)| name)
}

/// Returns an error if the target cannot be written in a format.
pub(super) fn check(format: TrajectoryFormat, target: &Target) -> Outcome<()> {
    match format == TrajectoryFormat::Bvh && target.skeleton().is_none() {
        true => Err(usage!(
            "{}: .bvh requires a figure; use .npz, .json, .csv or .glb for a robot",
            target.loaded.file
        )),
        false => Ok(()),
    }
}

/// Writes a movement. The file appears once it is complete.
pub(super) fn write(
    format: TrajectoryFormat,
    target: &Target,
    retargeted: &Trajectory<RetargetReport>,
    name: &str,
    (header, layout): (bool, TableLayout),
    to: &Path,
) -> Outcome<()> {
    let (report, loaded) = (&retargeted.report, &target.loaded);
    let figure = target.figure.as_ref().zip(target.skeleton());
    if let Some((figure, skeleton)) = figure.filter(|_| format.has_bones()) {
        let skin = match (format, &loaded.scene, &loaded.capture) {
            (TrajectoryFormat::Glb, None, None) => loaded.skin(None).ok(),
            _ => None,
        };
        let file = match (&loaded.scene, &loaded.capture) {
            (Some(scene), _) => FigureFile::SceneFile(&scene.file),
            (None, Some(capture)) => FigureFile::Capture {
                armature: &capture.armature,
                channels: &capture.channels,
                skeleton,
            },
            (None, None) => FigureFile::Skeleton {
                skeleton,
                skin: match &skin {
                    Some(Skin::Rig { mesh, weights, .. }) => Some((mesh, weights)),
                    _ => None,
                },
            },
        };
        let motion = (&*retargeted.q, report.frame_rate);
        return Ok(write_figure(figure, file, motion, name, (format, to))?);
    }
    if format == TrajectoryFormat::Glb {
        let motion = (&*retargeted.q, report.frame_rate);
        return Ok(write_robot_glb(&target.robot, motion, name, to)?);
    }
    let contacts = Contacts {
        frame_rate: report.frame_rate,
        frames: report.contact_frames.clone(),
        points: (report.contact_points.iter().map(|at| at.to_array())).collect(),
        flags: report.contacts.clone(),
    };
    let table = TrajectoryTable {
        names: &target.names(),
        times: &retargeted.times,
        q: &retargeted.q,
        contacts: Some(&contacts),
        is_free: target.is_free(),
        layout,
    };
    Ok(table.write(format, header, to)?)
}
