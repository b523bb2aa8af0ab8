//! Contact points of a foot on the ground.

use super::{Geometry, GeometryObject, Robot};
use kinopt_kinematics::model::{Frame, FrameId, JointId};
use kinopt_kinematics::spatial::{Placement, Vector3};

impl Robot {
    /// Contact points of a foot in its frame, metres: the origins of the links fixed to it, its own first, and corners
    /// of their collision shapes.
    ///
    /// A cylinder gives the corners of the square inscribed in its rim. Mesh files are not opened, so meshes add no
    /// points. The convex hull of the points in a top view is the area for
    /// [`SupportPolygon`](kinopt_solver::task::SupportPolygon::with_points_on). Empty for a frame of another model.
    #[must_use]
    pub fn sole(&self, foot: FrameId) -> Vec<Vector3<f64>> {
        let frames = self.model().frames();
        let Some(foot_frame) = frames.get(foot.index()) else {
            return Vec::new();
        };
        let (carrier, carrier_from_foot) = self.carrier_and_pose(foot_frame);
        let foot_from_carrier = carrier_from_foot.inverse();
        let others = frames.iter().enumerate();
        let others = others.filter(|(index, _)| *index != foot.index());
        let others = others.filter_map(|(index, frame)| match self.carrier_and_pose(frame) {
            (frame_carrier, carrier_from_frame) if frame_carrier == carrier => {
                Some((index, foot_from_carrier * carrier_from_frame))
            }
            _ => None,
        });
        let mut points = Vec::new();
        for (index, foot_from_link) in
            std::iter::once((foot.index(), Placement::identity())).chain(others)
        {
            points.push(foot_from_link.translation);
            let link = self.links.get(index);
            let shapes = link.map_or(&[][..], |link| &link.collisions).iter();
            points.extend(shapes.flat_map(|shape| {
                let foot_from_shape = foot_from_link * shape.link_from_shape;
                let corners = corners(shape).into_iter();
                corners.map(move |corner| foot_from_shape.apply(corner))
            }));
        }
        points
    }

    /// The nearest moving joint that carries a frame, and the pose of the frame in it.
    fn carrier_and_pose(&self, frame: &Frame) -> (Option<JointId>, Placement<f64>) {
        let joints = self.model().joints();
        let (mut carrier, mut carrier_from_frame) = (frame.joint, frame.joint_from_frame);
        while let Some(joint) = carrier.and_then(|id| joints.get(id.index())) {
            if joint.kind.moves() {
                break;
            }
            (carrier, carrier_from_frame) =
                (joint.parent, joint.parent_from_joint * carrier_from_frame);
        }
        (carrier, carrier_from_frame)
    }
}

/// Corner points of a shape in its frame, metres. Capsules give the ends of their axis, spheres and ellipsoids their
/// centre, and meshes nothing.
fn corners(shape: &GeometryObject) -> Vec<Vector3<f64>> {
    let half = match shape.geometry {
        Geometry::Box { size } => size.map(|side| 0.5 * side),
        Geometry::Cylinder { radius, length } => {
            let side = radius * std::f64::consts::FRAC_1_SQRT_2;
            [side, side, 0.5 * length]
        }
        Geometry::Capsule { length, .. } => {
            let ends = [-0.5, 0.5];
            return ends.map(|end| Vector3::new(0.0, 0.0, end * length)).into();
        }
        Geometry::Sphere { .. } | Geometry::Ellipsoid { .. } => return vec![Vector3::zero()],
        Geometry::Mesh { .. } => return Vec::new(),
    };
    let [x, y, z] = half;
    let signs = [-1.0, 1.0];
    let across = signs
        .into_iter()
        .flat_map(|i| signs.map(|j| (i * x, j * y)));
    let corners = across.flat_map(|(x, y)| signs.map(|k| Vector3::new(x, y, k * z)));
    corners.collect()
}
