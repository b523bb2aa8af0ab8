//! Plane in which a limb bends.

use glam::Vec3A;

use kinopt_kinematics::scalar::elementary::single;

/// Plane of a limb, by orthogonal unit vectors.
#[derive(Clone, Copy)]
pub(super) struct LimbPlane {
    /// From the root to the end.
    along: Vec3A,
    /// Normal of the plane: `along` × direction to the middle joint.
    pub(super) normal: Vec3A,
}

impl LimbPlane {
    /// Plane of a limb from the vectors root to end and root to middle. The angle is the limb's deviation from the
    /// plane, radians within [−π, π] about the root-end line.
    ///
    /// The plane is perpendicular to the hinge axis, a positive rotation about which bends the limb. Without a hinge it
    /// is the plane of the limb itself. A straight limb without a hinge bends towards the pole, as seen from the root,
    /// or in an arbitrary direction.
    pub(super) fn of_limb(
        to_end: Vec3A,
        middle: Vec3A,
        pole: Option<Vec3A>,
        hinge: Option<Vec3A>,
    ) -> (Self, f32) {
        let end_direction = to_end.try_normalize();
        let hinge = hinge.and_then(|axis| {
            let perpendicular = axis.reject_from(end_direction.unwrap_or(middle));
            (-perpendicular).try_normalize()
        });
        let limb_normal = unit_normal(to_end, middle);
        let pole_normal = || unit_normal(middle, pole?);
        let arbitrary = || {
            let along = middle.try_normalize().unwrap_or(Vec3A::X);
            along.any_orthonormal_vector()
        };
        let normal = hinge
            .or(limb_normal)
            .or_else(pole_normal)
            .unwrap_or_else(arbitrary);
        let folded = || middle.cross(normal).try_normalize();
        let along = end_direction.or_else(folded).unwrap_or(Vec3A::X);
        let plane = Self { along, normal };
        let deviation = hinge
            .and(limb_normal)
            .map_or(0.0, |limb_normal| plane.angle_between(limb_normal));
        (plane, deviation)
    }

    /// Direction to the middle joint.
    pub(super) fn side(&self) -> Vec3A {
        self.normal.cross(self.along)
    }

    /// The plane moved to a new root-end vector by the shortest arc. This adds no roll, and is continuous except at a
    /// reversal of the vector.
    pub(super) fn moved_to(self, to_end: Vec3A) -> Self {
        let Some(along) = to_end.try_normalize() else {
            return self;
        };
        // Rodrigues' formula for v perpendicular to a, rotated from a to b: v − (a + b) (b·v) / (1 + a·b).
        let cosine = self.along.dot(along);
        let rise = along.dot(self.normal) / (1.0 + cosine).max(1e-6);
        let normal = self.normal - (self.along + along) * rise;
        let normal = normal.reject_from_normalized(along).try_normalize();
        Self {
            normal: normal.unwrap_or_else(|| along.any_orthonormal_vector()),
            along,
        }
    }

    /// The plane rotated about the root-end line by an angle in radians.
    pub(super) fn rotated(self, angle: f32) -> Self {
        if angle == 0.0 {
            return self;
        }
        let (sin, cos) = single::sin_cos(angle);
        Self {
            normal: self.normal * cos + self.along.cross(self.normal) * sin,
            ..self
        }
    }

    /// The plane through the root-end line with the middle joint towards a pole, as seen from the root. Unchanged if
    /// the pole is on the line.
    pub(super) fn facing(self, pole: Vec3A) -> Self {
        Self {
            normal: unit_normal(self.along, pole).unwrap_or(self.normal),
            ..self
        }
    }

    /// Angle about the root-end line to the plane that faces a pole, radians within [−π, π].
    pub(super) fn angle_to(&self, pole: Vec3A) -> f32 {
        // The normal need not have unit length.
        nonparallel_cross(self.along, pole).map_or(0.0, |normal| self.angle_between(normal))
    }

    fn angle_between(&self, normal: Vec3A) -> f32 {
        let sine = self.along.dot(self.normal.cross(normal));
        single::atan2(sine, self.normal.dot(normal))
    }
}

/// Direction of a × b; `None` if the vectors are within a milliradian of parallel.
fn unit_normal(a: Vec3A, b: Vec3A) -> Option<Vec3A> {
    nonparallel_cross(a, b)?.try_normalize()
}

/// a × b; `None` if the vectors are within a milliradian of parallel.
fn nonparallel_cross(a: Vec3A, b: Vec3A) -> Option<Vec3A> {
    let product = a.cross(b);
    let threshold = 1e-6 * a.length_squared() * b.length_squared();
    (product.length_squared() > threshold).then_some(product)
}
