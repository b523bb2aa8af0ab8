//! Where a tool is to be, point after point.

use super::PathError;
use super::straight_way::between;
use crate::spatial::Placement;

/// How a path is gone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Traversal {
    /// From the first point to the last. The default.
    #[default]
    Open,
    /// Round and round: after the last point the first one again, in the configuration that it was begun in (a joint
    /// without limits perhaps whole turns on). The step back to the first point counts as any other.
    Cyclic,
    /// Round once from whichever point is best, and back to that one, in whatever configuration.
    AnyStart,
}

/// A path of the tool: points in the arm's base, each a `base_from_tool`, metres. Between two points the tool goes straight, and
/// turns evenly by the shorter way; of a [spline](Self::spline) it is known how far that is from the curve.
#[derive(Clone, Debug, PartialEq)]
pub struct CartesianPath {
    pub(super) points: Vec<Placement<f64>>,
    /// Empty where there are none.
    pub(super) times: Vec<f64>,
    /// The tool of every point; empty where all are for the first.
    pub(super) tools: Vec<usize>,
    /// How far a curve is from the straight step to every point, metres; empty where steps are straight.
    pub(super) bulges: Vec<f64>,
    pub(super) traversal: Traversal,
}

impl CartesianPath {
    /// A path through these points, in order.
    ///
    /// # Errors
    /// No point, or one that is not finite or not a rigid motion to 1e-6.
    pub fn new(base_from_tools: impl Into<Vec<Placement<f64>>>) -> Result<Self, PathError> {
        let points = base_from_tools.into();
        if points.is_empty() {
            return Err(PathError::Empty);
        }
        for (index, point) in points.iter().enumerate() {
            // The limit that questions to an arm have.
            let checked = point.check_rigid(0.9e-6);
            checked.map_err(|problem| PathError::Point { index, problem })?;
        }
        Ok(Self {
            points,
            times: Vec::new(),
            tools: Vec::new(),
            bulges: Vec::new(),
            traversal: Traversal::Open,
        })
    }

    /// The same path with a time for every point, seconds, each later than the one before.
    ///
    /// # Errors
    /// Another number of times than points, or a time that is not after the one before.
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

    /// The same path, whose points are for different tools: one number a point, 0 the solver's own arm, 1 and so on
    /// [those added](super::PathSolver::with_tools). Between points of different tools the path says nothing.
    ///
    /// # Errors
    /// Another number of tools than points.
    pub fn with_tools(mut self, tools: impl Into<Vec<usize>>) -> Result<Self, PathError> {
        let tools = tools.into();
        self.check_count("tools", tools.len())?;
        self.tools = tools;
        Ok(self)
    }

    setters! {
        /// The same path, gone otherwise. Default [`Traversal::Open`].
        pub fn with_traversal(mut self, traversal: Traversal) { self.traversal = traversal }
        /// The same path seen from elsewhere: every point p becomes `base_from_path` p.
        pub fn moved(mut self, base_from_path: &Placement<f64>) {
            for point in &mut self.points {
                *point = (*base_from_path * *point).made_rigid();
            }
        }
    }

    getters! {
        /// The points.
        pub fn points(&self) -> &[Placement<f64>] = &self.points;
        /// How it is gone.
        pub fn traversal(&self) -> Traversal = self.traversal;
        /// When the tool is to be at each point, seconds, where that is said.
        pub fn times(&self) -> Option<&[f64]> = Some(self.times.as_slice()).filter(|times| !times.is_empty());
        /// The [tool](Self::with_tools) of each point, where they are not all for the first.
        pub fn tools(&self) -> Option<&[usize]> = Some(self.tools.as_slice()).filter(|tools| !tools.is_empty());
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

    /// The same way with so many more points in each of the steps to these knots (rising); and which knots are those of before.
    pub(super) fn with_points_between(&self, steps: &[usize], count: usize) -> (Self, Vec<usize>) {
        let closes = self.traversal == Traversal::Cyclic && self.points.len() > 1;
        let mut finer = Self {
            points: Vec::new(),
            times: Vec::new(),
            tools: Vec::new(),
            // What the curve is beside the steps counts where all is told, which is of the points of before.
            bulges: Vec::new(),
            traversal: self.traversal,
        };
        let mut own = Vec::new();
        for knot in 0..self.points.len() + usize::from(closes) {
            let point = knot % self.points.len();
            let more = steps.binary_search(&knot).map_or(0, |_| count);
            for place in 1..=more {
                let share = place as f64 / (count + 1) as f64;
                let [from, to] = [knot - 1, point].map(|point| &self.points[point]);
                finer.points.push(between(from, to, share));
                finer.tools.extend(self.tools.get(point));
                if let [.., before, after] = self.times.get(..=knot).unwrap_or(&[]) {
                    finer.times.push(before + share * (after - before));
                }
            }
            own.push(finer.points.len());
            if knot < self.points.len() {
                finer.points.push(self.points[knot]);
                finer.tools.extend(self.tools.get(knot));
                finer.times.extend(self.times.get(knot));
            }
        }
        (finer, own)
    }

    /// The same path begun at another point of a closed one; that point comes at the end once more.
    pub(super) fn entered_at(&self, entry: usize) -> Self {
        let turned = |list: &[usize]| -> Vec<usize> {
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
                false => turned(&self.tools),
            },
            bulges,
            traversal: Traversal::Open,
        }
    }
}
