//! Numbers by joint name, such as the columns of a file.

use kinopt::model::{ParameterMap, Source, UnknownName};
use kinopt_bindings::problem_file::number_list::Numbers;
use kinopt_bindings::problem_file::targets_file::TargetsFile;

use crate::failure::Outcome;
use crate::loaded_model::LoadedModel;

/// Coordinates of a configuration that the columns of a file hold.
#[derive(Clone, Debug)]
pub(crate) struct JointColumns {
    coordinates: Vec<usize>,
    /// Flag of every coordinate that is an angle.
    is_angle: Vec<bool>,
    rest: Vec<f64>,
    /// Mimic coordinates without a column; their values follow from their source joints.
    followers: Vec<usize>,
    map: ParameterMap,
}

impl LoadedModel {
    /// Columns of the named joints, in any order; a ball joint has four consecutive columns.
    ///
    /// # Errors
    /// A duplicate name, a fixed joint, or an unknown name with a list of the valid ones, in words.
    pub(crate) fn joint_columns(&self, names: &[impl AsRef<str>]) -> Result<JointColumns, String> {
        let mut coordinates: Vec<usize> = Vec::with_capacity(names.len());
        for name in names {
            let name = name.as_ref();
            let joint = self.model.joint(name);
            let joint = joint.map_err(|_| {
                UnknownName::new("moving joint", name, self.joint_names()).to_string()
            })?;
            let first = self.model.coordinate(joint);
            let first = first.ok_or_else(|| format!("joint `{name}` is fixed"))?;
            let joint = self.model.joints().get(joint.index());
            let components = first..first + joint.map_or(1, |joint| joint.kind.coordinates());
            let mut unused = components.filter(|coordinate| !coordinates.contains(coordinate));
            let coordinate = unused.next();
            let twice = || format!("joint `{name}` is named twice");
            coordinates.push(coordinate.ok_or_else(twice)?);
        }
        Ok(self.columns_of(coordinates))
    }

    /// Columns of the given coordinates.
    pub(crate) fn columns_of(&self, coordinates: Vec<usize>) -> JointColumns {
        let map = self.parameters();
        let follows = |(coordinate, source): (usize, &Source)| match source {
            Source::Variable { variable, .. } => {
                map.leaders().get(*variable).copied() != Some(coordinate)
            }
            _ => false,
        };
        let sources = map.sources().iter().enumerate();
        let followers = sources
            .filter(|&entry| follows(entry) && !coordinates.contains(&entry.0))
            .map(|(coordinate, _)| coordinate)
            .collect();
        JointColumns {
            coordinates,
            is_angle: self.is_angle().collect(),
            rest: self.rest(),
            followers,
            map,
        }
    }

    /// Start configurations: rows for all moving joints, for the named joints, or for the free joints from base to tip.
    pub(crate) fn starts_of(
        &self,
        file: &TargetsFile,
        base_to_tip: Option<&JointColumns>,
    ) -> Result<Option<Vec<Vec<f64>>>, String> {
        let Some(rows) = &file.starts else {
            return Ok(None);
        };
        let width = rows.first().map_or(0, Vec::len);
        let all = self.model.configuration_len();
        let columns = match (&file.joint_names, base_to_tip) {
            (Some(names), _) => {
                let columns = self.joint_columns(names);
                columns.map_err(|problem| format!("joint_names: {problem}"))?
            }
            (None, _) if width == all => self.columns_of((0..all).collect()),
            (None, Some(columns)) if columns.width() == width => columns.clone(),
            (None, columns) => {
                let or_arm = columns.map_or_else(String::new, |columns| {
                    let (count, names) = (columns.width(), columns.names(self));
                    format!(", or {count} from base to tip: {}", names.join(", "))
                });
                return Err(format!(
                    "starts[0]: has {width} numbers; without joint_names, expected {all} for all \
                     moving joints{or_arm}"
                ));
            }
        };
        let starts = rows.iter().map(|row| columns.configuration(row));
        Ok(Some(starts.collect()))
    }
}

impl JointColumns {
    /// Count of numbers in a row.
    pub(crate) fn width(&self) -> usize {
        self.coordinates.len()
    }

    /// Joint names, in the order of the columns.
    pub(crate) fn names<'l>(&self, loaded: &'l LoadedModel) -> Vec<&'l str> {
        let names = loaded.joint_names();
        let columns = self.coordinates.iter();
        columns.filter_map(|&c| names.get(c).copied()).collect()
    }

    /// One number for each column, in radians if angles are typed in degrees.
    ///
    /// Given is one number for all (not for a posture), one for each column, or one for each coordinate of the model.
    pub(crate) fn one_each(
        &self,
        loaded: &LoadedModel,
        option: &str,
        numbers: &Numbers,
    ) -> Outcome<Vec<f64>> {
        let given = &numbers.values;
        let (width, all) = (self.width(), loaded.model.configuration_len());
        let columns = self.coordinates.iter();
        let picked: Vec<f64> = match given.as_slice() {
            [one] if option != "--posture" => vec![*one; width],
            _ if given.len() == all => columns.filter_map(|&c| given.get(c).copied()).collect(),
            _ if given.len() == width => given.clone(),
            _ => {
                return Err(usage!(
                    "{option}: {} numbers given; expected {width} ({}) or {all}, one for each moving joint",
                    given.len(),
                    self.names(loaded).join(", ")
                ));
            }
        };
        Ok(self.in_radians(&picked, numbers.degrees))
    }

    /// Configuration as of [`configuration`](Self::configuration), of a row whose angles may be in degrees.
    pub(crate) fn typed(&self, row: &[f64], degrees: bool) -> Vec<f64> {
        self.configuration(&self.in_radians(row, degrees))
    }

    /// Row with its angles in radians; they may be typed in degrees.
    pub(crate) fn in_radians(&self, row: &[f64], degrees: bool) -> Vec<f64> {
        let numbers = row.iter().zip(&self.coordinates);
        let converted = numbers.map(|(&number, &coordinate)| {
            match degrees && self.is_angle.get(coordinate) == Some(&true) {
                true => number.to_radians(),
                false => number,
            }
        });
        converted.collect()
    }

    /// Configuration of a row: joints without a column are at rest, mimic joints follow their source joints.
    pub(crate) fn configuration(&self, row: &[f64]) -> Vec<f64> {
        let mut q = self.rest.clone();
        for (&coordinate, &value) in self.coordinates.iter().zip(row) {
            if let Some(slot) = q.get_mut(coordinate) {
                *slot = value;
            }
        }
        if !self.followers.is_empty() {
            let followed = followed(&self.map, &q);
            for &coordinate in &self.followers {
                let value = followed.get(coordinate);
                if let Some((slot, &value)) = q.get_mut(coordinate).zip(value) {
                    *slot = value;
                }
            }
        }
        q
    }
}

/// `q` with all mimic joints at the values of their source joints, regardless of limits.
pub(crate) fn followed(map: &ParameterMap, q: &[f64]) -> Vec<f64> {
    let leaders = map.leaders().iter();
    let x = leaders.map(|&leader| q.get(leader).copied().unwrap_or(0.0));
    let x: Vec<f64> = x.collect();
    let mut expanded = q.to_vec();
    // An invalid configuration is returned unchanged; its user reports the error.
    match map.expand(&x, &mut expanded) {
        Ok(()) => {
            // A ball is no mimic joint, and its quaternion is no variable.
            for ((value, number), source) in expanded.iter_mut().zip(q).zip(map.sources()) {
                if matches!(source, Source::Rotation { .. }) {
                    *value = *number;
                }
            }
            expanded
        }
        Err(_) => q.to_vec(),
    }
}
