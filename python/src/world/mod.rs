//! Worlds of obstacles.

mod mesh;
mod obstacle;

use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, PoisonError};

use kinopt::collision;
use kinopt::collision::WorldError;
use kinopt::spatial::{Placement, Vector3};
use pyo3::prelude::*;
use pyo3::types::PyType;

pub(crate) use obstacle::{Obstacle, Separation};

use crate::arrays;
use crate::error::{OrRaise, invalid};
use crate::file_access::access;
use crate::pickling;
use crate::placement;

/// Named obstacles in the order of their addition; `World()` has none. Lengths are in metres. A `pose` is that of an
/// obstacle in the world: a placement, such as a position of shape (3,), or None for the origin. An arm or problem copies
/// the world that it is given.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct World(Mutex<collision::World>);

impl World {
    fn lock(&self) -> MutexGuard<'_, collision::World> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Copy of the current state.
    pub(crate) fn snapshot(&self) -> collision::World {
        self.lock().clone()
    }

    fn obstacle(&self, name: &str) -> Result<collision::Obstacle, WorldError> {
        self.lock().obstacle(name).cloned()
    }
}

impl From<collision::World> for World {
    fn from(world: collision::World) -> Self {
        Self(Mutex::new(world))
    }
}

/// Reads a placement, or the origin.
fn pose(value: Option<&Bound<'_, PyAny>>, what: &str) -> PyResult<Placement<f64>> {
    value.map_or(Ok(Placement::identity()), |value| {
        placement::placement(value, what)
    })
}

fn vectors(value: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec<Vector3<f64>>> {
    let rows = arrays::rows(value, what, 3)?;
    let vectors = rows.chunks_exact(3);
    Ok(vectors.map(|v| Vector3::new(v[0], v[1], v[2])).collect())
}

#[pymethods]
impl World {
    #[new]
    fn new() -> Self {
        collision::World::new().into()
    }

    /// Reads a world from a file: kinopt's JSON (`.json`), or a planning scene of MoveIt (`.yaml`, `.yml`).
    ///
    /// Referenced files are opened only below its folder and below `folders`, with symbolic links resolved. Files above
    /// `max_bytes` are not read.
    ///
    /// Raises `FileError` if a file cannot be read, `InvalidFileError`, which names the position, if its content is
    /// invalid.
    #[classmethod]
    #[pyo3(
        signature = (path, *, folders = Vec::new(), max_bytes = 1_073_741_824),
        text_signature = "(path, *, folders=[], max_bytes=1073741824)"
    )]
    fn read(
        _class: &Bound<'_, PyType>,
        py: Python<'_>,
        path: PathBuf,
        folders: Vec<PathBuf>,
        max_bytes: u64,
    ) -> PyResult<Self> {
        let access = access(folders, max_bytes);
        let read = || collision::World::read_with(&path, &access);
        let world = py.detach(read).or_raise()?;
        Ok(world.into())
    }

    /// Reads a world from JSON; `name` is its name in messages. Meshes in files of their own are not opened.
    ///
    /// Raises `InvalidFileError` as `read`.
    #[classmethod]
    #[pyo3(signature = (text, name = "world.json"))]
    fn from_json(
        _class: &Bound<'_, PyType>,
        py: Python<'_>,
        text: &str,
        name: &str,
    ) -> PyResult<Self> {
        let world = py.detach(|| collision::World::from_json(text.as_bytes(), name));
        Ok(world.or_raise()?.into())
    }

    /// The world as JSON, with meshes and point clouds included.
    fn to_json(&self, py: Python<'_>) -> String {
        let world = self.snapshot();
        py.detach(|| world.to_json())
    }

    /// Writes the world as JSON to a .json file.
    ///
    /// Raises `InvalidValueError` for another file extension, `FileError` if the file cannot be written.
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let world = self.snapshot();
        py.detach(|| world.write(path)).or_raise()
    }

    /// Adds a box with its full lengths along x, y and z, shape (3,).
    ///
    /// Raises `InvalidValueError` for an invalid shape or pose, and for a name that exists.
    #[pyo3(signature = (name, size, pose = None))]
    fn add_box(
        &self,
        name: &str,
        size: &Bound<'_, PyAny>,
        pose: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let (size, pose) = (arrays::array(size, "size")?, self::pose(pose, "pose")?);
        self.lock().add_box(name, size, pose).or_raise()
    }

    /// Adds a sphere.
    ///
    /// Raises `InvalidValueError` for an invalid shape or pose, and for a name that exists.
    #[pyo3(signature = (name, radius, pose = None))]
    fn add_sphere(&self, name: &str, radius: f64, pose: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        let pose = self::pose(pose, "pose")?;
        self.lock().add_sphere(name, radius, pose).or_raise()
    }

    /// Adds a cylinder along z. `length` is the distance between its end faces.
    ///
    /// Raises `InvalidValueError` for an invalid shape or pose, and for a name that exists.
    #[pyo3(signature = (name, radius, length, pose = None))]
    fn add_cylinder(
        &self,
        name: &str,
        radius: f64,
        length: f64,
        pose: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let pose = self::pose(pose, "pose")?;
        let added = self.lock().add_cylinder(name, radius, length, pose);
        added.or_raise()
    }

    /// Adds a capsule along z: all points at most `radius` from a segment of `length`.
    ///
    /// Raises `InvalidValueError` for an invalid shape or pose, and for a name that exists.
    #[pyo3(signature = (name, radius, length, pose = None))]
    fn add_capsule(
        &self,
        name: &str,
        radius: f64,
        length: f64,
        pose: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let pose = self::pose(pose, "pose")?;
        let added = self.lock().add_capsule(name, radius, length, pose);
        added.or_raise()
    }

    /// Adds the half-space below z = 0 of its pose: a floor, or a wall for a rotated pose.
    ///
    /// Raises `InvalidValueError` for an invalid shape or pose, and for a name that exists.
    #[pyo3(signature = (name, pose = None))]
    fn add_plane(&self, name: &str, pose: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        let pose = self::pose(pose, "pose")?;
        self.lock().add_plane(name, pose).or_raise()
    }

    /// Adds the convex hull of `points`, shape (N, 3), which must span a volume.
    ///
    /// Raises `InvalidValueError` for an invalid shape or pose, and for a name that exists.
    #[pyo3(signature = (name, points, pose = None))]
    fn add_convex(
        &self,
        py: Python<'_>,
        name: &str,
        points: &Bound<'_, PyAny>,
        pose: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let (points, pose) = (vectors(points, "points")?, self::pose(pose, "pose")?);
        py.detach(|| {
            let shape = collision::Shape::convex(&points).map_err(named(name))?;
            self.lock().add(name, shape, pose)
        })
        .or_raise()
    }

    /// Adds a triangle mesh of `vertices`, shape (V, 3), and `triangles`, shape (F, 3), whole numbers from 0,
    /// counter-clockwise seen from outside. It may also be a mesh file: OBJ, STL, DAE or PLY. `scale`, a number or one
    /// each for x, y and z, converts its lengths to metres. A closed mesh is solid. An open mesh is a surface, and adds
    /// to the obstacle's `notes`.
    ///
    /// Raises `InvalidValueError` for an invalid shape or pose, and for a name that exists. Raises `FileError` if a
    /// file cannot be read, `InvalidFileError` if its content is invalid.
    #[pyo3(signature = (name, vertices, triangles = None, pose = None, *, scale = None))]
    fn add_mesh(
        &self,
        py: Python<'_>,
        name: &str,
        vertices: &Bound<'_, PyAny>,
        triangles: Option<&Bound<'_, PyAny>>,
        pose: Option<&Bound<'_, PyAny>>,
        scale: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let mesh = mesh::mesh(py, vertices, triangles)?;
        let scale = mesh::scale(scale)?;
        let pose = self::pose(pose, "pose")?;
        py.detach(|| {
            let mesh = mesh.scaled(scale);
            let shape = collision::Shape::mesh(mesh.points, mesh.triangles).map_err(named(name))?;
            self.lock().add(name, shape, pose)
        })
        .or_raise()
    }

    /// Adds spheres of one `radius` about `positions`, shape (N, 3), as of a point cloud.
    ///
    /// Raises `InvalidValueError` for an invalid shape or pose, and for a name that exists.
    #[pyo3(signature = (name, positions, radius, pose = None))]
    fn add_points(
        &self,
        py: Python<'_>,
        name: &str,
        positions: &Bound<'_, PyAny>,
        radius: f64,
        pose: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let (positions, pose) = (vectors(positions, "positions")?, self::pose(pose, "pose")?);
        py.detach(|| {
            let shape = collision::Shape::points(positions, radius).map_err(named(name))?;
            self.lock().add(name, shape, pose)
        })
        .or_raise()
    }

    /// Adds a height field of `heights`, shape (rows, columns). A row runs along x, and the rows follow along y;
    /// `spacing` is (along x, along y). The field is centred on the pose. It is solid below its surface, down to a
    /// depth of its longer side.
    ///
    /// Raises `InvalidValueError` for an invalid shape or pose, and for a name that exists.
    #[pyo3(signature = (name, heights, spacing, pose = None))]
    fn add_height_field(
        &self,
        py: Python<'_>,
        name: &str,
        heights: &Bound<'_, PyAny>,
        spacing: &Bound<'_, PyAny>,
        pose: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let heights =
            arrays::numbers::<numpy::ndarray::Ix2, f64>(heights, "heights", "(rows, columns)")?;
        let (columns, heights) = (heights.shape()[1], heights.to_vec());
        let spacing = arrays::array(spacing, "spacing")?;
        let pose = self::pose(pose, "pose")?;
        py.detach(|| {
            let shape = collision::Shape::height_field(heights, columns, spacing);
            self.lock().add(name, shape.map_err(named(name))?, pose)
        })
        .or_raise()
    }

    /// Moves an obstacle; for an attached one, its pose in the frame changes.
    ///
    /// Raises `UnknownNameError` for an unknown name, `InvalidValueError` for an invalid pose.
    fn r#move(&self, name: &str, pose: &Bound<'_, PyAny>) -> PyResult<()> {
        let pose = self::pose(Some(pose), "pose")?;
        self.lock().move_to(name, pose).or_raise()
    }

    /// Removes an obstacle, with its allowed collisions.
    ///
    /// Raises `UnknownNameError` for an unknown name.
    fn remove(&self, name: &str) -> PyResult<()> {
        self.lock().remove(name).or_raise()
    }

    /// Attaches an obstacle to a frame of the robot, such as a grasped object, at `frame_from_object` in it.
    ///
    /// Raises `UnknownNameError` for an unknown name, `InvalidValueError` for an invalid pose.
    #[pyo3(signature = (name, frame, frame_from_object = None))]
    fn attach(
        &self,
        name: &str,
        frame: &str,
        frame_from_object: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let pose = self::pose(frame_from_object, "frame_from_object")?;
        self.lock().attach(name, frame, pose).or_raise()
    }

    /// Detaches an obstacle and leaves it in the world at `world_from_object`.
    ///
    /// Raises `UnknownNameError` for an unknown name, `InvalidValueError` for an obstacle that is not attached and for
    /// an invalid pose.
    fn detach(&self, name: &str, world_from_object: &Bound<'_, PyAny>) -> PyResult<()> {
        let pose = self::pose(Some(world_from_object), "world_from_object")?;
        self.lock().detach(name, pose).or_raise()
    }

    /// Allows collisions of a pair, at any depth: an obstacle and a link of the robot, or two obstacles. Examples: feet
    /// and floor, gripper and can, grasped can and table. All checks skip the pair until `forbid_collision`, or until one
    /// of the obstacles is removed. Moving, attaching or detaching keeps the permission. An unknown link is an error
    /// only when a robot uses the world.
    ///
    /// Raises `UnknownNameError` if neither is an obstacle.
    fn allow_collision(&self, one: &str, other: &str) -> PyResult<()> {
        self.lock().allow_collision(one, other).or_raise()
    }

    /// Enables the collision pair again after `allow_collision`.
    ///
    /// Raises `UnknownNameError` if neither is an obstacle, `InvalidValueError` if their collision is not allowed.
    fn forbid_collision(&self, one: &str, other: &str) -> PyResult<()> {
        self.lock().forbid_collision(one, other).or_raise()
    }

    /// True if the collision of the pair is allowed, in either order.
    fn is_collision_allowed(&self, one: &str, other: &str) -> bool {
        self.lock().is_collision_allowed(one, other)
    }

    /// A new world with the obstacles scaled by the factor `times`, together with their distance from the world's
    /// origin. Example: the surroundings of a person, for a robot with another step length (`RetargetReport.stride`).
    /// Attached obstacles scale about the origin of their frame.
    ///
    /// Raises `InvalidValueError` for a factor that is not positive and finite, and if an obstacle becomes too small or
    /// too large.
    fn scaled(&self, py: Python<'_>, times: f64) -> PyResult<Self> {
        let world = self.snapshot();
        Ok(py.detach(|| world.scaled(times)).or_raise()?.into())
    }

    /// Distance of two obstacles, or their penetration depth.
    ///
    /// Raises `UnknownNameError` for an unknown name, `InvalidValueError` for an attached obstacle, whose pose in the
    /// world is unknown.
    fn separation(&self, py: Python<'_>, first: &str, second: &str) -> PyResult<Separation> {
        let (first_obstacle, second_obstacle) = (
            self.obstacle(first).or_raise()?,
            self.obstacle(second).or_raise()?,
        );
        for obstacle in [&first_obstacle, &second_obstacle] {
            if let Some(frame) = &obstacle.attached {
                let name = &obstacle.name;
                return Err(invalid(format!(
                    "obstacle {name:?} is attached to {frame:?}, so its pose in the world is unknown"
                )));
            }
        }
        let separation = py.detach(|| {
            collision::separation(
                &first_obstacle.shape,
                &first_obstacle.placement,
                &second_obstacle.shape,
                &second_obstacle.placement,
            )
        });
        Ok(Separation(separation))
    }

    /// Names of the obstacles, in the order of their addition.
    #[getter]
    fn names(&self) -> Vec<String> {
        self.lock().obstacles().map(|o| o.name.clone()).collect()
    }

    /// Notes, one text each: ignored parts of the file, and properties of accepted shapes, such as an open mesh without
    /// an interior.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.lock().notes()
    }

    /// Revision number, which increases with every change.
    #[getter]
    fn revision(&self) -> u64 {
        self.lock().revision()
    }

    fn __len__(&self) -> usize {
        self.lock().len()
    }

    fn __contains__(&self, name: &str) -> bool {
        self.lock().obstacle(name).is_ok()
    }

    /// Iterates over the names, in the order of their addition.
    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(self.names().into_pyobject(py)?.try_iter()?.into_any())
    }

    /// Copy of an obstacle.
    fn __getitem__(&self, name: &str) -> PyResult<Obstacle> {
        Ok(Obstacle(self.obstacle(name).or_raise()?))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let class = py.get_type::<Self>();
        pickling::by_method(class.as_any(), "from_json", (self.to_json(py),))
    }

    fn __repr__(&self) -> String {
        format!("World({})", kinopt::counted(self.lock().len(), "obstacle"))
    }
}

/// Adds the name of the obstacle to an error of its shape.
fn named(name: &str) -> impl FnOnce(collision::ShapeError) -> WorldError {
    let name = name.to_owned();
    move |error| WorldError::Shape { name, error }
}
