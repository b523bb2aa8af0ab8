//! Builder methods for joints with several coordinates: ball, free, planar and universal joints.

use super::{BallLimits, Joint, JointId, JointKind, Limits, ModelBuilder};
use crate::spatial::{Placement, Vector3};

impl ModelBuilder {
    /// Adds a joint that rotates about one point.
    ///
    /// With limits, it stays within a cone about `axis` (joint frame) and a range of twist.
    pub fn ball(
        &mut self,
        name: impl Into<String>,
        parent: Option<JointId>,
        parent_from_joint: impl Into<Placement<f64>>,
        axis: impl Into<Vector3<f64>>,
        limits: Option<BallLimits>,
    ) -> JointId {
        let (placement, kind, unlimited) = (parent_from_joint, JointKind::Ball, Limits::UNBOUNDED);
        let mut joint = Joint::new(name, parent, placement, kind, axis, unlimited);
        joint.ball = limits;
        self.joint(joint)
    }

    /// Adds a free joint: three prismatic joints and a ball joint.
    ///
    /// The prismatic joints `NAME/x`, `NAME/y` and `NAME/z` move along the joint's x, y and z within the given limits
    /// (metres). The ball joint `NAME/rotation` follows; its id is returned, and children attach to it. Coordinates: x,
    /// y, z and the quaternion w, x, y, z. A velocity, in [`Model::integrate`](super::Model::integrate) and in
    /// Jacobians, is linear and then angular. Both are in the axes of the moved frame, as for Pinocchio's free flyer.
    pub fn free(
        &mut self,
        name: impl Into<String>,
        parent: Option<JointId>,
        parent_from_joint: impl Into<Placement<f64>>,
        bounds: [Limits; 3],
    ) -> JointId {
        let name = name.into();
        let [x, y, z] = Vector3::UNITS;
        let mut prismatic = |part, parent, placement: Placement<f64>, axis, limits| {
            self.prismatic(format!("{name}/{part}"), parent, placement, axis, limits)
        };
        let at_parent = Placement::identity();
        let along_x = prismatic("x", parent, parent_from_joint.into(), x, bounds[0]);
        let along_y = prismatic("y", Some(along_x), at_parent, y, bounds[1]);
        let along_z = prismatic("z", Some(along_y), at_parent, z, bounds[2]);
        self.free.push(along_x);
        let ball_name = format!("{name}/rotation");
        self.ball(ball_name, Some(along_z), at_parent, x, None)
    }

    /// Adds a planar joint: two prismatic joints and a rotation about the plane's normal.
    ///
    /// The prismatic joints `NAME/x` and `NAME/y` move within the given limits (metres), perpendicular to `normal`
    /// (joint frame). The rotation `NAME/yaw` about `normal` follows, within `yaw` (radians); its id is returned. For a
    /// normal along z the prismatic joints move along x and y.
    pub fn planar(
        &mut self,
        name: impl Into<String>,
        parent: Option<JointId>,
        parent_from_joint: impl Into<Placement<f64>>,
        normal: impl Into<Vector3<f64>>,
        bounds: [Limits; 2],
        yaw: Limits,
    ) -> JointId {
        let name = name.into();
        let z: Vector3<f64> = normal.into();
        // The coordinate axis after the one nearest to the normal is the most perpendicular to it.
        let [along_x, along_y, along_z] = [z.x.abs(), z.y.abs(), z.z.abs()];
        let reference = match (along_z >= along_x && along_z >= along_y, along_x >= along_y) {
            (true, _) => Vector3::UNITS[0],
            (false, true) => Vector3::UNITS[1],
            (false, false) => Vector3::UNITS[2],
        };
        let x = reference * z.norm_squared() - z * z.dot(reference);
        let y = z.cross(x);
        let at_parent = Placement::identity();
        let along_x = self.prismatic(format!("{name}/x"), parent, parent_from_joint, x, bounds[0]);
        let along_y = self.prismatic(format!("{name}/y"), Some(along_x), at_parent, y, bounds[1]);
        let (yaw_name, kind) = (format!("{name}/yaw"), JointKind::Continuous.within(&yaw));
        self.joint(Joint::new(yaw_name, Some(along_y), at_parent, kind, z, yaw))
    }

    /// Adds a universal joint: `NAME/first` rotates about `first`, then `NAME/second` about the rotated `second`.
    ///
    /// Returns the id of `NAME/second`; limits in radians.
    pub fn universal(
        &mut self,
        name: impl Into<String>,
        parent: Option<JointId>,
        parent_from_joint: impl Into<Placement<f64>>,
        [first, second]: [Vector3<f64>; 2],
        limits: [Limits; 2],
    ) -> JointId {
        let name = name.into();
        let at_parent = Placement::identity();
        let joint_name = format!("{name}/first");
        let first_joint = self.revolute(joint_name, parent, parent_from_joint, first, limits[0]);
        let joint_name = format!("{name}/second");
        self.revolute(joint_name, Some(first_joint), at_parent, second, limits[1])
    }
}
