//! `<compiler>`: units and conventions of a file.

use super::attributes::Attributes;
use super::tree::Tag;
use crate::robot::xml::{ParseIssue, Read};

/// Settings of the `<compiler>` elements of a document; later elements override earlier ones.
#[derive(Clone, Debug)]
pub(super) struct Compiler {
    /// One unit of angle, in radians.
    pub(super) angle: f64,
    /// The three axes of Euler angles: the axis index 0, 1 or 2, and whether the axis is fixed (extrinsic).
    pub(super) euler: [(usize, bool); 3],
    /// A `range` alone makes a joint limited.
    pub(super) auto_limits: bool,
    /// Folder of mesh files.
    pub(super) mesh_folder: String,
    /// Paths in the file names of meshes are removed.
    pub(super) strip_path: bool,
    /// Source of inertias: never from geoms, from geoms for bodies without `inertial` (`None`), or always.
    pub(super) inertia_from_geom: Option<bool>,
    /// First and last group of the geoms that have mass.
    mass_groups: [f64; 2],
    /// Prescribed total mass of all bodies, kilograms.
    pub(super) total_mass: Option<f64>,
}

impl Compiler {
    pub(super) fn read(root: Tag<'_>) -> Read<Self> {
        let mut settings = Self {
            angle: std::f64::consts::PI / 180.0,
            euler: [(0, false), (1, false), (2, false)],
            auto_limits: true,
            mesh_folder: String::new(),
            strip_path: false,
            inertia_from_geom: None,
            mass_groups: [0.0, 5.0],
            total_mass: None,
        };
        for tag in root.children_named("compiler") {
            settings.apply(&Attributes::without_defaults(tag))?;
        }
        Ok(settings)
    }

    fn apply(&mut self, compiler: &Attributes<'_>) -> Read<()> {
        match compiler.word("angle", &["radian", "degree"])? {
            Some(0) => self.angle = 1.0,
            Some(_) => self.angle = std::f64::consts::PI / 180.0,
            None => {}
        }
        // MuJoCo rejects global coordinates as well.
        compiler.word("coordinate", &["local"])?;
        if let Some(text) = compiler.text("eulerseq") {
            self.euler = sequence(text).ok_or_else(|| {
                compiler.fault(ParseIssue::BadEulerSequence {
                    text: text.to_owned(),
                })
            })?;
        }
        let flag = |attribute, setting: &mut bool| -> Read<()> {
            *setting = compiler.flag(attribute)?.unwrap_or(*setting);
            Ok(())
        };
        flag("autolimits", &mut self.auto_limits)?;
        flag("strippath", &mut self.strip_path)?;
        if let Some(word) = compiler.word("inertiafromgeom", &["false", "true", "auto"])? {
            self.inertia_from_geom = [Some(false), Some(true), None][word];
        }
        if let Some(groups) = compiler.numbers("inertiagrouprange")? {
            self.mass_groups = groups;
        }
        // A value that is not above 0, such as the default, means no scaling.
        if let Some(total) = compiler.number("settotalmass")? {
            self.total_mass = Some(total).filter(|total| *total > 0.0);
        }
        let folder = compiler.text("meshdir").or(compiler.text("assetdir"));
        if let Some(folder) = folder {
            self.mesh_folder = folder.to_owned();
        }
        Ok(())
    }

    /// Reports whether geoms of a group contribute to the inertia of bodies.
    pub(super) fn counts_group_mass(&self, group: f64) -> bool {
        let [first, last] = self.mass_groups;
        (first..=last).contains(&group)
    }

    /// Path of a mesh file relative to the document's folder.
    pub(super) fn mesh_file(&self, file: &str) -> String {
        let name = match self.strip_path {
            true => file.rsplit(['/', '\\']).next().unwrap_or(file),
            false => file,
        };
        let folder = self.mesh_folder.trim_end_matches('/');
        match folder.is_empty() || name.starts_with('/') {
            true if self.mesh_folder.starts_with('/') && !name.starts_with('/') => {
                format!("/{name}")
            }
            true => name.to_owned(),
            false => format!("{folder}/{name}"),
        }
    }
}

fn sequence(text: &str) -> Option<[(usize, bool); 3]> {
    let axis = |letter: char| {
        let axis = "xyz".find(letter.to_ascii_lowercase())?;
        Some((axis, letter.is_ascii_uppercase()))
    };
    let axes: Option<Vec<_>> = text.chars().map(axis).collect();
    axes?.try_into().ok()
}
