//! Conversion of the file's numbers to checked types; errors contain the JSON path.

use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsStr;
use std::path::Path;

use super::degrees::{self, UNBOUNDED};
use super::json::{BoneEntry, BoneIndices, RigFile};
use super::{interpolation, names};
use crate::animation::{ClipError, EulerClip, EulerKey, EulerTrack};
use crate::io::{FileLocation, ReadError};
use kinopt_kinematics::model::ModelError;
use kinopt_kinematics::skeleton::{Bone, BoneId, Skeleton};
use kinopt_kinematics::spatial::{Matrix3, Placement, Vector3};

/// Largest deviation of `rest_T` from a rigid motion, per entry. Files with seven digits pass.
const RIGID_TOLERANCE: f64 = 1e-6;

pub(super) fn error_at(
    name: &str,
    path: impl Into<String>,
    problem: impl Into<String>,
) -> ReadError {
    ReadError::malformed(name, FileLocation::Json(path.into()), problem)
}

pub(super) fn skeleton(file: &RigFile, name: &str) -> Result<Skeleton, ReadError> {
    if file.bones.is_empty() {
        return Err(error_at(name, "bones", "there are no bones"));
    }
    let mut bones = Vec::with_capacity(file.bones.len());
    for (index, entry) in file.bones.iter().enumerate() {
        let fail = |(key, problem): (String, String)| {
            error_at(name, format!("bones[{index}].{key}"), problem)
        };
        bones.push(bone(index, entry).map_err(fail)?);
    }
    let second_path = |repeated: &str| {
        let named = file.bones.iter().enumerate();
        let mut same = named.filter(|(_, bone)| bone.name.as_deref() == Some(repeated));
        same.nth(1).map(|(index, _)| format!("bones[{index}].name"))
    };
    // The skeleton has the name of the file without its folder.
    let stem = Path::new(name).file_stem().and_then(OsStr::to_str);
    Skeleton::new(stem.unwrap_or(name), bones).map_err(|error| {
        let path = match &error {
            ModelError::DuplicateName { kind: "bone", name } => second_path(name),
            _ => None,
        };
        let path = path.unwrap_or_else(|| "bones".into());
        error_at(name, path, error.to_string())
    })
}

/// A bone, or the faulty key and its problem.
fn bone(index: usize, entry: &BoneEntry) -> Result<Bone, (String, String)> {
    let fail = |key: &str, problem: String| Err((key.to_owned(), problem));
    let parent = match usize::try_from(entry.parent_id) {
        Ok(parent) if parent < index => Some(BoneId::new(parent)),
        _ if entry.parent_id == -1 => None,
        _ => {
            let problem = format!(
                "{} is neither -1 nor one of the bones before this one; parents come first, which \
                 also rules cycles out",
                entry.parent_id
            );
            return fail("parent_id", problem);
        }
    };
    if !(entry.length >= 0.0 && entry.length.is_finite()) {
        let problem = format!("{} is not a finite length of at least 0", entry.length);
        return fail("length", problem);
    }
    let min = triple("xzx_min", entry.xzx_min.as_deref(), f64::NEG_INFINITY)?;
    let max = triple("xzx_max", entry.xzx_max.as_deref(), f64::INFINITY)?;
    for (angle, (min, max)) in min.iter().zip(&max).enumerate() {
        if min > max {
            let problem = format!("{min} degrees is more than xzx_max[{angle}], {max}");
            return fail(&format!("xzx_min[{angle}]"), problem);
        }
        let (key, end) = match (min, max) {
            (min, _) if *min >= UNBOUNDED => ("xzx_min", min),
            (_, max) if *max <= -UNBOUNDED => ("xzx_max", max),
            _ => continue,
        };
        let problem = format!("{end} degrees is outside ±{UNBOUNDED:e}, which is no limit");
        return fail(&format!("{key}[{angle}]"), problem);
    }
    let name = entry.name.clone();
    let name = name.unwrap_or_else(|| names::default_name(index));
    if let Some(problem) = names::problem(&name, index) {
        return fail("name", problem);
    }
    let ([a, b, c], [d, e, f]) = (min, max);
    Ok(Bone {
        name,
        parent,
        length: entry.length,
        model_from_rest: rest(&entry.rest)?,
        limits: [(a, d), (b, e), (c, f)].map(|(min, max)| degrees::limits(min, max)),
    })
}

fn triple(key: &str, values: Option<&[f64]>, absent: f64) -> Result<[f64; 3], (String, String)> {
    let Some(values) = values else {
        return Ok([absent; 3]);
    };
    values.try_into().map_err(|_| {
        let problem = format!("has {} numbers instead of 3", values.len());
        (key.to_owned(), problem)
    })
}

fn rest(rows: &[Vec<f64>]) -> Result<Placement<f64>, (String, String)> {
    let fail = |key: &str, problem: String| Err((key.to_owned(), problem));
    let [x, y, z, last] = rows else {
        return fail("rest_T", format!("has {} rows instead of 4", rows.len()));
    };
    let mut matrix = [[0.0; 4]; 4];
    for (row, (entries, values)) in matrix.iter_mut().zip([x, y, z, last]).enumerate() {
        *entries = values.as_slice().try_into().map_err(|_| {
            let problem = format!("has {} numbers instead of 4", values.len());
            (format!("rest_T[{row}]"), problem)
        })?;
    }
    let [x, y, z, last] = matrix;
    let mut errors = last
        .iter()
        .zip([0.0, 0.0, 0.0, 1.0])
        .map(|(a, b)| (a - b).abs());
    if errors.any(|error| error.is_nan() || error > RIGID_TOLERANCE) {
        return fail(
            "rest_T[3]",
            format!("the last row is {last:?}, not 0 0 0 1"),
        );
    }
    let column = |j: usize| Vector3::new(x[j], y[j], z[j]);
    let rotation = Matrix3::from_columns(column(0), column(1), column(2));
    let placement = Placement::new(rotation, column(3));
    match placement.check_rigid(RIGID_TOLERANCE) {
        Ok(()) => Ok(placement),
        Err(reason) => fail("rest_T", format!("is not a rigid motion: {reason}")),
    }
}

/// The bone of an index in the file.
fn bone_id(number: i64, skeleton: &Skeleton) -> Result<BoneId, String> {
    let bone = usize::try_from(number)
        .ok()
        .and_then(|index| skeleton.bone_at(index));
    bone.ok_or_else(|| {
        let last = skeleton.bones().len().saturating_sub(1);
        format!("bone {number} does not exist; bones are 0 to {last}")
    })
}

pub(super) fn clip(
    file: &RigFile,
    skeleton: &Skeleton,
    name: &str,
) -> Result<EulerClip, ReadError> {
    let mut tracks = Vec::with_capacity(file.fk_animation.len());
    let mut interpolations = BTreeMap::new();
    for (index, entry) in file.fk_animation.iter().enumerate() {
        let path = |rest: String| format!("fk_animation[{index}].{rest}");
        let bone = bone_id(entry.bone_id, skeleton)
            .map_err(|problem| error_at(name, path("bone_id".into()), problem))?;
        let mut keys = Vec::with_capacity(entry.keys.len());
        for (index, key) in entry.keys.iter().enumerate() {
            let degrees = triple(&format!("keys[{index}].xzx"), Some(&key.xzx), 0.0)
                .map_err(|(key, problem)| error_at(name, path(key), problem))?;
            keys.push(EulerKey {
                time: key.t,
                angles: degrees.map(f64::to_radians),
            });
        }
        tracks.push(EulerTrack { bone, keys });
        let read = interpolation::read(entry);
        let read = read.map_err(|(key, problem)| error_at(name, path(key), problem))?;
        interpolations.insert(bone, read);
    }
    let clip = EulerClip::new(tracks).and_then(|clip| {
        clip.interpolated(|track| interpolations.get(&track.bone).cloned().unwrap_or_default())
    });
    clip.map_err(|error| {
        let path = match error {
            ClipError::DuplicateTrack { track, .. } => format!("fk_animation[{track}].bone_id"),
            ClipError::NonFiniteKeyTime { track, key, .. }
            | ClipError::NotIncreasing { track, key, .. } => {
                format!("fk_animation[{track}].keys[{key}].t")
            }
            ClipError::NonFiniteAngle { track, key, .. } => {
                format!("fk_animation[{track}].keys[{key}].xzx")
            }
            // Reading already checked the number and size of controls.
            _ => "fk_animation".into(),
        };
        error_at(name, path, error.to_string())
    })
}

pub(super) fn constrained(
    file: &RigFile,
    skeleton: &Skeleton,
    name: &str,
) -> Result<Vec<BoneId>, ReadError> {
    let fail = |path: String| move |problem: String| error_at(name, path, problem);
    match &file.ik_constraints {
        None => Ok(skeleton.bone_ids().last().into_iter().collect()),
        Some(BoneIndices::One(bone)) => {
            let bone = bone_id(*bone, skeleton).map_err(fail("ik_constraints".into()))?;
            Ok(vec![bone])
        }
        Some(BoneIndices::Many(numbers)) => {
            let (mut seen, mut bones) = (BTreeSet::new(), Vec::new());
            for (index, number) in numbers.iter().enumerate() {
                let path = format!("ik_constraints[{index}]");
                let bone = bone_id(*number, skeleton).map_err(fail(path))?;
                if seen.insert(bone) {
                    bones.push(bone);
                }
            }
            Ok(bones)
        }
    }
}
