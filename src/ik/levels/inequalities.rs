//! The rooms of goals above a rank: inequalities to what that rank may do.
//!
//! Within its room a reached goal costs nothing, so that it holds only what would lead it out: each edge is the
//! inequality depth(x) ≥ 0, in the model of a step by its slope, and works like an equation while its multiplier pushes
//! against it (Nocedal & Wright 2006, sections 16.5 and 18.1). An edge that a missed rank in between pushes against is
//! one: it stands there for that rank's sake.

use nalgebra::DMatrix;

use super::descent_problem::DescentProblem;
use super::held_ranks::HeldRank;
use crate::buffer::refill;
use crate::problem::Share;
use crate::solver::Inequalities;

/// An edge of a room.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Edge {
    pub(super) rank: usize,
    /// Whether it is of a reached rank that has come to be within the room; its rows are equations otherwise.
    pub(super) counts: bool,
    /// The least depth allowed: 0, or where it was found beyond that within its tolerance.
    pub(super) least: f64,
    /// How much of depth counts as none.
    pub(super) slack: f64,
    /// Whether a missed rank stands on it.
    pub(super) locked: bool,
    /// Whether it holds the rank now, …
    pub(super) works: bool,
    /// … the last step's model came to rest on it, …
    pub(super) rests: bool,
    /// … a trial is to end on it, or has crossed it.
    pub(super) stands: bool,
    pub(super) joins: bool,
}

impl Edge {
    /// Whether it holds like an equation.
    fn holds(&self) -> bool {
        self.counts && (self.locked || self.works)
    }
}

/// The rooms above one rank.
#[derive(Clone, Debug, Default)]
pub(super) struct Rooms {
    pub(super) edges: Vec<Edge>,
    /// By row of the residual: whether its room's edges stand for it.
    pub(super) replaced: Vec<bool>,
    /// How deep within each edge it is where the rank stands, with the slopes there, and at a trial.
    pub(super) depths: Vec<f64>,
    pub(super) jacobian: DMatrix<f64>,
    /// How much of it a step may take.
    down: Vec<f64>,
    pub(super) depths_there: Vec<f64>,
    pub(super) jacobian_there: DMatrix<f64>,
}

impl Rooms {
    /// Makes room for so many edges of a problem's variables, and rows.
    pub(super) fn fit(&mut self, edges: usize, rows: usize, variables: usize) {
        refill(&mut self.edges, edges, Edge::default());
        refill(&mut self.replaced, rows, false);
        for depths in [&mut self.depths, &mut self.depths_there] {
            depths.resize(edges, 0.0);
        }
        for jacobian in [&mut self.jacobian, &mut self.jacobian_there] {
            if jacobian.shape() != (edges, variables) {
                *jacobian = DMatrix::zeros(edges, variables);
            }
        }
    }

    /// How many edges there are.
    pub(super) fn len(&self) -> usize {
        self.edges.len()
    }

    /// Learns which edges count from x on.
    pub(super) fn take(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        ranks: &[HeldRank],
        x: &[f64],
    ) {
        self.edges.fill(Edge::default());
        self.replaced.fill(false);
        if self.edges.is_empty() {
            return;
        }
        descent.depths(Share::above(ranks.len()), x, &mut self.depths);
        for room in descent.question.problem.rooms_above(ranks.len()) {
            let reached = ranks
                .iter()
                .any(|held| held.rank == room.rank && held.reached);
            let depths = &self.depths[room.edges.clone()];
            let counts = reached && depths.iter().all(|depth| *depth >= -2.0 * room.tolerance);
            for (edge, depth) in self.edges[room.edges].iter_mut().zip(depths) {
                *edge = Edge {
                    rank: room.rank,
                    counts,
                    least: depth.min(0.0),
                    slack: room.kept_within,
                    ..Edge::default()
                };
            }
            self.replaced[room.rows].fill(counts);
        }
    }

    /// Whether any edge counts.
    pub(super) fn any(&self) -> bool {
        self.edges.iter().any(|edge| edge.counts)
    }

    /// Takes the depths and their slopes at x, where the rank stands.
    pub(super) fn stand(&mut self, descent: &mut DescentProblem<'_, '_>, rank: usize, x: &[f64]) {
        let share = Share::above(rank);
        descent.depths(share, x, &mut self.depths);
        descent.depth_jacobian(share, x, &mut self.jacobian);
    }

    /// How far from its least depth it is.
    fn gap(&self, edge: usize) -> f64 {
        self.depths[edge] - self.edges[edge].least
    }

    /// Whether the rank stands on an edge, and it is no missed rank's.
    pub(super) fn may_work(&self, edge: usize) -> bool {
        let own = self.edges[edge];
        own.counts && !own.locked && self.gap(edge) <= own.slack
    }

    /// Lets all edges work that it stands on and, if there was a step, its model came to rest on.
    pub(super) fn work(&mut self, has_stepped: bool) {
        for edge in 0..self.edges.len() {
            let works = self.may_work(edge) && (!has_stepped || self.edges[edge].rests);
            self.edges[edge].works = works;
        }
    }

    /// Whether any edge works.
    pub(super) fn any_works(&self) -> bool {
        self.edges.iter().any(|edge| edge.works)
    }

    /// Lets go of the edge that is pulled away from hardest, by the edges' multipliers; which one that was.
    pub(super) fn let_go(&mut self, multipliers: &[f64]) -> Option<usize> {
        let working = (0..self.edges.len()).filter(|&edge| self.edges[edge].works);
        let pulls = working.map(|edge| (edge, multipliers[edge] * self.jacobian.row(edge).norm()));
        let inward = pulls.filter(|(_, pull)| *pull > 0.0);
        let (edge, _) = inward.max_by(|a, b| a.1.total_cmp(&b.1))?;
        self.edges[edge].works = false;
        Some(edge)
    }

    /// The edges that a missed rank stands on, of goals of one rank.
    pub(super) fn locked_of(&self, rank: usize) -> impl Iterator<Item = usize> {
        let edges = self.edges.iter().enumerate();
        let locked = edges.filter(move |(_, edge)| edge.rank == rank && edge.locked);
        locked.map(|(edge, _)| edge)
    }

    /// The edges that hold, of goals of one rank.
    pub(super) fn holding_of(&self, rank: usize) -> impl Iterator<Item = usize> {
        let edges = self.edges.iter().enumerate();
        let holding = edges.filter(move |(_, edge)| edge.rank == rank && edge.holds());
        holding.map(|(edge, _)| edge)
    }

    /// Locks an edge where it stands.
    pub(super) fn lock(&mut self, edge: usize) {
        self.edges[edge].locked = true;
        self.edges[edge].least = self.depths[edge];
    }

    /// The edges that work, which are no missed rank's.
    pub(super) fn working(&self) -> impl Iterator<Item = usize> {
        let edges = self.edges.iter().enumerate();
        edges.filter(|(_, edge)| edge.works).map(|(edge, _)| edge)
    }

    /// Completes the rows that hold a rank, whose residual's come first: edges stand for the rows of their rooms.
    pub(super) fn complete(&self, residual: &DMatrix<f64>, whole: &mut DMatrix<f64>) {
        self.write(residual, &self.jacobian, Edge::holds, whole);
    }

    pub(super) fn write(
        &self,
        residual: &DMatrix<f64>,
        edges: &DMatrix<f64>,
        holds: impl Fn(&Edge) -> bool,
        whole: &mut DMatrix<f64>,
    ) {
        let rows = self.replaced.len();
        let from = residual.as_slice().chunks_exact(rows.max(1));
        let slopes = edges.as_slice().chunks_exact(self.edges.len().max(1));
        let to = whole
            .as_mut_slice()
            .chunks_exact_mut(rows + self.edges.len());
        for ((to, from), slopes) in to.zip(from).zip(slopes) {
            for ((to, from), replaced) in to.iter_mut().zip(from).zip(&self.replaced) {
                *to = if *replaced { 0.0 } else { *from };
            }
            for ((to, slope), edge) in to[rows..].iter_mut().zip(slopes).zip(&self.edges) {
                *to = if holds(edge) { *slope } else { 0.0 };
            }
        }
    }

    /// The inequalities of a step's model: all edges but those that it keeps to anyway.
    pub(super) fn inequalities(&mut self, keeps_working: bool) -> Inequalities<'_> {
        let depths = self.edges.iter().zip(&self.depths);
        let down = depths.map(|(edge, depth)| {
            let kept = edge.locked || (keeps_working && edge.works);
            match edge.counts && !kept {
                true => (depth - edge.least).max(0.0),
                false => f64::INFINITY,
            }
        });
        self.down.clear();
        self.down.extend(down);
        Inequalities {
            rows: &self.jacobian,
            down: &self.down,
        }
    }

    /// Takes the part of edges that work out of a slope: to a step's model they are inequalities.
    pub(super) fn take_out(&self, multipliers: &[f64], slope: &mut [f64]) {
        for edge in self.working() {
            let row = self.jacobian.row(edge);
            for (slope, entry) in slope.iter_mut().zip(row.iter()) {
                *slope -= multipliers[edge] * entry;
            }
        }
    }
}
