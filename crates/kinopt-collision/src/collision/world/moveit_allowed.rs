//! Allowed collision matrix of a MoveIt planning scene. Only pairs with an object are used; pairs of links belong to
//! the robot.

use std::collections::BTreeSet;

use super::moveit::Scene;
use kinopt_kinematics::file::ReadError;
use kinopt_robot::yaml::Node;

const MATRIX: &str = "allowed_collision_matrix";

impl Scene<'_> {
    /// Applies the allowed pairs of the matrix.
    pub(super) fn apply_allowed_matrix(&mut self, matrix: &Node<'_>) -> Result<(), ReadError> {
        let none = [];
        let part = |key: &str| matrix.get(key).map(|node| self.list(node, key)).transpose();
        let names = part("entry_names")?.unwrap_or(&none);
        let rows = part("entry_values")?.unwrap_or(&none);
        let has_defaults = part("default_entry_names")?.is_some_and(|names| !names.is_empty());
        if names.len() != rows.len() {
            let (names, rows) = (names.len(), rows.len());
            let problem =
                format!("`{MATRIX}` has {names} `entry_names`, but {rows} rows of values");
            return Err(self.fail(matrix, &problem));
        }
        let mut seen = BTreeSet::new();
        for name in names {
            if !seen.insert(self.text(name, "entry_names")?) {
                return Err(self.fail(name, "`entry_names` has a name twice"));
            }
        }
        let mut has_link_pairs = false;
        for (index, (name, row)) in names.iter().zip(rows).enumerate() {
            let first = self.text(name, "entry_names")?;
            // Rows of the message type, or plain lists.
            let row = row.get("enabled").unwrap_or(row);
            let values = self.list(row, "entry_values")?;
            if values.len() != names.len() {
                let (values, names) = (values.len(), names.len());
                let problem = format!("`{MATRIX}` has a row of {values} values for {names} names");
                return Err(self.fail(row, &problem));
            }
            // The matrix is symmetric. MoveIt reads the part above its diagonal.
            for (value, other) in values.iter().zip(names).skip(index + 1) {
                let allowed = match value.text() {
                    Some("true" | "True" | "1") => true,
                    Some("false" | "False" | "0") => false,
                    _ => {
                        return Err(self.fail(
                            value,
                            "`entry_values` contains a value other than true and false",
                        ));
                    }
                };
                if allowed {
                    let second = self.text(other, "entry_names")?;
                    has_link_pairs |= !self.allow(value, first, second)?;
                }
            }
        }
        if has_link_pairs {
            let note = "link pairs of `allowed_collision_matrix` are ignored: an SRDF file or the robot defines them";
            self.world.notes.push(note.to_owned());
        }
        if has_defaults {
            let note = "defaults of `allowed_collision_matrix` are ignored: only `entry_values` apply to `default_entry_names`";
            self.world.notes.push(note.to_owned());
        }
        Ok(())
    }

    /// Allows the collision of all obstacles of an object with a link, or with those of another object.
    ///
    /// Returns true if one of the names is an object.
    pub(super) fn allow(
        &mut self,
        at: &Node<'_>,
        one: &str,
        other: &str,
    ) -> Result<bool, ReadError> {
        let obstacles_of = |id: &str| {
            let entry = self.objects.iter().find(|(object, _)| object == id);
            entry.map(|(_, obstacles)| obstacles.clone())
        };
        let (first, second) = (obstacles_of(one), obstacles_of(other));
        let is_of_object = first.is_some() || second.is_some();
        let first = first.unwrap_or_else(|| vec![one.to_owned()]);
        let second = second.unwrap_or_else(|| vec![other.to_owned()]);
        if is_of_object {
            // The names may refer to removed objects or to another robot.
            let names = first.iter().chain(&second).cloned();
            self.world.may_be_missing.extend(names);
            for a in &first {
                for b in &second {
                    let allowed = self.world.allow_collision(a, b);
                    allowed.map_err(|error| self.invalid(at, error))?;
                }
            }
        }
        Ok(is_of_object)
    }
}
