//! Cartesian path of a tool.

use super::PathError;
use super::linear_segment::interpolate;
use kinopt_kinematics::spatial::{Placement, Vector3};

/// Order in which the points of a path are visited.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Traversal {
    /// From the first point to the last. This is the default.
    #[default]
    Open,
    /// Repeatedly: the last point is followed by the first, in its initial configuration.
    ///
    /// A joint without limits may end whole revolutions further. The step back to the first point counts like any
    /// other.
    Cyclic,
    /// Once around, from the best point back to that point, in any configuration.
    AnyStart,
}

/// Cartesian path: points in the base frame of the arm, each a `base_from_tool`, metres.
///
/// Between two points the tool moves linearly and rotates at a constant rate by the smaller angle. Arcs and splines also
/// store their distance from these segments.
///
/// A path is a list of points, or begins at one point and continues by segments:
///
/// ```
/// use kinopt::motion::path::CartesianPath;
/// use kinopt::spatial::{Placement, Vector3};
///
/// let at = |x, y, z| Placement::translation(Vector3::new(x, y, z));
/// let path = CartesianPath::new([at(0.4, 0.0, 0.5)])?
///     .through(&[at(0.4, 0.0, 0.3), at(0.4, 0.2, 0.3)], 0.01)?
///     .arc_through([0.5, 0.3, 0.3], at(0.4, 0.4, 0.3), 0.01)?
///     .spline_through(&[at(0.3, 0.5, 0.4), at(0.3, 0.4, 0.5)], 0.01)?;
/// assert_eq!(path.points().last(), Some(&at(0.3, 0.4, 0.5)));
/// # Ok::<(), kinopt::motion::path::PathError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct CartesianPath {
    pub(super) points: Vec<Placement<f64>>,
    /// Times of the points, seconds; empty if the path has no times.
    pub(super) times: Vec<f64>,
    /// Tool index of every point; empty if all points use tool 0.
    pub(super) tools: Vec<usize>,
    /// Bound on the distance of the curve from the straight step to every point, metres; empty for straight steps.
    pub(super) bulges: Vec<f64>,
    pub(super) traversal: Traversal,
    /// False if the points are positions, whose rotations have no meaning.
    pub(super) oriented: bool,
}

impl CartesianPath {
    /// Creates a path through these points, in order.
    ///
    /// # Errors
    /// Returns an error if there is no point, or if a point is not finite or not rigid to 1e-6.
    pub fn new(base_from_tools: impl Into<Vec<Placement<f64>>>) -> Result<Self, PathError> {
        let points = base_from_tools.into();
        if points.is_empty() {
            return Err(PathError::Empty);
        }
        for (index, point) in points.iter().enumerate() {
            // The limit that arm queries use.
            let checked = point.check_rigid(0.9e-6);
            checked.map_err(|problem| PathError::Point { index, problem })?;
        }
        Ok(Self {
            points,
            times: Vec::new(),
            tools: Vec::new(),
            bulges: Vec::new(),
            traversal: Traversal::Open,
            oriented: true,
        })
    }

    /// Creates a path through positions in the base, metres, for arms whose goal leaves the orientation free.
    ///
    /// # Errors
    /// Returns an error if there is no position, or if a position is not finite.
    pub fn of_positions(
        positions: impl IntoIterator<Item = Vector3<f64>>,
    ) -> Result<Self, PathError> {
        let points = positions.into_iter().map(Placement::translation);
        let path = Self::new(points.collect::<Vec<_>>())?;
        Ok(Self {
            oriented: false,
            ..path
        })
    }

    /// Sets a time for every point, seconds. Times must increase.
    ///
    /// # Errors
    /// Returns an error if the count differs from that of the points, or if times do not increase.
    pub fn with_times(mut self, seconds: impl Into<Vec<f64>>) -> Result<Self, PathError> {
        let times = seconds.into();
        self.check_count("times", times.len())?;
        let mut before = f64::NEG_INFINITY;
        for (index, &value) in times.iter().enumerate() {
            if !(value.is_finite() && value > before) {
                return Err(PathError::Time {
                    index,
                    value,
                    before,
                });
            }
            before = value;
        }
        self.times = times;
        Ok(self)
    }

    /// Sets the tool index of every point. Index 0 is the solver's arm, 1 and up are [added
    /// tools](super::PathSolver::with_tools).
    ///
    /// Steps between points of different tools are not constrained by the path.
    ///
    /// # Errors
    /// Returns an error if the count differs from that of the points.
    pub fn with_tools(mut self, tools: impl Into<Vec<usize>>) -> Result<Self, PathError> {
        let tools = tools.into();
        self.check_count("tools", tools.len())?;
        self.tools = tools;
        Ok(self)
    }

    /// Sets the traversal. Default [`Traversal::Open`].
    #[must_use]
    pub fn with_traversal(mut self, traversal: Traversal) -> Self {
        self.traversal = traversal;
        self
    }

    /// Transforms the path: every point p becomes `base_from_path` p.
    #[must_use]
    pub fn moved(self, base_from_path: &Placement<f64>) -> Self {
        self.map_points(|point| (*base_from_path * point).made_rigid())
    }

    /// Replaces every point by a rigid placement.
    #[doc(hidden)]
    #[must_use]
    pub fn map_points(mut self, map: impl Fn(Placement<f64>) -> Placement<f64>) -> Self {
        for point in &mut self.points {
            *point = map(*point);
        }
        self
    }

    /// Points, `base_from_tool`.
    #[must_use]
    pub fn points(&self) -> &[Placement<f64>] {
        &self.points
    }

    /// Order in which the points are visited.
    #[must_use]
    pub fn traversal(&self) -> Traversal {
        self.traversal
    }

    /// Times of the points, seconds, if the path has times.
    #[must_use]
    pub fn times(&self) -> Option<&[f64]> {
        Some(self.times.as_slice()).filter(|times| !times.is_empty())
    }

    /// [Tool index](Self::with_tools) of each point, or `None` if all points use tool 0.
    #[must_use]
    pub fn tools(&self) -> Option<&[usize]> {
        Some(self.tools.as_slice()).filter(|tools| !tools.is_empty())
    }

    /// Bounds on the distance of the curve from the straight step to each point, metres; empty for straight steps.
    #[doc(hidden)]
    #[must_use]
    pub fn bulges(&self) -> &[f64] {
        &self.bulges
    }

    /// Sets the bounds of another path with the same points; none for straight steps.
    #[doc(hidden)]
    pub fn with_bulges(mut self, bulges: Vec<f64>) -> Result<Self, PathError> {
        if !bulges.is_empty() {
            self.check_count("bulges", bulges.len())?;
        }
        self.bulges = bulges;
        Ok(self)
    }

    fn check_count(&self, what: &'static str, given: usize) -> Result<(), PathError> {
        match given == self.points.len() {
            true => Ok(()),
            false => Err(PathError::Count {
                what,
                given,
                points: self.points.len(),
            }),
        }
    }

    /// Inserts `count` points into each of the steps to these knots (ascending). Also returns the new indices of the
    /// old knots.
    pub(super) fn with_points_between(&self, steps: &[usize], count: usize) -> (Self, Vec<usize>) {
        let closes = self.traversal == Traversal::Cyclic && self.points.len() > 1;
        let mut finer = Self {
            points: Vec::new(),
            times: Vec::new(),
            tools: Vec::new(),
            // The distances of the curve are only used for the report, which uses the original points.
            bulges: Vec::new(),
            traversal: self.traversal,
            oriented: self.oriented,
        };
        let mut knot_indices = Vec::new();
        for knot in 0..self.points.len() + usize::from(closes) {
            let point = knot % self.points.len();
            let inserted = steps.binary_search(&knot).map_or(0, |_| count);
            for k in 1..=inserted {
                let fraction = k as f64 / (count + 1) as f64;
                let [from, to] = [knot - 1, point].map(|point| &self.points[point]);
                finer.points.push(interpolate(from, to, fraction));
                finer.tools.extend(self.tools.get(point));
                if let [.., before, after] = self.times.get(..=knot).unwrap_or(&[]) {
                    finer.times.push(before + fraction * (after - before));
                }
            }
            knot_indices.push(finer.points.len());
            if knot < self.points.len() {
                finer.points.push(self.points[knot]);
                finer.tools.extend(self.tools.get(knot));
                finer.times.extend(self.times.get(knot));
            }
        }
        (finer, knot_indices)
    }

    /// Rotates a closed path to begin at another point, which is repeated at the end.
    pub(super) fn entered_at(&self, entry: usize) -> Self {
        let rotated = |list: &[usize]| -> Vec<usize> {
            let mut list = list.to_vec();
            list.rotate_left(entry);
            list.extend(list.first().copied());
            list
        };
        let mut points = self.points.clone();
        points.rotate_left(entry);
        points.extend(points.first().copied());
        let mut bulges = self.bulges.clone();
        if !bulges.is_empty() {
            bulges.rotate_left(entry);
            // The step to the first point comes last.
            bulges.extend(bulges.first().copied());
        }
        Self {
            points,
            times: Vec::new(),
            tools: match self.tools.is_empty() {
                true => Vec::new(),
                false => rotated(&self.tools),
            },
            bulges,
            traversal: Traversal::Open,
            oriented: self.oriented,
        }
    }
}
