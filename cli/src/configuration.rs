//! Configuration of a command.

use std::path::Path;

use kinopt::animation::{EulerClip, Playback};
use kinopt::model::{Limits, ModelError};
use kinopt_bindings::placement::QUATERNION_LENGTH_TOLERANCE;
use serde::Deserialize;

use crate::failure::Outcome;
use crate::joint_columns::followed;
use crate::loaded_model::LoadedModel;
use crate::number_format::six_digits;
use crate::{json_file, output};

/// Deviation of a mimic joint, in radians or metres, above which a note is printed.
const MIMIC_TOLERANCE: f64 = 1e-9;

/// List of numbers, or a document with a list under `q`, such as the output of `--json`.
#[derive(Deserialize)]
#[serde(untagged)]
enum ConfigurationFile {
    List(Vec<f64>),
    Document {
        q: Vec<f64>,
        joints: Option<Vec<String>>,
    },
}

impl LoadedModel {
    /// Configuration from typed numbers: angles in degrees if `degrees`, otherwise radians; lengths in metres.
    pub(crate) fn typed_configuration(
        &self,
        numbers: &[f64],
        degrees: bool,
        option: &str,
    ) -> Outcome<Vec<f64>> {
        let checked = self.check_numbers(numbers, option);
        checked.map_err(|problem| usage!("{problem}"))?;
        Ok(self.convert_angles(numbers, degrees, f64::to_radians))
    }

    /// Configuration for display: its angles in degrees if `degrees`, otherwise radians.
    pub(crate) fn shown(&self, q: &[f64], degrees: bool) -> Vec<f64> {
        self.convert_angles(q, degrees, f64::to_degrees)
    }

    fn convert_angles(&self, q: &[f64], degrees: bool, convert: fn(f64) -> f64) -> Vec<f64> {
        let numbers = q.iter().zip(self.is_angle());
        let converted = numbers.map(|(&number, is_angle)| match degrees && is_angle {
            true => convert(number),
            false => number,
        });
        converted.collect()
    }

    /// Configuration of a JSON file, in radians.
    pub(crate) fn configuration_file(&self, path: &Path) -> Outcome<Vec<f64>> {
        let file = path.display();
        let value = json_file::read(path)?;
        let numbers = match serde_json::from_value(value) {
            Ok(ConfigurationFile::Document {
                q,
                joints: Some(joints),
            }) => {
                let columns = self.joint_columns(&joints);
                let columns = columns.map_err(|problem| failure!("{file}: joints: {problem}"))?;
                let (width, given) = (columns.width(), q.len());
                if width != given {
                    return Err(failure!(
                        "{file}: {width} joints are named but q has {given} numbers"
                    ));
                }
                return Ok(columns.configuration(&q));
            }
            Ok(ConfigurationFile::List(q) | ConfigurationFile::Document { q, joints: None }) => q,
            Err(_) => {
                return Err(failure!(
                    "{file}: holds neither a list of numbers nor a document with one under `q`"
                ));
            }
        };
        let checked = self.check_numbers(&numbers, &file.to_string());
        checked.map_err(|problem| failure!("{problem}"))?;
        Ok(numbers)
    }

    /// Keyframes of a rig; `option` needs them. Notes bones with tracks without keys on standard error.
    pub(crate) fn keyframes(&self, option: &str) -> Outcome<&EulerClip> {
        if self.balls.is_some() {
            let file = &self.file;
            return Err(usage!(
                "{file}: {option} reads keyframes of angles; ball joints have none"
            ));
        }
        let clip = self.rig.as_ref().map(|rig| &rig.clip);
        let keyless = self.rig.iter().flat_map(|rig| {
            let bones = rig.clip.keyless().iter();
            bones.filter_map(|bone| Some(rig.skeleton.bones().get(bone.index())?.name.as_str()))
        });
        let keyless: Vec<&str> = keyless.collect();
        if !keyless.is_empty() {
            let names = keyless.join(", ");
            output::message(&format!("note: {names}: tracks without keys are left out"));
        }
        let (file, kind) = (&self.file, self.kind());
        let lacks = || failure!("{file}: {option} needs keyframes, and the {kind} has none");
        clip.filter(|clip| !clip.is_empty()).ok_or_else(lacks)
    }

    /// Configuration of the rig's keyframes at a time in seconds.
    pub(crate) fn keyframes_at(&self, time: f64, playback: Playback) -> Outcome<Vec<f64>> {
        let mut q = vec![0.0; self.model.configuration_len()];
        self.keyframes("--time")?.sample(time, playback, &mut q)?;
        Ok(q)
    }

    /// Checks that numbers from a source are a configuration. Notes quaternions without unit length on standard error.
    fn check_numbers(&self, numbers: &[f64], source: &str) -> Result<(), String> {
        let expected = self.model.configuration_len();
        if numbers.len() == expected {
            let mut turned = numbers.to_vec();
            if let Err(problem @ ModelError::NoRotation { .. }) = self.model.normalise(&mut turned)
            {
                return Err(format!("{source}: {problem}"));
            }
            self.note_lengths(numbers, source);
            return Ok(());
        }
        let shape = match &self.rig {
            Some(_) if self.balls.is_none() => {
                format!("{expected}: 3 for each of {} bones", expected / 3)
            }
            _ => format!("{expected}: {}", self.coordinate_names().join(", ")),
        };
        Err(format!(
            "{source}: {} numbers given, but a configuration has {shape} (kinopt info {} lists them)",
            numbers.len(),
            self.file
        ))
    }

    /// Notes quaternions on standard error whose length differs from 1 by more than rounding of typed numbers.
    fn note_lengths(&self, numbers: &[f64], source: &str) {
        let is_of_ball: Vec<bool> = self.is_of_ball().collect();
        let mut coordinate = 0;
        while let Some(&is_ball) = is_of_ball.get(coordinate) {
            let quaternion = numbers.get(coordinate..coordinate + 4).filter(|_| is_ball);
            let length = quaternion.map(|quaternion| {
                quaternion
                    .iter()
                    .map(|part| part * part)
                    .sum::<f64>()
                    .sqrt()
            });
            if let Some(length) = length.filter(|l| (l - 1.0).abs() > QUATERNION_LENGTH_TOLERANCE) {
                let name = self.model.moving_joints().get(coordinate);
                let name = name.map_or("", |id| self.joint_name(*id));
                output::message(&format!(
                    "note: {source}: the quaternion of `{name}` has length {}; it is divided by that",
                    six_digits(length)
                ));
            }
            coordinate += if is_ball { 4 } else { 1 };
        }
    }

    /// Notes mimic joints on standard error that differ from the value of their source joint.
    pub(crate) fn note_loose_followers(&self, q: &[f64], consequence: &str) {
        let followed = followed(&self.parameters(), q);
        let locked = self.model.limits().map(|limits| limits.is_locked());
        let values = q.iter().zip(&followed).zip(locked).zip(self.joint_names());
        let loose = values.filter_map(|(((value, followed), locked), name)| {
            let off = !locked && (value - followed).abs() > MIMIC_TOLERANCE;
            off.then(|| format!("`{name}` (expected {followed})"))
        });
        let loose: Vec<String> = loose.collect();
        if !loose.is_empty() {
            output::message(&format!(
                "note: mimic joints differ from their source joints: {}; {consequence}",
                loose.join(", ")
            ));
        }
    }

    /// Notes coordinates outside their limits on standard error.
    pub(crate) fn note_outside_limits(&self, q: &[f64], consequence: &str) {
        let limits = self.model.limits().zip(q).zip(self.model.moving_joints());
        let mut outside = limits.filter(|((limits, value), _)| !limits.contains(**value));
        let Some(((Limits { lower, upper }, value), id)) = outside.next() else {
            return;
        };
        let name = self.joint_name(*id);
        let others = match outside.count() {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        output::message(&format!(
            "note: `{name}`{others}: outside the limits ({value} is not within [{lower}, {upper}]); \
             {consequence}"
        ));
    }
}
