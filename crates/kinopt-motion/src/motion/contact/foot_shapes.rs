//! Shapes of a model that can touch the ground.

use kinopt_kinematics::model::FrameId;
use kinopt_kinematics::scalar::elementary;
use kinopt_kinematics::spatial::{Placement, Vector3};
use kinopt_robot::robot::{Geometry, Robot};

/// Number of vertices that approximate a circle.
const CIRCLE_VERTICES: usize = 16;

/// Shapes of a model as balls fixed to its frames: each shape is the convex hull of its balls, approximately for round
/// ones.
///
/// [`Retargeting`](crate::motion::retarget::Retargeting) uses those of the feet for the ground height and to avoid ground penetration.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FootShapes {
    pub(in crate::motion) balls: Vec<FootBall>,
}

/// Ball that is fixed to a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(in crate::motion) struct FootBall {
    pub(in crate::motion) frame: FrameId,
    /// Centre in the frame's coordinates, metres.
    pub(in crate::motion) at: Vector3<f64>,
    pub(in crate::motion) radius: f64,
}

impl FootBall {
    /// Returns the height of its lowest point, given the pose of its frame, metres.
    pub(in crate::motion) fn height(&self, placed: &Placement<f64>) -> f64 {
        placed.apply(self.at).z - self.radius
    }
}

impl FootShapes {
    /// Creates shapes from the primitive collision shapes of a robot's file. Mesh files are not read.
    #[must_use]
    pub fn of(robot: &Robot) -> Self {
        let mut result = Self::default();
        for frame in robot.model().frame_ids() {
            let shapes = robot.link(frame).map(|link| link.collisions.iter());
            for shape in shapes.into_iter().flatten() {
                result.add_geometry(frame, &shape.link_from_shape, &shape.geometry);
            }
        }
        result
    }

    /// Creates shapes from a robot's collision shapes and the hulls of its meshes. Missing meshes are left out.
    #[cfg(feature = "collision")]
    #[must_use]
    pub fn of_files(robot: &Robot) -> Self {
        let builder = kinopt_collision::collision::CollisionModel::builder(robot);
        let model = builder.leaving_out_missing_meshes().build();
        model.map_or_else(
            |_| Self::of(robot),
            |model| Self::of_collision_model(&model),
        )
    }

    /// Creates shapes from a collision model, including the hulls of its meshes.
    #[cfg(feature = "collision")]
    #[must_use]
    pub fn of_collision_model(model: &kinopt_collision::collision::CollisionModel) -> Self {
        use kinopt_collision::collision::ShapeKind;
        let mut result = Self::default();
        for object in model.objects() {
            let (frame, placed) = (object.link, &object.link_from_shape);
            match object.shape.kind() {
                ShapeKind::Sphere { radius } => {
                    result.add(frame, placed, [Vector3::zero()], *radius)
                }
                &ShapeKind::Capsule { radius, length } => {
                    result.add_geometry(frame, placed, &Geometry::Capsule { radius, length });
                }
                &ShapeKind::Cylinder { radius, length } => {
                    result.add_geometry(frame, placed, &Geometry::Cylinder { radius, length });
                }
                &ShapeKind::Cuboid { size } => {
                    result.add_geometry(frame, placed, &Geometry::Box { size });
                }
                ShapeKind::Convex(hull) => {
                    result.add(frame, placed, hull.vertices().iter().copied(), 0.0);
                }
                ShapeKind::Mesh(mesh) => {
                    result.add(frame, placed, mesh.vertices().iter().copied(), 0.0);
                }
                ShapeKind::Points(cloud) => {
                    let points = cloud.positions().iter().copied();
                    result.add(frame, placed, points, cloud.radius());
                }
                // Ground, not part of a model.
                ShapeKind::HalfSpace | ShapeKind::HeightField(_) => {}
            }
        }
        result
    }

    fn add(
        &mut self,
        frame: FrameId,
        frame_from_shape: &Placement<f64>,
        points: impl IntoIterator<Item = Vector3<f64>>,
        radius: f64,
    ) {
        let balls = points.into_iter().map(|point| FootBall {
            frame,
            at: frame_from_shape.apply(point),
            radius,
        });
        self.balls.extend(balls);
    }

    fn add_geometry(
        &mut self,
        frame: FrameId,
        frame_from_shape: &Placement<f64>,
        geometry: &Geometry,
    ) {
        let ends =
            |length: f64| [-0.5, 0.5].map(|fraction| Vector3::new(0.0, 0.0, fraction * length));
        match *geometry {
            Geometry::Sphere { radius } => {
                self.add(frame, frame_from_shape, [Vector3::zero()], radius);
            }
            Geometry::Capsule { radius, length } => {
                self.add(frame, frame_from_shape, ends(length), radius);
            }
            Geometry::Box { size: [x, y, z] } => {
                let signs = [-0.5, 0.5];
                let corners = signs.into_iter().flat_map(|a| {
                    signs
                        .into_iter()
                        .flat_map(move |b| signs.map(|c| Vector3::new(a * x, b * y, c * z)))
                });
                self.add(frame, frame_from_shape, corners, 0.0);
            }
            Geometry::Cylinder { radius, length } => {
                for end in ends(length) {
                    let rim =
                        circle_directions().map(|(c, s)| end + Vector3::new(c, s, 0.0) * radius);
                    self.add(frame, frame_from_shape, rim, 0.0);
                }
            }
            Geometry::Ellipsoid { radii: [x, y, z] } => {
                let height = std::f64::consts::FRAC_1_SQRT_2;
                for (level, ratio) in [(-height, height), (0.0, 1.0), (height, height)] {
                    let rim = circle_directions()
                        .map(|(c, s)| Vector3::new(ratio * c * x, ratio * s * y, level * z));
                    self.add(frame, frame_from_shape, rim, 0.0);
                }
                self.add(frame, frame_from_shape, ends(2.0 * z), 0.0);
            }
            Geometry::Mesh { .. } => {}
        }
    }
}

/// Returns unit directions around a circle, as cosines and sines.
fn circle_directions() -> impl Iterator<Item = (f64, f64)> {
    let angle_step = std::f64::consts::TAU / CIRCLE_VERTICES as f64;
    (0..CIRCLE_VERTICES).map(move |k| {
        let (sine, cosine) = elementary::sin_cos(angle_step * k as f64);
        (cosine, sine)
    })
}
