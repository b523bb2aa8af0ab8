//! Construction of a collision model from a robot.

use std::path::PathBuf;

use super::capsules;
use super::meshes::{MeshCache, MeshFault, MeshUse};
use super::{CollisionModel, CollisionModelError, CollisionObject};
use crate::collision::Shape;
use crate::collision::mesh_folders::MeshFolders;
use kinopt_kinematics::bad_option::{AT_LEAST_ONE, BadOption};
use kinopt_kinematics::file::ReadError;
use kinopt_kinematics::file_access::AllowedFiles;
use kinopt_robot::robot::{self, Geometry, Robot};

/// Builder of a [`CollisionModel`] from a robot's shapes.
#[derive(Clone, Debug)]
pub struct CollisionModelBuilder<'r> {
    robot: &'r Robot,
    folders: MeshFolders,
    meshes: MeshUse,
    skips_missing_meshes: bool,
    confined: bool,
}

impl<'r> CollisionModelBuilder<'r> {
    pub(super) fn new(robot: &'r Robot) -> Self {
        let robot_folder = robot.file().and_then(|file| file.parent());
        Self {
            robot,
            folders: MeshFolders {
                robot_folder: robot_folder.map(Into::into),
                packages: Vec::new(),
            },
            meshes: MeshUse::default(),
            skips_missing_meshes: false,
            confined: robot.is_confined(),
        }
    }

    /// Adds a folder to the search path of `package://NAME/…` and relative paths.
    ///
    /// The folder contains packages or is a package.
    #[must_use]
    pub fn with_package_folder(mut self, folder: impl Into<PathBuf>) -> Self {
        self.folders.packages.push(folder.into());
        self
    }

    /// Sets the representation of meshes. The default is their convex hulls.
    #[must_use]
    pub fn with_meshes(mut self, meshes: MeshUse) -> Self {
        self.meshes = meshes;
        self
    }

    /// Leaves out meshes that are not found, with a note each, instead of returning an error.
    #[must_use]
    pub fn leaving_out_missing_meshes(mut self) -> Self {
        self.skips_missing_meshes = true;
        self
    }

    /// Restricts mesh files to the folder of the robot's file and the package folders, as for a
    /// [confined](Robot::confined) robot.
    #[must_use]
    pub fn confined(mut self) -> Self {
        self.confined = true;
        self
    }

    /// Builds the model.
    ///
    /// # Errors
    /// As [`CollisionModel::of`].
    pub fn build(&self) -> Result<CollisionModel, CollisionModelError> {
        if let MeshUse::Pieces(max_pieces) = self.meshes {
            BadOption::check("pieces", max_pieces as f64, AT_LEAST_ONE)?;
        }
        let mut objects = Vec::new();
        let mut notes = Vec::new();
        let mut meshes = MeshCache::default();
        let model = self.robot.model();
        for frame in model.frame_ids() {
            let Some(link) = self.robot.link(frame) else {
                continue;
            };
            let name = &model.frames()[frame.index()].name;
            let mut link_objects = Vec::new();
            for shape in &link.collisions {
                let shapes = match self.shapes(name, shape, &mut meshes) {
                    Err(error @ CollisionModelError::MeshNotFound { .. })
                        if self.skips_missing_meshes =>
                    {
                        notes.push(format!("left out: {error}"));
                        continue;
                    }
                    shapes => shapes?,
                };
                for collision_shape in shapes {
                    notes.extend(
                        collision_shape
                            .notes()
                            .iter()
                            .map(|note| format!("link `{name}`: {note}")),
                    );
                    link_objects.push(CollisionObject {
                        name: shape.name.clone().unwrap_or_default(),
                        link: frame,
                        link_from_shape: shape.link_from_shape,
                        shape: collision_shape,
                    });
                }
            }
            let named_objects = capsules::with_capsules(link_objects)
                .into_iter()
                .enumerate();
            objects.extend(
                named_objects.map(|(index, object)| match object.name.is_empty() {
                    true => CollisionObject {
                        name: format!("{name}_{index}"),
                        ..object
                    },
                    false => object,
                }),
            );
        }
        let map = self.robot.map().clone();
        let collision_model = CollisionModel::assemble(model, map, objects, notes)?;
        #[cfg(feature = "mjcf")]
        let collision_model = match self.robot.contacts() {
            Some(contacts) => collision_model.with_contacts(contacts),
            None => collision_model,
        };
        Ok(collision_model)
    }

    fn shapes(
        &self,
        link: &str,
        shape: &robot::GeometryObject,
        meshes: &mut MeshCache,
    ) -> Result<Vec<Shape>, CollisionModelError> {
        let fault = |source| CollisionModelError::Shape {
            link: link.to_owned(),
            object: shape.name.clone().unwrap_or_else(|| link.to_owned()),
            source,
        };
        let Geometry::Mesh { file, scale } = &shape.geometry else {
            return Ok(vec![Shape::try_from(&shape.geometry).map_err(fault)?]);
        };
        let not_found = |looked_at| CollisionModelError::MeshNotFound {
            link: link.to_owned(),
            file: file.clone(),
            looked_at,
        };
        let unreadable = |error: ReadError| CollisionModelError::Mesh {
            link: link.to_owned(),
            source: Box::new(error.without_contents()),
        };
        let path = match self.confined {
            true => {
                let allowed_path = self.folders.find_allowed(file, &self.allowed_files());
                allowed_path.map_err(|error| error.map_or_else(not_found, unreadable))?
            }
            false => self.folders.find(file).map_err(not_found)?,
        };
        match meshes.shapes(&path, *scale, self.meshes) {
            Ok(shapes) => Ok(shapes.to_vec()),
            Err(MeshFault::Shape(source)) => Err(fault(source)),
            Err(MeshFault::File(source)) => Err(unreadable(source)),
        }
    }

    /// The folders whose files a confined robot may read.
    fn allowed_files(&self) -> AllowedFiles {
        let folders = self
            .folders
            .robot_folder
            .iter()
            .chain(&self.folders.packages);
        AllowedFiles::below(folders.map(PathBuf::as_path))
    }
}
