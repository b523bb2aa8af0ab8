//! Output file of a retargeted movement. The file appears once it is complete.

use std::fmt::Write;
use std::path::Path;

use clap::ValueEnum;
use kinopt::animation::Armature;
use kinopt::io::bvh::{self, BvhFormat};
use kinopt::io::gltf::{self, Scene, WriteOptions};
use kinopt::motion::Trajectory;
use kinopt::motion::retarget::{FigureTarget, RetargetReport, UpAxis};
use kinopt::skeleton::Skeleton;
use kinopt::spatial::{Placement, Vector3};
use serde::Serialize;

use super::target::{BASE, Target};
use crate::animated_armature::extension;
use crate::failure::Outcome;
use crate::mesh_output::Skin;
use crate::numpy_file::{self, Column};
use crate::output;
use crate::scene_output;

/// Output format, by the file extension.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "lowercase")]
pub(super) enum Format {
    Npz,
    Json,
    Csv,
    Bvh,
    Glb,
}

/// Number of influences per vertex that all glTF readers support.
const INFLUENCES: usize = 4;

impl Format {
    /// Format of a file, by its extension.
    pub(super) fn of(path: &Path) -> Outcome<Self> {
        let known = Self::from_str(&extension(path), true);
        known.map_err(|_| {
            usage!(
                "--out {}: unsupported extension; expected .npz, .json, .csv, .bvh or .glb",
                path.display()
            )
        })
    }

    /// File extension without the dot.
    pub(super) fn ending(self) -> String {
        self.to_possible_value()
            .map_or_else(String::new, |value| value.get_name().to_owned())
    }

    /// Returns an error if the target cannot be written in this format.
    pub(super) fn check(self, target: &Target) -> Outcome<()> {
        let figure = target.skeleton().is_some();
        match matches!(self, Self::Bvh | Self::Glb) && !figure {
            true => Err(usage!(
                "{}: .bvh and .glb require a figure; use .npz, .json or .csv for a robot",
                target.loaded.file
            )),
            false => Ok(()),
        }
    }

    /// Writes a movement. The file appears once it is complete.
    pub(super) fn write(
        self,
        target: &Target,
        retargeted: &Trajectory<RetargetReport>,
        name: &str,
        header: bool,
        to: &Path,
    ) -> Outcome<()> {
        let names = target.names();
        let bytes = match self {
            Self::Npz => as_npz(retargeted, &names)?,
            Self::Json => serde_json::to_vec(&document(retargeted, &names))?,
            Self::Csv if header => as_table(retargeted, &names).into_bytes(),
            Self::Csv => as_rows(retargeted, target.is_free()).into_bytes(),
            Self::Bvh | Self::Glb => return self.write_figure(target, retargeted, name, to),
        };
        output::write_file(to, bytes)
    }

    fn write_figure(
        self,
        target: &Target,
        retargeted: &Trajectory<RetargetReport>,
        name: &str,
        to: &Path,
    ) -> Outcome<()> {
        let loaded = &target.loaded;
        let (Some(figure), Some(skeleton)) = (&target.figure, target.skeleton()) else {
            return Err(failure!("{}: the target is not a figure", loaded.file));
        };
        if self == Self::Bvh {
            let format = BvhFormat::from(retargeted.report.frame_rate);
            return match (&loaded.scene, &loaded.capture) {
                (Some(scene), _) => {
                    write_bvh(figure, &scene.file.scene().armature, retargeted, format, to)
                }
                (None, Some(capture)) => {
                    let format = format.with_channels(&capture.channels);
                    write_bvh(figure, &capture.armature, retargeted, format, to)
                }
                _ => write_rig_as_bvh(skeleton, figure.up(), retargeted, to),
            };
        }
        if let Some(scene) = &loaded.scene {
            let file = scene.file.clone();
            let clip = figure.clip(
                name,
                &file.scene().armature,
                &retargeted.q,
                retargeted.report.frame_rate,
            )?;
            let other = format!("{name} retargeted");
            scene_output::write_with_clip(file, clip, None, &other, to)?;
            return Ok(());
        }
        let mut scene = match loaded.skin(None) {
            Ok(Skin::Rig { mesh, weights, .. }) => {
                let (weights, _) = weights.pruned(INFLUENCES)?;
                Scene::of_skeleton(skeleton, Some((mesh, &weights)))?
            }
            _ => Scene::of_skeleton(skeleton, None)?,
        };
        let clip = figure.clip(
            name,
            &scene.armature,
            &retargeted.q,
            retargeted.report.frame_rate,
        )?;
        scene.clips.push(clip);
        let mut options = WriteOptions::default();
        options.up = figure.up().into();
        Ok(gltf::write(&scene, &options, to)?)
    }
}

/// Writes a rig with y up, as readers of BVH files expect.
fn write_rig_as_bvh(
    skeleton: &Skeleton,
    up: UpAxis,
    retargeted: &Trajectory<RetargetReport>,
    to: &Path,
) -> Outcome<()> {
    let y_from_z = UpAxis::Y.turned_to_z().transpose();
    let turn = Placement::new(y_from_z * up.turned_to_z(), Vector3::zero());
    let upright = skeleton.placed(turn)?;
    let figure = FigureTarget::new(&upright, UpAxis::Y)?;
    let armature = Armature::of_skeleton(&upright);
    write_bvh(
        &figure,
        &armature,
        retargeted,
        retargeted.report.frame_rate.into(),
        to,
    )
}

fn write_bvh(
    figure: &FigureTarget,
    armature: &Armature,
    retargeted: &Trajectory<RetargetReport>,
    format: BvhFormat<'_>,
    to: &Path,
) -> Outcome<()> {
    let poses = figure.poses(armature, armature.rest(), &retargeted.q)?;
    Ok(bvh::write_poses(armature, &poses, format, to)?)
}

fn as_npz(retargeted: &Trajectory<RetargetReport>, names: &[String]) -> Outcome<Vec<u8>> {
    let (frames, width) = (retargeted.rows().len(), names.len());
    let contact_count = retargeted.report.contact_frames.len();
    numpy_file::npz(&[
        ("q", &[frames, width], Column::Numbers(&retargeted.q)),
        ("fps", &[], Column::Numbers(&[retargeted.report.frame_rate])),
        ("names", &[width], Column::Words(names)),
        (
            "contacts",
            &[frames, contact_count],
            Column::Flags(&retargeted.report.contacts),
        ),
        (
            "contact_frames",
            &[contact_count],
            Column::Words(&retargeted.report.contact_frames),
        ),
        (
            "contact_points",
            &[contact_count, 3],
            Column::Numbers(contact_points(retargeted).as_flattened()),
        ),
    ])
}

/// Content of a .json file.
#[derive(Serialize)]
struct Document<'a> {
    fps: f64,
    names: &'a [String],
    contact_frames: &'a [String],
    /// Contact points in the coordinates of their frames, metres.
    contact_points: Vec<[f64; 3]>,
    q: Vec<&'a [f64]>,
    contacts: Vec<&'a [bool]>,
}

fn document<'a>(retargeted: &'a Trajectory<RetargetReport>, names: &'a [String]) -> Document<'a> {
    Document {
        fps: retargeted.report.frame_rate,
        names,
        contact_frames: &retargeted.report.contact_frames,
        contact_points: contact_points(retargeted),
        q: retargeted.rows().collect(),
        contacts: contacts(retargeted).collect(),
    }
}

/// Contact points, each in the coordinates of its frame, metres.
fn contact_points(retargeted: &Trajectory<RetargetReport>) -> Vec<[f64; 3]> {
    retargeted
        .report
        .contact_points
        .iter()
        .map(|at| at.to_array())
        .collect()
}

/// Contact flags, frame by frame.
fn contacts(retargeted: &Trajectory<RetargetReport>) -> impl Iterator<Item = &[bool]> {
    let width = retargeted.report.contact_frames.len();
    (0..retargeted.rows().len()).map(move |frame| {
        retargeted
            .report
            .contacts
            .get(frame * width..(frame + 1) * width)
            .unwrap_or_default()
    })
}

/// Rows of configurations without a header. The base's quaternion is x, y, z, w, as in Unitree's retargeted LAFAN1.
fn as_rows(retargeted: &Trajectory<RetargetReport>, is_free: bool) -> String {
    let mut text = String::new();
    for q in retargeted.rows() {
        let mut row = q.to_vec();
        if is_free {
            row[3..BASE].rotate_left(1);
        }
        let row: Vec<String> = row.iter().map(ToString::to_string).collect();
        text += &row.join(",");
        text.push('\n');
    }
    text
}

/// Header row, then one row per frame: time in seconds, configuration, and contact flags (1 in contact).
fn as_table(retargeted: &Trajectory<RetargetReport>, names: &[String]) -> String {
    let contact_columns = retargeted
        .report
        .contact_frames
        .iter()
        .map(|frame| format!("{frame} in contact"));
    let columns = std::iter::once("time".to_owned())
        .chain(names.iter().cloned())
        .chain(contact_columns);
    let mut text = columns.collect::<Vec<_>>().join(",") + "\n";
    let rows = retargeted.times.iter().zip(retargeted.rows());
    for ((time, q), in_contact) in rows.zip(contacts(retargeted)) {
        let _ = write!(text, "{time}");
        for number in q {
            let _ = write!(text, ",{number}");
        }
        for in_contact in in_contact {
            let _ = write!(text, ",{}", u8::from(*in_contact));
        }
        text.push('\n');
    }
    text
}
