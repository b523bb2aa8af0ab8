//! Output file of a retargeted movement.

use std::path::Path;

use kinopt::motion::Trajectory;
use kinopt::motion::retarget::RetargetReport;
use kinopt_bindings::trajectory_file::{
    Contacts, EXTENSIONS, FigureFile, TrajectoryFormat, TrajectoryTable, write_figure,
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

/// Parses `--format`.
pub(super) fn parse_format(name: &str) -> Result<TrajectoryFormat, String> {
    let file = Path::new("file").with_extension(name);
    TrajectoryFormat::of(&file).ok_or_else(|| "expected npz, json, csv, bvh or glb".to_owned())
}

/// File extension of a format, without the dot.
pub(super) fn extension_of(format: TrajectoryFormat) -> &'static str {
    let known = EXTENSIONS.iter().find(|(_, known)| *known == format);
    known.map_or("", |(name, _)| name)
}

/// Returns an error if the target cannot be written in a format.
pub(super) fn check(format: TrajectoryFormat, target: &Target) -> Outcome<()> {
    match format.needs_figure() && target.skeleton().is_none() {
        true => Err(usage!(
            "{}: .bvh and .glb require a figure; use .npz, .json or .csv for a robot",
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
    (name, header): (&str, bool),
    to: &Path,
) -> Outcome<()> {
    let (report, loaded) = (&retargeted.report, &target.loaded);
    let figure = target.figure.as_ref().zip(target.skeleton());
    if let Some((figure, skeleton)) = figure.filter(|_| format.needs_figure()) {
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
    };
    Ok(table.write(format, header, to)?)
}
