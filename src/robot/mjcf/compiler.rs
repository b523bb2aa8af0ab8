//! `<compiler>`: how the numbers of a file are meant.

use super::attributes::Attributes;
use super::tree::Tag;
use crate::robot::xml::{Fault, Read};

/// What the `<compiler>` elements say, the later the stronger, for the whole document.
#[derive(Clone, Debug)]
pub(super) struct Compiler {
    /// One unit of its angles in radians.
    pub(super) angle: f64,
    /// The axes of Euler angles, each 0, 1 or 2, and whether it stays where it is rather than turn along.
    pub(super) euler: [(usize, bool); 3],
    /// Whether a range alone makes a joint limited.
    pub(super) auto_limits: bool,
    /// The folder of meshes, and whether folders that they name count.
    pub(super) mesh_folder: String,
    pub(super) strip_path: bool,
    /// When masses come from shapes: never, where none is stated, always.
    pub(super) inertia_from_geom: Option<bool>,
    /// The first and the last group of geoms that weigh anything.
    weighing_groups: [f64; 2],
    /// What all bodies weigh together, kilograms.
    pub(super) total_mass: Option<f64>,
}

impl Compiler {
    pub(super) fn read(root: Tag<'_>) -> Read<Self> {
        let mut own = Self {
            angle: std::f64::consts::PI / 180.0,
            euler: [(0, false), (1, false), (2, false)],
            auto_limits: true,
            mesh_folder: String::new(),
            strip_path: false,
            inertia_from_geom: None,
            weighing_groups: [0.0, 5.0],
            total_mass: None,
        };
        for tag in root.children_named("compiler") {
            own.take(&Attributes::own(tag))?;
        }
        Ok(own)
    }

    fn take(&mut self, compiler: &Attributes<'_>) -> Read<()> {
        match compiler.word("angle", &["radian", "degree"])? {
            Some(0) => self.angle = 1.0,
            Some(_) => self.angle = std::f64::consts::PI / 180.0,
            None => {}
        }
        // MuJoCo itself reads global coordinates no more.
        compiler.word("coordinate", &["local"])?;
        if let Some(text) = compiler.text("eulerseq") {
            self.euler = sequence(text).ok_or_else(|| {
                compiler.fault(Fault::BadEulerSequence {
                    text: text.to_owned(),
                })
            })?;
        }
        let flag = |attribute, own: &mut bool| -> Read<()> {
            *own = compiler.flag(attribute)?.unwrap_or(*own);
            Ok(())
        };
        flag("autolimits", &mut self.auto_limits)?;
        flag("strippath", &mut self.strip_path)?;
        if let Some(word) = compiler.word("inertiafromgeom", &["false", "true", "auto"])? {
            self.inertia_from_geom = [Some(false), Some(true), None][word];
        }
        if let Some(groups) = compiler.numbers("inertiagrouprange")? {
            self.weighing_groups = groups;
        }
        // One that is not above 0, as by default, changes nothing.
        if let Some(total) = compiler.number("settotalmass")? {
            self.total_mass = Some(total).filter(|total| *total > 0.0);
        }
        let folder = compiler.text("meshdir").or(compiler.text("assetdir"));
        if let Some(folder) = folder {
            self.mesh_folder = folder.to_owned();
        }
        Ok(())
    }

    /// Whether geoms of a group add to the mass of a body that states none.
    pub(super) fn weighs_group(&self, group: f64) -> bool {
        let [first, last] = self.weighing_groups;
        (first..=last).contains(&group)
    }

    /// Where a mesh lies, from the document's folder.
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
