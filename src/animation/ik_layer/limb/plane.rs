//! The plane in which a limb bends, and where it goes as the limb's end moves.

use glam::Vec3A;

use crate::scalar::elementary::single;

/// The plane of a limb by unit vectors at right angles.
#[derive(Clone, Copy)]
pub(super) struct Plane {
    /// From the root to the end.
    along: Vec3A,
    /// At a right angle to the plane: `along` × the side on which the middle is.
    pub(super) normal: Vec3A,
}

impl Plane {
    /// The plane of a limb (the way from its root to its end, and to its middle), and the angle by which
    /// the limb is out of it, radians within [−π, π] about the way. It is the plane of the hinge's
    /// axis (a positive turn about it bends the limb), or without one the plane that the limb is in. A
    /// stretched limb without a hinge bends towards the pole (as seen from the root), or anywhere.
    pub(super) fn of(
        way: Vec3A,
        middle: Vec3A,
        pole: Option<Vec3A>,
        hinge: Option<Vec3A>,
    ) -> (Self, f32) {
        let way_along = way.try_normalize();
        let hinge = hinge.and_then(|axis| {
            let off_line = axis.reject_from(way_along.unwrap_or(middle));
            (-off_line).try_normalize()
        });
        let own = across(way, middle);
        let asked = || across(middle, pole?);
        let any = || {
            let along = middle.try_normalize().unwrap_or(Vec3A::X);
            along.any_orthonormal_vector()
        };
        let normal = hinge.or(own).or_else(asked).unwrap_or_else(any);
        let folded = || middle.cross(normal).try_normalize();
        let along = way_along.or_else(folded).unwrap_or(Vec3A::X);
        let plane = Self { along, normal };
        let off = hinge.and(own).map_or(0.0, |own| plane.angle_between(own));
        (plane, off)
    }

    /// The side on which the middle is.
    pub(super) fn side(&self) -> Vec3A {
        self.normal.cross(self.along)
    }

    /// The same plane for another way to the end, turned by the shortest arc between the two: no
    /// roll, and no flip wherever the end goes but straight back.
    pub(super) fn carried(self, way: Vec3A) -> Self {
        let Some(along) = way.try_normalize() else {
            return self;
        };
        // Rodrigues' formula for v at a right angle to a, from a to b: v − (a + b) (b·v) / (1 + a·b).
        let cosine = self.along.dot(along);
        let rise = along.dot(self.normal) / (1.0 + cosine).max(1e-6);
        let normal = self.normal - (self.along + along) * rise;
        let normal = normal.reject_from_normalized(along).try_normalize();
        Self {
            normal: normal.unwrap_or_else(|| along.any_orthonormal_vector()),
            along,
        }
    }

    /// The same plane turned about the way to the end by an angle in radians.
    pub(super) fn turned(self, angle: f32) -> Self {
        if angle == 0.0 {
            return self;
        }
        let (sin, cos) = single::sin_cos(angle);
        Self {
            normal: self.normal * cos + self.along.cross(self.normal) * sin,
            ..self
        }
    }

    /// The plane through the same way to the end with the middle's side towards a pole as seen from the
    /// root; the same plane for a pole on the way.
    pub(super) fn facing(self, pole: Vec3A) -> Self {
        Self {
            normal: across(self.along, pole).unwrap_or(self.normal),
            ..self
        }
    }

    /// The angle about the way to the end, radians within [−π, π], to the plane facing a pole.
    pub(super) fn angle_to(&self, pole: Vec3A) -> f32 {
        // No need for unit length.
        steep(self.along, pole).map_or(0.0, |normal| self.angle_between(normal))
    }

    fn angle_between(&self, normal: Vec3A) -> f32 {
        let sine = self.along.dot(self.normal.cross(normal));
        single::atan2(sine, self.normal.dot(normal))
    }
}

/// The direction of a × b; `None` where they are within a milliradian of one line.
fn across(a: Vec3A, b: Vec3A) -> Option<Vec3A> {
    steep(a, b)?.try_normalize()
}

/// a × b; `None` where they are within a milliradian of one line.
fn steep(a: Vec3A, b: Vec3A) -> Option<Vec3A> {
    let across = a.cross(b);
    let flat = 1e-6 * a.length_squared() * b.length_squared();
    (across.length_squared() > flat).then_some(across)
}
