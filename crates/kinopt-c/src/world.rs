//! Worlds of obstacles, and collision models of robots.

use std::ffi::c_char;

use kinopt::collision::{Checker, World};
use kinopt::spatial::{Placement, Vector3};

use crate::error::{Failure, KinoptStatus, guard};
use crate::pointer;
use crate::robot::KinoptRobot;

/// Obstacles by name. One thread uses it at a time; arms and problems copy it.
pub struct KinoptWorld {
    pub(crate) inner: World,
}

/// Collision shapes of a robot and its enabled collision pairs. It is immutable, and its creation is expensive.
pub struct KinoptCollisionModel {
    checker: Checker,
}

impl KinoptCollisionModel {
    /// Collision checker with a world and a margin in metres.
    pub(crate) fn checker(&self, world: &KinoptWorld, margin: f64) -> Result<Checker, Failure> {
        let checker = self.checker.clone().with_world(&world.inner)?;
        Ok(checker.with_margin(margin)?)
    }
}

/// Creates the collision model of a robot. Pairs of links that are always or never in contact, by sampled configurations,
/// are omitted.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_collision_model_new(
    robot: *const KinoptRobot,
    model: *mut *mut KinoptCollisionModel,
) -> KinoptStatus {
    guard(|| unsafe {
        let checker = Checker::of(&pointer::object(robot, "robot")?.inner)?;
        pointer::give(model, KinoptCollisionModel { checker }, "model")
    })
}

/// Frees a collision model.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_collision_model_free(model: *mut KinoptCollisionModel) {
    unsafe { pointer::free(model) }
}

/// Creates a world without obstacles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_world_new(world: *mut *mut KinoptWorld) -> KinoptStatus {
    guard(|| unsafe {
        let inner = World::default();
        pointer::give(world, KinoptWorld { inner }, "world")
    })
}

/// Reads a world from a file of `docs/guide/worlds.md`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_world_read(
    path: *const c_char,
    world: *mut *mut KinoptWorld,
) -> KinoptStatus {
    guard(|| unsafe {
        let inner = World::read(pointer::text(path, "path")?)?;
        pointer::give(world, KinoptWorld { inner }, "world")
    })
}

/// Frees a world.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_world_free(world: *mut KinoptWorld) {
    unsafe { pointer::free(world) }
}

/// Adds a box by its full lengths along x, y and z, three numbers. `pose` is a placement, null for the origin.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_world_add_box(
    world: *mut KinoptWorld,
    name: *const c_char,
    size: *const f64,
    pose: *const f64,
) -> KinoptStatus {
    guard(|| unsafe {
        let mut lengths = [0.0; 3];
        lengths.copy_from_slice(pointer::array(size, 3, "size")?);
        let (world, name, pose) = added(world, name, pose)?;
        Ok(world.add_box(name, lengths, pose)?)
    })
}

/// Adds a sphere.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_world_add_sphere(
    world: *mut KinoptWorld,
    name: *const c_char,
    radius: f64,
    pose: *const f64,
) -> KinoptStatus {
    guard(|| unsafe {
        let (world, name, pose) = added(world, name, pose)?;
        Ok(world.add_sphere(name, radius, pose)?)
    })
}

/// Adds a cylinder along z.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_world_add_cylinder(
    world: *mut KinoptWorld,
    name: *const c_char,
    radius: f64,
    length: f64,
    pose: *const f64,
) -> KinoptStatus {
    guard(|| unsafe {
        let (world, name, pose) = added(world, name, pose)?;
        Ok(world.add_cylinder(name, radius, length, pose)?)
    })
}

/// Adds a capsule along z; `length` is that of its segment.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_world_add_capsule(
    world: *mut KinoptWorld,
    name: *const c_char,
    radius: f64,
    length: f64,
    pose: *const f64,
) -> KinoptStatus {
    guard(|| unsafe {
        let (world, name, pose) = added(world, name, pose)?;
        Ok(world.add_capsule(name, radius, length, pose)?)
    })
}

/// Adds the half-space below z = 0 of the pose.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_world_add_plane(
    world: *mut KinoptWorld,
    name: *const c_char,
    pose: *const f64,
) -> KinoptStatus {
    guard(|| unsafe {
        let (world, name, pose) = added(world, name, pose)?;
        Ok(world.add_plane(name, pose)?)
    })
}

/// Adds a triangle mesh: `vertices` are x, y, z one after another, metres; `triangles` are three indices of vertices each.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_world_add_mesh(
    world: *mut KinoptWorld,
    name: *const c_char,
    vertices: *const f64,
    vertex_count: usize,
    triangles: *const u32,
    triangle_count: usize,
    pose: *const f64,
) -> KinoptStatus {
    guard(|| unsafe {
        let vertices = positions(vertices, vertex_count, "vertices")?;
        let triangles = pointer::groups::<u32, 3>(triangles, triangle_count, "triangles")?;
        let (world, name, pose) = added(world, name, pose)?;
        Ok(world.add_mesh(name, vertices, triangles.to_vec(), pose)?)
    })
}

/// Adds spheres of one radius about points: `positions` are x, y, z one after another, metres.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_world_add_points(
    world: *mut KinoptWorld,
    name: *const c_char,
    positions: *const f64,
    position_count: usize,
    radius: f64,
    pose: *const f64,
) -> KinoptStatus {
    guard(|| unsafe {
        let positions = self::positions(positions, position_count, "positions")?;
        let (world, name, pose) = added(world, name, pose)?;
        Ok(world.add_points(name, positions, radius, pose)?)
    })
}

/// Attaches an obstacle to a frame of the robot, such as a grasped object to the tool. `pose` is its placement in the frame.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_world_attach(
    world: *mut KinoptWorld,
    name: *const c_char,
    frame: *const c_char,
    pose: *const f64,
) -> KinoptStatus {
    guard(|| unsafe {
        let (world, name, pose) = added(world, name, pose)?;
        Ok(world.attach(name, pointer::text(frame, "frame")?, pose)?)
    })
}

/// Detaches an obstacle from its frame; `pose` is its placement in the world.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_world_detach(
    world: *mut KinoptWorld,
    name: *const c_char,
    pose: *const f64,
) -> KinoptStatus {
    guard(|| unsafe {
        let (world, name, pose) = added(world, name, pose)?;
        Ok(world.detach(name, pose)?)
    })
}

/// Moves an obstacle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_world_move(
    world: *mut KinoptWorld,
    name: *const c_char,
    pose: *const f64,
) -> KinoptStatus {
    guard(|| unsafe {
        let (world, name, pose) = added(world, name, pose)?;
        Ok(world.move_to(name, pose)?)
    })
}

/// Removes an obstacle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_world_remove(
    world: *mut KinoptWorld,
    name: *const c_char,
) -> KinoptStatus {
    guard(|| unsafe {
        let world = &mut pointer::object_mut(world, "world")?.inner;
        Ok(world.remove(pointer::text(name, "name")?)?)
    })
}

/// Allows collisions of an obstacle and a link, or of two obstacles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_world_allow_collision(
    world: *mut KinoptWorld,
    one: *const c_char,
    other: *const c_char,
) -> KinoptStatus {
    guard(|| unsafe {
        let world = &mut pointer::object_mut(world, "world")?.inner;
        Ok(world.allow_collision(pointer::text(one, "one")?, pointer::text(other, "other")?)?)
    })
}

unsafe fn positions(
    numbers: *const f64,
    count: usize,
    name: &str,
) -> Result<Vec<Vector3<f64>>, Failure> {
    // SAFETY: by the contract of the caller.
    let positions = unsafe { pointer::groups::<f64, 3>(numbers, count, name) }?;
    Ok(positions.iter().copied().map(Vector3::from).collect())
}

type Added<'a> = (&'a mut World, &'a str, Placement<f64>);

unsafe fn added<'a>(
    world: *mut KinoptWorld,
    name: *const c_char,
    pose: *const f64,
) -> Result<Added<'a>, Failure> {
    // SAFETY: by the contract of the caller.
    unsafe {
        let world = &mut pointer::object_mut(world, "world")?.inner;
        let pose = pointer::placement_or_identity(pose, "pose")?;
        Ok((world, pointer::text(name, "name")?, pose))
    }
}
