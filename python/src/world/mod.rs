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

/// Named obstacles in the order in which they were added: `World()` has none. Lengths are in metres; a `pose` is
/// where an obstacle stands in the world, a placement of shape (4, 4), a position of shape (3,), or None for the
/// origin. Who has taken a world (an arm, say) keeps it as it was then.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct World(Mutex<collision::World>);

impl World {
    fn lock(&self) -> MutexGuard<'_, collision::World> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// As it is now.
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

/// A placement, a position or the origin.
fn pose(value: Option<&Bound<'_, PyAny>>, what: &str) -> PyResult<Placement<f64>> {
    match value {
        None => Ok(Placement::identity()),
        Some(value) if arrays::axes(value).unwrap_or(0) == 1 => {
            match *arrays::vector(value, what)? {
                [x, y, z] => Ok(Vector3::new(x, y, z).into()),
                ref other => Err(invalid(format!(
                    "{what} has shape ({},), expected a position of shape (3,) or a placement of shape (4, 4)",
                    other.len()
                ))),
            }
        }
        Some(value) => placement::placement(value, what),
    }
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

    /// Reads a world from a file: our JSON (`.json`), or a planning scene of MoveIt's (`.yaml`, `.yml`).
    ///
    /// The files that it names are opened only below its own folder and below `folders`, symbolic links followed. No file above
    /// `max_bytes` is read.
    ///
    /// Raises `FileError` where it cannot be read, `InvalidFileError`, which names the place, for what is wrong in it.
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

    /// Reads a world from JSON; `name` is what messages call it. Meshes in files of their own are not opened.
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

    /// The world as JSON, meshes and clouds within.
    fn to_json(&self, py: Python<'_>) -> String {
        let world = self.snapshot();
        py.detach(|| world.to_json())
    }

    /// Writes the world as JSON, which is read from a .json.
    ///
    /// Raises `InvalidValueError` for a name that ends in another way, `FileError` where it cannot be written.
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let world = self.snapshot();
        py.detach(|| world.write(path)).or_raise()
    }

    /// Adds a box with its whole lengths along x, y and z, shape (3,).
    ///
    /// Raises `InvalidValueError` for a shape or pose that cannot be, and for a name that is taken.
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
    /// Raises `InvalidValueError` for a shape or pose that cannot be, and for a name that is taken.
    #[pyo3(signature = (name, radius, pose = None))]
    fn add_sphere(&self, name: &str, radius: f64, pose: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        let pose = self::pose(pose, "pose")?;
        self.lock().add_sphere(name, radius, pose).or_raise()
    }

    /// Adds a cylinder along z, `length` from one end to the other.
    ///
    /// Raises `InvalidValueError` for a shape or pose that cannot be, and for a name that is taken.
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
    /// Raises `InvalidValueError` for a shape or pose that cannot be, and for a name that is taken.
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

    /// Adds everything below z = 0 of its pose: a floor, or a wall where it is turned.
    ///
    /// Raises `InvalidValueError` for a shape or pose that cannot be, and for a name that is taken.
    #[pyo3(signature = (name, pose = None))]
    fn add_plane(&self, name: &str, pose: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        let pose = self::pose(pose, "pose")?;
        self.lock().add_plane(name, pose).or_raise()
    }

    /// Adds the convex hull of `points`, shape (N, 3), which must span a volume.
    ///
    /// Raises `InvalidValueError` for a shape or pose that cannot be, and for a name that is taken.
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
    /// counter-clockwise seen from outside; or, in place of both, of a file: OBJ, STL, DAE or PLY. `scale`, a number or one each for x, y and
    /// z, makes metres of its lengths. Where it is closed, what it encloses belongs to it; else its surface alone
    /// counts, which the obstacle's `notes` tell.
    ///
    /// Raises `InvalidValueError` for a shape or pose that cannot be, and for a name that is taken; `FileError` where a file cannot be read,
    /// `InvalidFileError` for what is wrong in it.
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

    /// Adds spheres of one `radius` about `positions`, shape (N, 3), as of a camera's cloud.
    ///
    /// Raises `InvalidValueError` for a shape or pose that cannot be, and for a name that is taken.
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

    /// Adds a ground of `heights`, shape (rows, columns), a row along x, row after row along y, `spacing` (along x,
    /// along y) apart and centred on the pose; what is below the surface is solid, as far down as its longer side is.
    ///
    /// Raises `InvalidValueError` for a shape or pose that cannot be, and for a name that is taken.
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

    /// Moves an obstacle; of an attached one the pose in its frame.
    ///
    /// Raises `UnknownNameError` for a name that is not there, `InvalidValueError` for what is no pose.
    fn r#move(&self, name: &str, pose: &Bound<'_, PyAny>) -> PyResult<()> {
        let pose = self::pose(Some(pose), "pose")?;
        self.lock().move_to(name, pose).or_raise()
    }

    /// Takes an obstacle out, and with it what it may touch and what may touch it.
    ///
    /// Raises `UnknownNameError` for a name that is not there.
    fn remove(&self, name: &str) -> PyResult<()> {
        self.lock().remove(name).or_raise()
    }

    /// Makes an obstacle move with a frame of the robot, as something grasped does, at `frame_from_object` in it.
    ///
    /// Raises `UnknownNameError` for a name that is not there, `InvalidValueError` for what is no pose.
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

    /// Leaves an obstacle in the world again, at `world_from_object`.
    ///
    /// Raises `UnknownNameError` for a name that is not there, `InvalidValueError` for what is attached to nothing and for what is no pose.
    fn detach(&self, name: &str, world_from_object: &Bound<'_, PyAny>) -> PyResult<()> {
        let pose = self::pose(Some(world_from_object), "world_from_object")?;
        self.lock().detach(name, pose).or_raise()
    }

    /// Lets two things touch, however deep: an obstacle and a link of the robot, or two obstacles, as feet and the floor, a gripper and its
    /// can, or a can that is held and the table. Every check passes them over, until it is forbidden or one of the obstacles is removed; what
    /// is moved, attached or detached keeps it. Whether the robot has the link shows when both come together.
    ///
    /// Raises `UnknownNameError` where neither is an obstacle.
    fn allow_touch(&self, one: &str, other: &str) -> PyResult<()> {
        self.lock().allow_touch(one, other).or_raise()
    }

    /// Keeps two things apart again that may touch.
    ///
    /// Raises `UnknownNameError` where neither is an obstacle, `InvalidValueError` where they may not touch.
    fn forbid_touch(&self, one: &str, other: &str) -> PyResult<()> {
        self.lock().forbid_touch(one, other).or_raise()
    }

    /// Whether two things were let touch, in either order.
    fn may_touch(&self, one: &str, other: &str) -> bool {
        self.lock().may_touch(one, other)
    }

    /// A new world of the same obstacles `times` as large and as far from the world's origin, as a person's surroundings are for a
    /// robot whose steps are so many times as long (`Retargeted.stride`); attached ones as far from the origin of their frame.
    ///
    /// Raises `InvalidValueError` for a factor that is not positive and finite, and where an obstacle gets too small or too large.
    fn scaled(&self, py: Python<'_>, times: f64) -> PyResult<Self> {
        let world = self.snapshot();
        Ok(py.detach(|| world.scaled(times)).or_raise()?.into())
    }

    /// How far two obstacles are apart, or how deep one is in the other.
    ///
    /// Raises `UnknownNameError` for a name that is not there, `InvalidValueError` where one is attached to a frame, so
    /// that its place in the world is not known.
    fn separation(&self, py: Python<'_>, first: &str, second: &str) -> PyResult<Separation> {
        let (one, other) = (
            self.obstacle(first).or_raise()?,
            self.obstacle(second).or_raise()?,
        );
        for obstacle in [&one, &other] {
            if let Some(frame) = &obstacle.attached {
                let name = &obstacle.name;
                return Err(invalid(format!(
                    "obstacle {name:?} is attached to {frame:?}, so its place in the world is not known"
                )));
            }
        }
        let found = py.detach(|| {
            collision::separation(&one.shape, &one.placement, &other.shape, &other.placement)
        });
        Ok(Separation(found))
    }

    /// The obstacles' names, in the order in which they were added.
    #[getter]
    fn names(&self) -> Vec<String> {
        self.lock().obstacles().map(|o| o.name.clone()).collect()
    }

    /// What is to be known of it, one text each: what the file that it was read from says and is not taken up, and what was found about
    /// the shapes of its obstacles and taken all the same, as that a mesh is open and so has no inside.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.lock().notes()
    }

    /// A number that every change raises.
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

    /// The names, in the order in which they were added.
    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(self.names().into_pyobject(py)?.try_iter()?.into_any())
    }

    /// An obstacle as it stands.
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

/// A shape's error with the obstacle's name.
fn named(name: &str) -> impl FnOnce(collision::ShapeError) -> WorldError {
    let name = name.to_owned();
    move |error| WorldError::Shape { name, error }
}
