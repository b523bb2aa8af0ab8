//! Steps at the edge of a rotation set: across it, outward, and along it.

use kinopt_kinematics::spatial::Vector3;

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
pub(in crate::solver) struct NearEdge {
    pub(in crate::solver) edge: Edge,
    pub(in crate::solver) is_on: bool,
    pub(in crate::solver) normal: Vector3<f64>,
}

/// Length of a normal's part perpendicular to all other normals below which the normal is dependent.
const MIN_INDEPENDENT_LENGTH: f64 = 1e-6;

/// Frame for steps of two or three consecutive variables at edges.
///
/// One component points across each nearby edge and along all other edges. Every edge thus holds one component, as a
/// bound does, and the rest are free.
#[derive(Clone, Copy, Debug)]
pub(in crate::solver) struct EdgeFrame {
    first: usize,
    width: usize,
    /// Displacement of the variables per unit of each component.
    directions: [Vector3<f64>; 3],
    /// Inverse of `directions`, by rows: gives the components of a displacement.
    normals: [Vector3<f64>; 3],
    near_edges: [Option<NearEdge>; 3],
}

impl EdgeFrame {
    /// Frame of two variables at the edge of a swing.
    pub(in crate::solver) fn of_swing(first: usize, near_edge: NearEdge) -> Self {
        let normal = near_edge.normal;
        let tangent = Vector3::new(-normal.y, normal.x, 0.0);
        let directions = [normal, tangent, Vector3::zero()];
        Self {
            first,
            width: 2,
            directions,
            normals: directions,
            near_edges: [Some(near_edge), None, None],
        }
    }

    /// Frame of three variables at edges.
    ///
    /// The edge of a swing has the first component and that of a twist the last, as away from edges. Other edges have
    /// the remaining ones.
    pub(in crate::solver) fn of_ball(first: usize, edges: impl Iterator<Item = NearEdge>) -> Self {
        let mut near_edges: [Option<NearEdge>; 3] = [None; 3];
        let mut normals = [Vector3::zero(); 3];
        // Orthonormal basis of the span of the normals.
        let mut span = DirectionSpan::default();
        for near_edge in edges {
            let is_free = |k: &usize| near_edges[*k].is_none();
            let component = match near_edge.edge {
                Edge::Swing => Some(0).filter(is_free),
                Edge::Twist { .. } => Some(2).filter(is_free),
                Edge::Angle(_) | Edge::Move(_) => (0..3).find(is_free),
            };
            if let Some(k) = component
                && span.add(near_edge.normal, MIN_INDEPENDENT_LENGTH)
            {
                (near_edges[k], normals[k]) = (Some(near_edge), near_edge.normal);
            }
        }
        for k in (0..3).filter(|&k| near_edges[k].is_none()) {
            normals[k] = span.add_any();
        }
        let [a, b, c] = normals;
        let cross_products = [b.cross(c), c.cross(a), a.cross(b)];
        let volume = a.dot(cross_products[0]);
        Self {
            first,
            width: 3,
            directions: cross_products.map(|cross_product| cross_product * (1.0 / volume)),
            normals,
            near_edges,
        }
    }

    /// Variables of the frame.
    pub(in crate::solver) fn variables(&self) -> std::ops::Range<usize> {
        self.first..self.first + self.width
    }

    /// Edge that a component crosses, if any.
    pub(in crate::solver) fn near(&self, component: usize) -> Option<&NearEdge> {
        self.near_edges[component - self.first].as_ref()
    }

    /// The frame's part of a list of variables.
    fn vector_of(&self, values: &[f64]) -> Vector3<f64> {
        let last = if self.width == 3 {
            values[self.first + 2]
        } else {
            0.0
        };
        Vector3::new(values[self.first], values[self.first + 1], last)
    }

    fn write(&self, vector: Vector3<f64>, values: &mut [f64]) {
        let vector = vector.to_array();
        values[self.variables()].copy_from_slice(&vector[..self.width]);
    }

    /// Writes x moved by a fraction of a step.
    pub(in crate::solver) fn integrate(
        &self,
        x: &[f64],
        fraction: f64,
        step: &[f64],
        moved_x: &mut [f64],
    ) {
        let step = self.vector_of(step).to_array();
        let directions = self.directions.iter().zip(step).take(self.width);
        let result = directions.fold(self.vector_of(x), |sum, (direction, step)| {
            sum + *direction * (fraction * step)
        });
        self.write(result, moved_x);
    }

    /// Writes x moved by a step of one component.
    pub(in crate::solver) fn integrate_one(
        &self,
        x: &[f64],
        component: usize,
        step: f64,
        moved_x: &mut [f64],
    ) {
        let direction = self.directions[component - self.first];
        self.write(self.vector_of(x) + direction * step, moved_x);
    }

    /// Converts the difference of two configurations to the components of a step, in place.
    pub(in crate::solver) fn components(&self, difference: &mut [f64]) {
        let vector = self.vector_of(difference);
        let [a, b, c] = self.normals.map(|normal| normal.dot(vector));
        self.write(Vector3::new(a, b, c), difference);
    }

    /// Converts derivatives by the variables, of `rows` rows each, to derivatives by the components.
    pub(in crate::solver) fn by_steps(&self, rows: usize, derivatives: &mut [f64]) {
        let Some(block) = derivatives.get_mut(self.first * rows..(self.first + self.width) * rows)
        else {
            return;
        };
        for row in 0..rows {
            let last = if self.width == 3 {
                block[2 * rows + row]
            } else {
                0.0
            };
            let vector = Vector3::new(block[row], block[rows + row], last);
            for (k, direction) in self.directions.iter().enumerate().take(self.width) {
                block[k * rows + row] = direction.dot(vector);
            }
        }
    }
}

/// Orthonormal directions, at most three.
#[derive(Clone, Copy, Debug, Default)]
struct DirectionSpan {
    units: [Option<Vector3<f64>>; 3],
}

impl DirectionSpan {
    /// Adds the part of a direction perpendicular to the stored ones. Returns true if it is longer than `min_length`.
    fn add(&mut self, direction: Vector3<f64>, min_length: f64) -> bool {
        let remainder = self.perpendicular_part(direction);
        let length = remainder.norm();
        let Some(slot) = self.units.iter_mut().find(|unit| unit.is_none()) else {
            return false;
        };
        let is_independent = length > min_length;
        if is_independent {
            *slot = Some(remainder * (1.0 / length));
        }
        is_independent
    }

    /// Adds and returns a unit vector perpendicular to the stored ones.
    fn add_any(&mut self) -> Vector3<f64> {
        let remainders = Vector3::UNITS.map(|unit| self.perpendicular_part(unit));
        let [a, b, c] = remainders;
        let longer = |a: Vector3<f64>, b: Vector3<f64>| if b.norm() > a.norm() { b } else { a };
        let longest = longer(longer(a, b), c);
        let unit = longest * (1.0 / longest.norm());
        self.add(unit, 0.0);
        unit
    }

    fn perpendicular_part(&self, direction: Vector3<f64>) -> Vector3<f64> {
        // Twice, for accuracy.
        let twice = self.units.iter().chain(&self.units).flatten();
        twice.fold(direction, |remainder, unit| {
            remainder - *unit * unit.dot(remainder)
        })
    }
}
