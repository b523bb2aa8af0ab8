//! Edges of the rotation sets of ball joints, and frames for steps there.

use super::edge_frame::{Edge, EdgeFrame, NearEdge};
use super::turn_limit::TurnLimit;
use crate::solver::ConfigurationSpace;
use kinopt_kinematics::spatial::Vector3;

impl<'a> ConfigurationSpace<'a> {
    /// Returns true if limits other than intervals can hold a variable.
    #[inline]
    pub(in crate::solver) fn has_edges(&self) -> bool {
        let sets = self.rotations;
        !(sets.swings.is_empty() && sets.turns.is_empty() && self.moves.is_empty())
    }

    /// Angle limits of ball joints; those from the start come last, with a flag.
    pub(in crate::solver) fn turns(&self) -> impl Iterator<Item = (&'a TurnLimit, bool)> {
        let from_zero = self.rotations.turns.iter().map(|turn| (turn, false));
        from_zero.chain(self.moves.iter().map(|turn| (turn, true)))
    }

    /// Frames of steps at nearby edges.
    #[inline]
    pub(in crate::solver) fn frames(&self, x: &[f64]) -> impl Iterator<Item = EdgeFrame> {
        // Called in every step, and most models have no ball joints.
        let edged = self.has_edges().then(|| self.frames_of_sets(x, |_| true));
        edged.into_iter().flatten()
    }

    /// Frames of the sets whose first variable is chosen.
    fn frames_of_sets(
        &self,
        x: &[f64],
        chosen: impl Fn(usize) -> bool + Copy,
    ) -> impl Iterator<Item = EdgeFrame> {
        let turned = self.turns().enumerate().filter_map(move |(k, (turn, _))| {
            if !chosen(turn.first) {
                return None;
            }
            turn.near_edge(x)?;
            let mut before = self
                .turns()
                .take(k)
                .filter(|(earlier, _)| earlier.first == turn.first);
            let is_first = before.all(|(earlier, _)| earlier.near_edge(x).is_none());
            is_first.then(|| EdgeFrame::of_ball(turn.first, self.edges_near(x, turn.first)))
        });
        let swings = self.rotations.swings.iter();
        let swings = swings.filter(move |swing| chosen(swing.first));
        let swung = swings.filter_map(|swing| {
            let near = swing.near(x)?;
            let mut turns = self.turns().filter(|(turn, _)| turn.first == swing.first);
            let is_alone = turns.all(|(turn, _)| turn.near_edge(x).is_none());
            is_alone.then(|| EdgeFrame::of_swing(swing.first, near))
        });
        turned.chain(swung)
    }

    /// Edges near a ball joint, given by its first variable.
    fn edges_near(&self, x: &[f64], first: usize) -> impl Iterator<Item = NearEdge> {
        let swings = self.rotations.swings.iter();
        let swing = swings.filter(move |swing| swing.first == first);
        let swing = swing.filter_map(|swing| swing.near(x));
        let turned = first + 2;
        let twist = [
            (x[turned] >= self.upper[turned], true),
            (x[turned] <= self.lower[turned], false),
        ];
        let twist = twist
            .into_iter()
            .filter(|(is_on, _)| *is_on)
            .map(|(_, upper)| NearEdge {
                edge: Edge::Twist { upper },
                is_on: true,
                normal: Vector3::UNITS[2] * if upper { 1.0 } else { -1.0 },
            });
        let turns = self.turns().filter(move |(turn, _)| turn.first == first);
        let turns = turns.filter_map(|(turn, is_move)| {
            let (is_on, normal) = turn.near_edge(x)?;
            let edge = match is_move {
                true => Edge::Move(turn.max_angle),
                false => Edge::Angle(turn.max_angle),
            };
            Some(NearEdge {
                edge,
                is_on,
                normal,
            })
        });
        swing.chain(twist).chain(turns)
    }

    /// Frame of a component, if edges are near.
    #[inline]
    pub(in crate::solver) fn frame_of(&self, x: &[f64], component: usize) -> Option<EdgeFrame> {
        let sets = self.rotations;
        let swing = sets.swing_of(component);
        if let Some(swing) = swing
            && sets.turns.is_empty()
            && self.moves.is_empty()
        {
            let near = swing.near(x)?;
            return Some(EdgeFrame::of_swing(swing.first, near));
        }
        if swing.is_none()
            && !self
                .turns()
                .any(|(turn, _)| turn.variables().contains(&component))
        {
            return None;
        }
        // A set has three variables at most. The near edges of all sets would cost as many operations as there are sets.
        let mut frames = self.frames_of_sets(x, |first| (first..first + 3).contains(&component));
        frames.find(|frame| frame.variables().contains(&component))
    }

    /// Converts derivatives by the variables to derivatives by the components of a step, in place.
    ///
    /// They are the columns of a Jacobian of `rows` rows, or a gradient if there is one row.
    pub(crate) fn by_steps(&self, x: &[f64], rows: usize, derivatives: &mut [f64]) {
        for frame in self.frames(x) {
            frame.by_steps(rows, derivatives);
        }
    }

    /// Largest increase of a component of a ball joint at an edge: 0 across it, else infinite; `None` away from edges.
    #[inline]
    pub(in crate::solver) fn max_increase_on_edge(
        &self,
        x: &[f64],
        component: usize,
    ) -> Option<f64> {
        // A variable with equal bounds is held by those.
        let is_movable = self.lower[component] < self.upper[component];
        let frame = self.frame_of(x, component).filter(|_| is_movable)?;
        let is_on = frame.near(component).is_some_and(|near| near.is_on);
        Some(if is_on { 0.0 } else { f64::INFINITY })
    }

    /// First variable of a ball joint at the edge of one of its angle limits.
    pub(crate) fn ball_at_angle_limit(&self, x: &[f64]) -> Option<usize> {
        let mut turns = self.turns().map(|(turn, _)| turn);
        let turn_on_edge = turns.find(|turn| turn.near_edge(x).is_some_and(|(is_on, _)| is_on));
        turn_on_edge.map(|turn| turn.first)
    }

    /// Edge that a component crosses, if one is near.
    pub(crate) fn edge_at(&self, x: &[f64], component: usize) -> Option<Edge> {
        let frame = self.frame_of(x, component)?;
        frame.near(component).map(|near| near.edge)
    }

    /// Returns true if a ball joint's three variables are within its bounds and cone, and if required its largest
    /// angle.
    pub(in crate::solver) fn keeps(
        &self,
        first: usize,
        values: [f64; 3],
        checks_angle: bool,
    ) -> bool {
        let bounds = self.lower[first..].iter().zip(&self.upper[first..]);
        let mut swings = self.rotations.swings.iter();
        let mut turns = self.rotations.turns.iter();
        values
            .iter()
            .zip(bounds)
            .all(|(v, (lower, upper))| lower <= v && v <= upper)
            && swings.all(|swing| swing.first != first || swing.holds([values[0], values[1]]))
            && (!checks_angle || turns.all(|turn| turn.first != first || turn.is_within(values)))
    }
}
