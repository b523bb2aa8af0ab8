//! Armatures with clips, without joint limits: the content of animation files.

use std::collections::BTreeSet;
use std::path::Path;

use kinopt::animation::{Armature, Clip, Cursor, Playback, Pose};
use kinopt::io::bvh::{self, BvhChannel, MotionCapture};
use kinopt::io::gltf::{SceneFile, ScenePosing};
use kinopt::model::UnknownName;
use kinopt::skeleton::BoneId;
use kinopt::skinning::SkinningMethod;
use kinopt::spatial::{Matrix3, Placement, Vector3};
use kinopt_bindings::problem_file::ModelSettings;

use crate::failure::Outcome;
use crate::file_access;
use crate::frame_report::FrameReport;

/// Armature with the clips of its file.
#[derive(Debug)]
pub(crate) struct AnimatedArmature {
    /// File name, as typed.
    pub(crate) file: String,
    /// "motion capture" or "scene".
    pub(crate) kind: &'static str,
    pub(crate) armature: Armature,
    pub(crate) clips: Vec<Clip>,
    /// Capture frames, for motion capture.
    pub(crate) frames: Option<CapturedFrames>,
    /// Notes of the reader.
    pub(crate) notes: Vec<String>,
    /// Bones that rotate in a skeleton of this armature.
    pub(crate) turning: BTreeSet<BoneId>,
    /// Scene file, with the same armature and clips.
    pub(crate) scene: Option<Box<SceneFile>>,
}

/// Capture frames at a constant rate.
#[derive(Debug)]
pub(crate) struct CapturedFrames {
    pub(crate) count: usize,
    /// Time between frames, in seconds.
    pub(crate) time: f64,
    /// Channels of each bone.
    pub(crate) channels: Vec<Vec<BvhChannel>>,
}

impl AnimatedArmature {
    /// True if a path has the extension of an animation file.
    pub(crate) fn is_at(path: &Path) -> bool {
        extension(path) == "bvh" || is_scene(path)
    }

    /// Reads an animation file.
    pub(crate) fn read(path: &Path) -> Outcome<Self> {
        let file = path.display().to_string();
        Ok(match extension(path).as_str() {
            "bvh" => Self::of_capture(file, bvh::read(path)?),
            _ => Self::of_scene(file, SceneFile::read_with(path, &file_access::allowed())?),
        })
    }

    /// Reads an animation file for a model: the settings may drop the rest scales of its bones.
    pub(crate) fn read_for(path: &Path, settings: &ModelSettings) -> Outcome<Self> {
        let animated = Self::read(path)?;
        Ok(match settings.without_scale {
            true => Self {
                armature: animated.armature.without_scale(),
                ..animated
            },
            false => animated,
        })
    }

    fn of_capture(file: String, capture: MotionCapture) -> Self {
        let turning = capture.turning_bones();
        Self {
            notes: capture.notes.iter().map(ToString::to_string).collect(),
            file,
            kind: "motion capture",
            armature: capture.armature,
            clips: vec![capture.clip],
            frames: Some(CapturedFrames {
                count: capture.frames,
                time: capture.frame_time,
                channels: capture.channels,
            }),
            turning,
            scene: None,
        }
    }

    fn of_scene(file: String, scene_file: SceneFile) -> Self {
        let scene = scene_file.scene();
        Self {
            notes: scene.notes.iter().map(ToString::to_string).collect(),
            file,
            kind: "scene",
            armature: scene.armature.clone(),
            clips: scene.clips.clone(),
            frames: None,
            turning: scene.turning_bones(),
            scene: Some(Box::new(scene_file)),
        }
    }

    /// Clip of a name, or the first.
    pub(crate) fn clip(&self, name: Option<&str>) -> Outcome<&Clip> {
        match name {
            Some(name) => Ok(Clip::named(&self.clips, name)?),
            None => {
                let first = self.clips.first();
                first.ok_or_else(|| failure!("{}: there is no clip", self.file))
            }
        }
    }

    /// Pose at a time of a clip, in seconds of the file.
    pub(crate) fn pose_at(&self, clip: &Clip, time: f64, playback: Playback) -> Outcome<Pose> {
        let mut pose = self.armature.rest().clone();
        clip.sample(time, playback, &mut Cursor::new(), &mut pose)?;
        Ok(pose)
    }

    /// Placements of the bones in model coordinates, by index.
    pub(crate) fn placements(&self, pose: &Pose) -> Outcome<Vec<Placement<f64>>> {
        // Initial values do not matter, only the number of bones.
        let mut model_from_bone = self.armature.rest_from_model().to_vec();
        self.armature.local_to_model(pose, &mut model_from_bone)?;
        let placements = model_from_bone.iter().map(|bone| {
            let [x, y, z] = [bone.x_axis, bone.y_axis, bone.z_axis]
                .map(|axis| Vector3::from(axis.as_dvec3().normalize_or_zero().to_array()));
            let origin = Vector3::from(bone.translation.as_dvec3().to_array());
            Placement::new(Matrix3::from_columns(x, y, z), origin)
        });
        Ok(placements.collect())
    }

    /// Placements of the named bones, or of all, in model coordinates or in the bone named `base`.
    pub(crate) fn frame_report(
        &self,
        names: &[String],
        base: Option<&str>,
        pose: &Pose,
    ) -> Outcome<FrameReport> {
        let placements = self.placements(pose)?;
        let names = match names {
            [] => self.armature.names(),
            names => names,
        };
        let report = FrameReport::new(names, base, |name| {
            let bone = self.armature.bone(name)?.index();
            let placement = placements.get(bone).copied();
            Ok((placement.unwrap_or_else(Placement::identity), None))
        });
        report.map_err(|unknown: UnknownName| unknown.into())
    }

    /// Diagonal of the box around a scene's meshes at rest, or around all bones without meshes, in the file's unit.
    pub(crate) fn size(&self) -> Outcome<f64> {
        if let Some(scene) = self.scene.as_deref() {
            let mut posing = ScenePosing::new(scene.scene(), SkinningMethod::LinearBlend)?;
            let size = posing.mesh(self.armature.rest())?.size();
            if size > 0.0 {
                return Ok(size);
            }
        }
        let placements = self.placements(self.armature.rest())?;
        let points = placements
            .iter()
            .map(|placement| placement.translation.to_array());
        let across = [0, 1, 2].map(|axis| {
            let low = points.clone().map(|p| p[axis]).reduce(f64::min);
            let high = points.clone().map(|p| p[axis]).reduce(f64::max);
            high.zip(low).map_or(0.0, |(high, low)| high - low)
        });
        Ok(Vector3::from(across).norm())
    }
}

/// Returns `true` for the file extensions of scenes. VRM files are GLB files.
pub(crate) fn is_scene(path: &Path) -> bool {
    matches!(extension(path).as_str(), "glb" | "gltf" | "vrm")
}

/// Extension of a path in lower case; empty without an extension.
pub(crate) fn extension(path: &Path) -> String {
    let extension = path.extension().and_then(|extension| extension.to_str());
    extension.unwrap_or("").to_ascii_lowercase()
}
