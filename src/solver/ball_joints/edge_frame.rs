//! Steps at the edge of a rotation set: across it, outward, and along it.

use crate::spatial::Vector3;

/// Limit that may hold a ball joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Edge {
    /// Cone of the swing.
    Swing,
    /// Upper or lower end of the twist.
    Twist {
        /// True for the upper end.
        upper: bool,
    },
    /// Largest angle from zero, radians.
    Angle(f64),
    /// Largest angle from the start, radians.
    Move(f64),
}

/// A nearby edge, a flag that is true if x is on it, and its outward normal.
#[derive(Clone, Copy, Debug)]
pub(in crate::solver) struct Near {
    pub(in crate::solver) edge: Edge,
    pub(in crate::solver) is_on: bool,
    pub(in crate::solver) normal: Vector3<f64>,
}

/// Length of a normal's part perpendicular to all other normals below which the normal is dependent.
const DEPENDENT: f64 = 1e-6;

/// Frame for steps of two or three consecutive variables at edges.
///
/// One component points across each nearby edge and along all other edges. Every edge thus holds one component, as a
/// bound does, and the rest are free.
#[derive(Clone, Copy, Debug)]
pub(in crate::solver) struct EdgeFrame {
    first: usize,
    width: usize,
    /// Displacement of the variables per unit of each component.
    ways: [Vector3<f64>; 3],
    /// Inverse of `ways`, by rows: gives the components of a displacement.
    normals: [Vector3<f64>; 3],
    near: [Option<Near>; 3],
}

impl EdgeFrame {
    /// Frame of two variables at the edge of a swing.
    pub(in crate::solver) fn of_swing(first: usize, near: Near) -> Self {
        let across = near.normal;
        let along = Vector3::new(-across.y, across.x, 0.0);
        let ways = [across, along, Vector3::zero()];
        Self {
            first,
            width: 2,
            ways,
            normals: ways,
            near: [Some(near), None, None],
        }
    }

    /// Frame of three variables at edges.
    ///
    /// The edge of a swing has the first component and that of a twist the last, as away from edges. Other edges have
    /// the remaining ones.
    pub(in crate::solver) fn of_ball(first: usize, edges: impl Iterator<Item = Near>) -> Self {
        let mut near: [Option<Near>; 3] = [None; 3];
        let mut normals = [Vector3::zero(); 3];
        // Orthonormal basis of the span of the normals.
        let mut spanned = Span::default();
        for own in edges {
            let free = |k: &usize| near[*k].is_none();
            let component = match own.edge {
                Edge::Swing => Some(0).filter(free),
                Edge::Twist { .. } => Some(2).filter(free),
                Edge::Angle(_) | Edge::Move(_) => (0..3).find(free),
            };
            if let Some(k) = component
                && spanned.take(own.normal, DEPENDENT)
            {
                (near[k], normals[k]) = (Some(own), own.normal);
            }
        }
        for k in (0..3).filter(|&k| near[k].is_none()) {
            normals[k] = spanned.take_any();
        }
        let [a, b, c] = normals;
        let crossed = [b.cross(c), c.cross(a), a.cross(b)];
        let volume = a.dot(crossed[0]);
        Self {
            first,
            width: 3,
            ways: crossed.map(|way| way * (1.0 / volume)),
            normals,
            near,
        }
    }

    /// Variables of the frame.
    pub(in crate::solver) fn variables(&self) -> std::ops::Range<usize> {
        self.first..self.first + self.width
    }

    /// Edge that a component crosses, if any.
    pub(in crate::solver) fn near(&self, component: usize) -> Option<&Near> {
        self.near[component - self.first].as_ref()
    }

    /// The frame's part of a list of variables.
    fn own(&self, values: &[f64]) -> Vector3<f64> {
        let third = if self.width == 3 {
            values[self.first + 2]
        } else {
            0.0
        };
        Vector3::new(values[self.first], values[self.first + 1], third)
    }

    fn put(&self, own: Vector3<f64>, values: &mut [f64]) {
        let own = own.to_array();
        values[self.variables()].copy_from_slice(&own[..self.width]);
    }

    /// Writes x moved by a fraction of a step.
    pub(in crate::solver) fn integrate(&self, x: &[f64], share: f64, step: &[f64], to: &mut [f64]) {
        let step = self.own(step).to_array();
        let ways = self.ways.iter().zip(step).take(self.width);
        let moved = ways.fold(self.own(x), |at, (way, step)| at + *way * (share * step));
        self.put(moved, to);
    }

    /// Writes x moved by a step of one component.
    pub(in crate::solver) fn integrate_one(
        &self,
        x: &[f64],
        component: usize,
        step: f64,
        to: &mut [f64],
    ) {
        let way = self.ways[component - self.first];
        self.put(self.own(x) + way * step, to);
    }

    /// Converts the difference of two configurations to the components of a step, in place.
    pub(in crate::solver) fn components(&self, difference: &mut [f64]) {
        let whole = self.own(difference);
        let [a, b, c] = self.normals.map(|normal| normal.dot(whole));
        self.put(Vector3::new(a, b, c), difference);
    }

    /// Converts derivatives by the variables, of `rows` rows each, to derivatives by the components.
    pub(in crate::solver) fn by_steps(&self, rows: usize, derivatives: &mut [f64]) {
        let Some(own) = derivatives.get_mut(self.first * rows..(self.first + self.width) * rows)
        else {
            return;
        };
        for row in 0..rows {
            let third = if self.width == 3 {
                own[2 * rows + row]
            } else {
                0.0
            };
            let whole = Vector3::new(own[row], own[rows + row], third);
            for (k, way) in self.ways.iter().enumerate().take(self.width) {
                own[k * rows + row] = way.dot(whole);
            }
        }
    }
}

/// Orthonormal directions, at most three.
#[derive(Clone, Copy, Debug, Default)]
struct Span {
    units: [Option<Vector3<f64>>; 3],
}

impl Span {
    /// Adds the part of a direction perpendicular to the stored ones. Returns true if it is longer than `least`.
    fn take(&mut self, direction: Vector3<f64>, least: f64) -> bool {
        let rest = self.across(direction);
        let length = rest.norm();
        let Some(room) = self.units.iter_mut().find(|unit| unit.is_none()) else {
            return false;
        };
        let is_new = length > least;
        if is_new {
            *room = Some(rest * (1.0 / length));
        }
        is_new
    }

    /// Adds and returns a unit vector perpendicular to the stored ones.
    fn take_any(&mut self) -> Vector3<f64> {
        let rests = Vector3::UNITS.map(|unit| self.across(unit));
        let [a, b, c] = rests;
        let longer = |a: Vector3<f64>, b: Vector3<f64>| if b.norm() > a.norm() { b } else { a };
        let longest = longer(longer(a, b), c);
        let unit = longest * (1.0 / longest.norm());
        self.take(unit, 0.0);
        unit
    }

    fn across(&self, direction: Vector3<f64>) -> Vector3<f64> {
        // Twice, for accuracy.
        let twice = self.units.iter().chain(&self.units).flatten();
        twice.fold(direction, |rest, unit| rest - *unit * unit.dot(rest))
    }
}
