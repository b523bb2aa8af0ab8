//! Pixel task: the image of a frame's origin is at a pixel.

use nalgebra as na;

use super::residual::{check_finite, moved_by};
use super::{Description, DifferentiableTarget, Extensions, Inputs, Quantity, Residual, RowBlock};
use kinopt_kinematics::model::FrameId;
use kinopt_kinematics::scalar::Scalar;
use kinopt_kinematics::spatial::{Placement, Vector3};

/// A projective camera: homogeneous pixel (u·w, v·w, w) = P (x, y, z, 1).
///
/// Source: Hartley & Zisserman 2004, eq. 6.10.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// P by rows.
    pub pixel_from_world: [[f64; 4]; 3],
}

impl Camera {
    /// A pinhole camera at `world_from_camera`, with focal lengths and principal point in pixels.
    ///
    /// It looks along its +z axis, with x to the right and y down.
    #[must_use]
    pub fn pinhole(
        world_from_camera: &Placement<f64>,
        focal_length: [f64; 2],
        principal_point: [f64; 2],
    ) -> Self {
        let camera_from_world = world_from_camera.inverse();
        let r = camera_from_world.rotation.transpose();
        let t = camera_from_world.translation;
        let row = |axis: Vector3<f64>, shift| [axis.x, axis.y, axis.z, shift];
        let [x, y, z] = [row(r.x, t.x), row(r.y, t.y), row(r.z, t.z)];
        let combined = |axis_row: [f64; 4], focal: f64, centre: f64| {
            std::array::from_fn(|k| focal * axis_row[k] + centre * z[k])
        };
        Self {
            pixel_from_world: [
                combined(x, focal_length[0], principal_point[0]),
                combined(y, focal_length[1], principal_point[1]),
                z,
            ],
        }
    }

    /// The pixel (u, v) of a world point; not finite for points in the camera's plane.
    pub fn project<S: Scalar>(&self, point: Vector3<S>) -> [S; 2] {
        let [u, v, w] = self.pixel_from_world.map(|[x, y, z, shift]| {
            Vector3::constant(Vector3::new(x, y, z)).dot(point) + S::constant(shift)
        });
        [u / w, v / w]
    }

    /// The viewing ray through a pixel, as two points in world coordinates.
    ///
    /// The first point is the eye e with `P (e, 1) = 0`. The second is the pixel unprojected to depth one: m with
    /// `P (m, 1) = (u, v, 1)`. Returns `None` for a camera without eye (a parallel projection), or if a number is not
    /// finite.
    #[must_use]
    pub fn viewing_ray(&self, [u, v]: [f64; 2]) -> Option<[Vector3<f64>; 2]> {
        let rows = self.pixel_from_world;
        let linear = na::Matrix3::from_fn(|row, column| rows[row][column]);
        let shift = na::Vector3::from_fn(|row, _| rows[row][3]);
        let inverse = linear.try_inverse()?;
        let ends = [-shift, na::Vector3::new(u, v, 1.0) - shift].map(|image| inverse * image);
        let are_finite = ends.iter().flatten().all(|x| x.is_finite());
        are_finite.then(|| ends.map(Vector3::from))
    }
}

/// r = (u, v)(x) − (u, v)_target with the [projection](Camera::project) of x: two rows in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pixel {
    frame: FrameId,
    camera: Camera,
    target: [f64; 2],
}

impl Pixel {
    /// A task that moves the image of the frame's origin to (u, v), pixels.
    #[must_use]
    pub fn new(frame: FrameId, camera: Camera, target: [f64; 2]) -> Self {
        Self {
            frame,
            camera,
            target,
        }
    }

    /// Sets the target pixel.
    pub fn set_target(&mut self, target: [f64; 2]) {
        self.target = target;
    }
}

impl Residual for Pixel {
    const EXTENSIONS: Extensions<Self> = Extensions::NONE.with_target();

    fn inputs(&self) -> Inputs {
        Inputs::frames([self.frame])
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![RowBlock::new(Quantity::Pixels, 2)]
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], joints: &[S], residual: &mut [S]) {
        self.evaluate_moved(frames, joints, &[], residual);
    }

    fn description(&self) -> Description {
        Description::new("pixel").with_validity(self.validate())
    }
}

impl Pixel {
    /// Returns the first defect of the parameters.
    fn validate(&self) -> Result<(), String> {
        check_finite("its pixel", self.target)?;
        let camera = self.camera.pixel_from_world.into_iter().flatten();
        check_finite("its camera", camera)
    }
}

impl DifferentiableTarget for Pixel {
    fn target_len(&self) -> usize {
        2
    }

    fn evaluate_moved<S: Scalar>(
        &self,
        frames: &[Placement<S>],
        _joints: &[S],
        step: &[S],
        residual: &mut [S],
    ) {
        let image = self.camera.project(frames[0].translation);
        for (k, (row, coordinate)) in residual.iter_mut().zip(image).enumerate() {
            *row = coordinate - moved_by(self.target[k], step.get(k..).unwrap_or_default());
        }
    }

    fn has_edges(&self) -> bool {
        false
    }
}
