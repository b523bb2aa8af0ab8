//! Worlds of obstacles, and collision models of bodies.

use kinopt::collision::{self, Checker};
use kinopt::spatial::{Placement, Vector3};
use wasm_bindgen::prelude::*;

use crate::error::{Exception, raise};
use crate::placement;
use crate::robot::Robot;

/// Obstacles by name; lengths in metres.
#[wasm_bindgen]
#[derive(Clone, Default)]
pub struct World {
    pub(crate) inner: collision::World,
}

/// Reads a placement of sixteen numbers, or a position of three.
fn pose(numbers: Option<Vec<f64>>) -> Result<Placement<f64>, Exception> {
    match numbers.as_deref() {
        None => Ok(Placement::identity()),
        Some(&[x, y, z]) => Ok(Placement::translation(Vector3::new(x, y, z))),
        Some(numbers) => placement::read(numbers, "pose"),
    }
}

#[wasm_bindgen]
impl World {
    /// Creates a world without obstacles.
    #[wasm_bindgen(constructor)]
    pub fn new() -> Self {
        Self::default()
    }

    /// Reads a world from its JSON; `name` is its name in messages.
    #[wasm_bindgen(js_name = fromJson)]
    pub fn from_json(text: &str, name: Option<String>) -> Result<Self, Exception> {
        let name = name.as_deref().unwrap_or("world.json");
        let inner = collision::World::from_json(text.as_bytes(), name).map_err(raise)?;
        Ok(Self { inner })
    }

    /// The world as JSON.
    #[wasm_bindgen(js_name = toJson)]
    pub fn to_json(&self) -> String {
        self.inner.to_json()
    }

    /// The world with obstacles scaled by the factor `times`, together with their distance from the origin. Obstacles
    /// of a subject scale by `stride` for a robot.
    pub fn scaled(&self, times: f64) -> Result<Self, Exception> {
        let inner = self.inner.scaled(times).map_err(raise)?;
        Ok(Self { inner })
    }

    /// Adds a box by its full lengths along x, y and z. A pose is a placement, or a position of three numbers.
    #[wasm_bindgen(js_name = addBox)]
    pub fn add_box(
        &mut self,
        name: &str,
        #[wasm_bindgen(unchecked_param_type = "Numbers")] size: &[f64],
        #[wasm_bindgen(unchecked_optional_param_type = "Numbers")] pose: Option<Vec<f64>>,
    ) -> Result<(), Exception> {
        let size: [f64; 3] = size.try_into().map_err(|_| {
            let count = size.len();
            Exception::new(&format!("size has {count} numbers, expected 3"))
        })?;
        let pose = self::pose(pose)?;
        self.inner.add_box(name, size, pose).map_err(raise)
    }

    /// Adds a sphere.
    #[wasm_bindgen(js_name = addSphere)]
    pub fn add_sphere(
        &mut self,
        name: &str,
        radius: f64,
        #[wasm_bindgen(unchecked_optional_param_type = "Numbers")] pose: Option<Vec<f64>>,
    ) -> Result<(), Exception> {
        let pose = self::pose(pose)?;
        self.inner.add_sphere(name, radius, pose).map_err(raise)
    }

    /// Adds a cylinder along z.
    #[wasm_bindgen(js_name = addCylinder)]
    pub fn add_cylinder(
        &mut self,
        name: &str,
        radius: f64,
        length: f64,
        #[wasm_bindgen(unchecked_optional_param_type = "Numbers")] pose: Option<Vec<f64>>,
    ) -> Result<(), Exception> {
        let pose = self::pose(pose)?;
        let added = self.inner.add_cylinder(name, radius, length, pose);
        added.map_err(raise)
    }

    /// Adds a capsule along z. `length` is that of its segment.
    #[wasm_bindgen(js_name = addCapsule)]
    pub fn add_capsule(
        &mut self,
        name: &str,
        radius: f64,
        length: f64,
        #[wasm_bindgen(unchecked_optional_param_type = "Numbers")] pose: Option<Vec<f64>>,
    ) -> Result<(), Exception> {
        let pose = self::pose(pose)?;
        let added = self.inner.add_capsule(name, radius, length, pose);
        added.map_err(raise)
    }

    /// Adds the half-space below z = 0 of the pose.
    #[wasm_bindgen(js_name = addPlane)]
    pub fn add_plane(
        &mut self,
        name: &str,
        #[wasm_bindgen(unchecked_optional_param_type = "Numbers")] pose: Option<Vec<f64>>,
    ) -> Result<(), Exception> {
        let pose = self::pose(pose)?;
        self.inner.add_plane(name, pose).map_err(raise)
    }

    /// Moves an obstacle.
    #[wasm_bindgen(js_name = move)]
    pub fn move_to(
        &mut self,
        name: &str,
        #[wasm_bindgen(unchecked_param_type = "Numbers")] pose: Vec<f64>,
    ) -> Result<(), Exception> {
        let pose = self::pose(Some(pose))?;
        self.inner.move_to(name, pose).map_err(raise)
    }

    /// Removes an obstacle.
    pub fn remove(&mut self, name: &str) -> Result<(), Exception> {
        self.inner.remove(name).map_err(raise)
    }

    /// Allows collisions of an obstacle and a link, or of two obstacles, at any depth, until `forbidCollision` or the
    /// removal of one of the obstacles.
    #[wasm_bindgen(js_name = allowCollision)]
    pub fn allow_collision(&mut self, one: &str, other: &str) -> Result<(), Exception> {
        self.inner.allow_collision(one, other).map_err(raise)
    }

    /// Enables the collision pair again after `allowCollision`.
    #[wasm_bindgen(js_name = forbidCollision)]
    pub fn forbid_collision(&mut self, one: &str, other: &str) -> Result<(), Exception> {
        self.inner.forbid_collision(one, other).map_err(raise)
    }

    /// True if the collision of the pair is allowed, in either order.
    #[wasm_bindgen(js_name = isCollisionAllowed)]
    pub fn is_collision_allowed(&self, one: &str, other: &str) -> bool {
        self.inner.is_collision_allowed(one, other)
    }

    /// Notes: ignored parts of the file, and properties of accepted shapes, such as an open mesh.
    #[wasm_bindgen(getter)]
    pub fn notes(&self) -> Vec<String> {
        self.inner.notes()
    }

    /// Names of the obstacles.
    #[wasm_bindgen(getter)]
    pub fn names(&self) -> Vec<String> {
        let obstacles = self.inner.obstacles();
        obstacles.map(|obstacle| obstacle.name.clone()).collect()
    }
}

/// Copies the world of a caller's object.
#[cfg(feature = "clip-ik")]
pub(crate) fn copied(value: &JsValue, what: &str) -> Result<collision::World, Exception> {
    let not_a_world = |_| Exception::new(&format!("{what} must be a World"));
    let json = js_sys::Reflect::get(value, &"toJson".into());
    let json = json.and_then(|json| json.dyn_into::<js_sys::Function>());
    let json = json
        .and_then(|json| json.call0(value))
        .map_err(not_a_world)?;
    let text = json.as_string().unwrap_or_default();
    collision::World::from_json(text.as_bytes(), what).map_err(raise)
}

/// Collision shapes of a body, enabled collision pairs of links, and spheres that cover the shapes. Its creation is
/// expensive.
#[wasm_bindgen]
pub struct CollisionModel {
    checker: Checker,
}

#[wasm_bindgen]
impl CollisionModel {
    /// Creates the model from the collision shapes of a robot. Pairs that are always or never in contact, by sampled
    /// configurations, are omitted.
    #[wasm_bindgen(js_name = ofRobot)]
    pub fn of_robot(robot: &Robot) -> Result<Self, Exception> {
        let checker = Checker::of(&robot.inner).map_err(raise)?;
        Ok(Self { checker })
    }

    /// The model with the spheres of a file for fast collision checks: cuRobo's `collision_spheres`, or the spheres of
    /// a spherised URDF. `file` is the name of the file; its extension gives the format. The spheres are enlarged by
    /// their gaps.
    #[wasm_bindgen(js_name = withSpheres)]
    pub fn with_spheres(&self, text: &str, file: &str) -> Result<Self, Exception> {
        let model = self.checker.model();
        let spheres = collision::SphereModel::parse(text.as_bytes(), file, model).map_err(raise)?;
        let checker = self.checker.clone().with_spheres(spheres);
        Ok(Self { checker })
    }

    /// Omissions and repairs of the robot's shapes and of a file of spheres.
    #[wasm_bindgen(getter)]
    pub fn notes(&self) -> Vec<String> {
        let spheres = self.checker.spheres().map(collision::SphereModel::notes);
        let of_model = self.checker.model().notes().iter();
        of_model
            .chain(spheres.unwrap_or_default())
            .cloned()
            .collect()
    }

    /// Names of the links with shapes.
    #[wasm_bindgen(getter)]
    pub fn links(&self) -> Vec<String> {
        let model = self.checker.model();
        let frames = model.model().frames();
        let links = model.links().iter();
        links
            .map(|link| frames[link.index()].name.clone())
            .collect()
    }
}

impl CollisionModel {
    /// Collision checker of the body with a world.
    pub(crate) fn checker(&self, world: &World, margin: Option<f64>) -> Result<Checker, Exception> {
        let checker = self
            .checker
            .clone()
            .with_world(&world.inner)
            .map_err(raise)?;
        checker.with_margin(margin.unwrap_or(0.0)).map_err(raise)
    }
}

#[cfg(feature = "bodies")]
#[wasm_bindgen]
impl CollisionModel {
    /// Creates the model from the skin of a rig.
    #[wasm_bindgen(js_name = ofSkin)]
    pub fn of_skin(rig: &crate::rig::Rig) -> Result<Self, Exception> {
        let rig = &rig.inner;
        let (Some(mesh), Some(weights)) = (&rig.mesh, &rig.weights) else {
            return Err(Exception::new("the rig has no mesh with weights"));
        };
        let shapes = kinopt::motion::skin_capsules(&rig.skeleton, mesh, weights);
        let checker = Checker::covered(shapes.map_err(raise)?);
        Ok(Self { checker })
    }
}
