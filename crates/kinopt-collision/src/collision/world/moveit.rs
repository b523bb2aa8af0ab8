//! MoveIt planning scenes in YAML, as in MotionBenchMaker's problems.
//!
//! The reader takes the collision objects of `world` and the attached objects of `robot_state`.

use crate::collision::shape::{Shape, ShapeError};
use kinopt_kinematics::file::{FileLocation, ReadError, ReadProblem};
use kinopt_kinematics::spatial::{Placement, Quaternion, Vector3};
use kinopt_robot::yaml::{self, Node, Value};

use super::World;
use super::moveit_frames::{Frames, frame_of};
use super::pose::unit_quaternion;

/// State of the reader of one file.
pub(super) struct Scene<'f> {
    file: &'f str,
    pub(super) world: World,
    frames: Frames,
    /// Obstacles of each object, by its `id`.
    pub(super) objects: Vec<(String, Vec<String>)>,
}

/// Parses the obstacles of a scene. The primitives of an object with several are the obstacles `name/0`, `name/1`, ….
pub(super) fn parse(bytes: &[u8], file: &str) -> Result<World, ReadError> {
    let text = std::str::from_utf8(bytes).map_err(|error| {
        ReadError::malformed(
            file,
            FileLocation::Byte(error.valid_up_to()),
            "is not UTF-8",
        )
    })?;
    let root = yaml::parse(text, file)?;
    let mut scene = Scene {
        file,
        world: World::new(),
        frames: Frames::default(),
        objects: Vec::new(),
    };
    scene.frames = scene.frames(&root)?;
    let world = root
        .get("world")
        .ok_or_else(|| scene.fail(&root, "is not a MoveIt planning scene: it has no `world`"))?;
    scene.reject_octomap(world)?;
    if let Some(objects) = world.get("collision_objects") {
        for object in scene.list(objects, "collision_objects")? {
            scene.object(object, None)?;
        }
    }
    let state = root.get("robot_state");
    if let Some(attached) = state.and_then(|state| state.get("attached_collision_objects")) {
        for attached in scene.list(attached, "attached_collision_objects")? {
            let link = scene.named(attached, "link_name")?;
            let link = scene.text(link, "link_name")?;
            let object = scene.named(attached, "object")?;
            scene.object(object, Some(link))?;
            if let Some(links) = attached.get("touch_links") {
                let id = scene.text(scene.named(object, "id")?, "id")?;
                for link in scene.list(links, "touch_links")? {
                    scene.allow(link, id, scene.text(link, "touch_links")?)?;
                }
            }
        }
    }
    if let Some(matrix) = root.get("allowed_collision_matrix") {
        scene.apply_allowed_matrix(matrix)?;
    }
    Ok(scene.world)
}

impl Scene<'_> {
    pub(super) fn fail(&self, at: &Node<'_>, problem: &str) -> ReadError {
        ReadError::malformed(self.file, FileLocation::Line(at.line), problem)
    }

    pub(super) fn invalid(
        &self,
        at: &Node<'_>,
        error: impl std::error::Error + Send + Sync + 'static,
    ) -> ReadError {
        ReadError::new(
            self.file,
            FileLocation::Line(at.line),
            ReadProblem::invalid(error),
        )
    }

    fn named<'n, 't>(&self, node: &'n Node<'t>, key: &str) -> Result<&'n Node<'t>, ReadError> {
        node.get(key)
            .ok_or_else(|| self.fail(node, &format!("has no `{key}`")))
    }

    pub(super) fn list<'n, 't>(
        &self,
        node: &'n Node<'t>,
        what: &str,
    ) -> Result<&'n [Node<'t>], ReadError> {
        node.list()
            .ok_or_else(|| self.fail(node, &format!("`{what}` is not a list")))
    }

    pub(super) fn text<'n>(&self, node: &'n Node<'_>, what: &str) -> Result<&'n str, ReadError> {
        node.text()
            .ok_or_else(|| self.fail(node, &format!("`{what}` is not a text")))
    }

    /// Numbers of a list, or of a map with these keys.
    fn numbers(&self, node: &Node<'_>, what: &str, keys: &[&str]) -> Result<Vec<f64>, ReadError> {
        let nodes: Vec<&Node<'_>> = match (&node.value, keys) {
            (Value::Map(_), [_, ..]) => {
                let values = keys.iter().map(|key| self.named(node, key));
                values.collect::<Result<_, _>>()?
            }
            _ => self.list(node, what)?.iter().collect(),
        };
        let number = |node: &&Node<'_>| {
            let problem = || {
                self.fail(
                    node,
                    &format!("`{what}` contains a value that is not a number"),
                )
            };
            node.number().ok_or_else(problem)
        };
        let numbers = nodes.iter().map(number).collect::<Result<Vec<_>, _>>()?;
        if !keys.is_empty() && numbers.len() != keys.len() {
            let problem = format!(
                "`{what}` holds {} numbers, not {}",
                numbers.len(),
                keys.len()
            );
            return Err(self.fail(node, &problem));
        }
        Ok(numbers)
    }

    /// Frames of the scene: its planning frame, and frames with a known transform to it.
    fn frames(&self, root: &Node<'_>) -> Result<Frames, ReadError> {
        let mut frames = Frames::of_state(root);
        if let Some(transforms) = root.get("fixed_frame_transforms") {
            for entry in self.list(transforms, "fixed_frame_transforms")? {
                let transform = self.named(entry, "transform")?;
                let placed = self.placed(transform, ["translation", "rotation"])?;
                frames.add(entry, placed);
            }
        }
        Ok(frames)
    }

    /// Placement of an object's frame in the planning frame, or in the link that holds the object.
    fn base_of(
        &self,
        object: &Node<'_>,
        name: &str,
        link: Option<&str>,
    ) -> Result<Placement<f64>, ReadError> {
        let Some(frame) = frame_of(object) else {
            return Ok(Placement::identity());
        };
        let (placed, planning_frame) = match link {
            Some(link) => ((frame == link).then(Placement::identity), link),
            None => (self.frames.placement(frame), self.frames.planning_frame()),
        };
        placed.ok_or_else(|| {
            let problem = format!(
                "object {name:?} is in frame {frame:?}, whose transform to {planning_frame:?} is missing from `fixed_frame_transforms`"
            );
            self.fail(object, &problem)
        })
    }

    /// Rejects octomaps with cells, since their obstacles would be missing.
    fn reject_octomap(&self, world: &Node<'_>) -> Result<(), ReadError> {
        let map = world.get("octomap").and_then(|map| map.get("octomap"));
        let Some(data) = map.and_then(|map| map.get("data")) else {
            return Ok(());
        };
        match data.list() {
            Some([]) => Ok(()),
            _ => Err(self.fail(data, "`octomap` contains cells, which are not supported")),
        }
    }

    fn pose(&self, node: &Node<'_>) -> Result<Placement<f64>, ReadError> {
        self.placed(node, ["position", "orientation"])
    }

    /// Reads a transform. Quaternions are x, y, z, w.
    fn placed(
        &self,
        node: &Node<'_>,
        [translation, rotation]: [&str; 2],
    ) -> Result<Placement<f64>, ReadError> {
        let mut pose = Placement::identity();
        if let Some(position) = node.get(translation) {
            let numbers = self.numbers(position, translation, &["x", "y", "z"])?;
            pose.translation = Vector3::new(numbers[0], numbers[1], numbers[2]);
        }
        if let Some(orientation) = node.get(rotation) {
            let numbers = self.numbers(orientation, rotation, &["x", "y", "z", "w"])?;
            let quaternion = Quaternion {
                w: numbers[3],
                v: Vector3::new(numbers[0], numbers[1], numbers[2]),
            };
            let unit = unit_quaternion(quaternion);
            pose.rotation = unit
                .map_err(|problem| self.fail(orientation, &problem))?
                .to_matrix();
        }
        Ok(pose)
    }

    fn object(&mut self, object: &Node<'_>, link: Option<&str>) -> Result<(), ReadError> {
        let name = self.text(self.named(object, "id")?, "id")?;
        let pose = object.get("pose").map(|pose| self.pose(pose));
        let pose = pose.transpose()?.unwrap_or_else(Placement::identity);
        let pose = self.base_of(object, name, link)? * pose;
        for other in ["meshes", "planes"] {
            let list = object.get(other).and_then(Node::list);
            if list.is_some_and(|list| !list.is_empty()) {
                let problem = format!("object {name:?} has `{other}`, which are not supported");
                return Err(self.fail(object, &problem));
            }
        }
        let none = [];
        let part = |key: &str| object.get(key).map(|node| self.list(node, key)).transpose();
        let primitives = part("primitives")?.unwrap_or(&none);
        let poses = part("primitive_poses")?.unwrap_or(&none);
        if primitives.len() != poses.len() {
            let problem = format!(
                "object {name:?} has {} primitives, but {} poses of them",
                primitives.len(),
                poses.len()
            );
            return Err(self.fail(object, &problem));
        }
        let mut obstacles = Vec::new();
        for (i, (primitive, placement)) in primitives.iter().zip(poses).enumerate() {
            let obstacle_name = match primitives.len() {
                1 => name.to_owned(),
                _ => format!("{name}/{i}"),
            };
            let placement = pose * self.pose(placement)?;
            let shape = self.shape(primitive)?;
            let added = self.world.add(&obstacle_name, shape, placement);
            let placed = added.and_then(|()| match link {
                Some(link) => self.world.attach(&obstacle_name, link, placement),
                None => Ok(()),
            });
            placed.map_err(|error| self.invalid(primitive, error))?;
            obstacles.push(obstacle_name);
        }
        self.objects.push((name.to_owned(), obstacles));
        Ok(())
    }

    fn shape(&self, primitive: &Node<'_>) -> Result<Shape, ReadError> {
        let kind = self.named(primitive, "type")?;
        let measures = self.named(primitive, "dimensions")?;
        let numbers = self.numbers(measures, "dimensions", &[])?;
        let kind = self.text(kind, "type")?;
        // Numbers are those of shape_msgs/SolidPrimitive.
        let shape: Result<Shape, ShapeError> = match (kind, numbers.as_slice()) {
            ("box" | "1", &[x, y, z]) => Shape::cuboid([x, y, z]),
            ("sphere" | "2", &[radius]) => Shape::sphere(radius),
            ("cylinder" | "3", &[height, radius]) => Shape::cylinder(radius, height),
            ("box" | "sphere" | "cylinder" | "1" | "2" | "3", numbers) => {
                let problem = format!("a {kind} does not have {} dimensions", numbers.len());
                return Err(self.fail(measures, &problem));
            }
            _ => {
                let problem = format!("a primitive {kind:?} is not box, sphere or cylinder");
                return Err(self.fail(primitive, &problem));
            }
        };
        shape.map_err(|error| self.invalid(measures, error))
    }
}
