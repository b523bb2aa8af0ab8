//! Derivative of the solution with respect to its targets.

use std::collections::BTreeMap;

use kinopt::arm::ArmDerivative;
use kinopt::ik::{DerivativeWorkspace, Differentiability, SolutionDerivative};
use kinopt::model::JointKind;
use kinopt::nalgebra::DMatrix;
use kinopt::problem::ProblemInstance;
use serde::Serialize;

use super::task_name::TaskName;
use crate::failure::Outcome;
use crate::loaded_model::LoadedModel;
use crate::number_format::six_digits;
use crate::table::Table;

/// Derivative of a solution by its targets.
#[derive(Clone, Debug, Serialize)]
pub(super) struct TargetDerivatives {
    /// `unique`, `shortest_of_many`, or the reason without a derivative.
    differentiability: &'static str,
    /// The differentiability in a sentence.
    explanation: String,
    /// Names of the rows: joints, and rotations of a ball joint about its own axes; radians and metres.
    velocity: Vec<String>,
    /// Matrix by frame: one row for each name in `velocity`, one column for each number of the target. A pose has
    /// columns along and about its own axes (metres, radians). A position has columns along the axes of its base.
    by_target: BTreeMap<String, Vec<Vec<f64>>>,
}

/// Derivative of a problem's solution q by its targets.
pub(super) fn of_problem(
    loaded: &LoadedModel,
    instance: ProblemInstance<'_>,
    tasks: &[TaskName],
    q: &[f64],
) -> Outcome<TargetDerivatives> {
    let mut memory = DerivativeWorkspace::default();
    let mut derivative = SolutionDerivative::new(instance, q, &mut memory)?;
    let differentiability = derivative.differentiability().clone();
    let mut by_target = BTreeMap::new();
    for task in tasks.iter().filter(|task| !task.held) {
        let name = format!("target {}", task.frame);
        let problem = instance.problem();
        let task_index =
            (0..problem.tasks()).find(|&task_index| problem.task_name(task_index) == Some(&name));
        if let Some(task_index) = task_index {
            by_target.insert(task.frame.clone(), rows(&derivative.by_target(task_index)?));
        }
    }
    let mut joints = loaded.model.moving_joints().to_vec();
    joints.dedup();
    let names = joints.iter().flat_map(|joint| {
        let joint = &loaded.model.joints()[joint.index()];
        match joint.kind {
            JointKind::Ball => ["x", "y", "z"]
                .map(|axis| format!("{} about {axis}", joint.name))
                .to_vec(),
            _ => vec![joint.name.clone()],
        }
    });
    Ok(TargetDerivatives::new(
        differentiability,
        names.collect(),
        by_target,
    ))
}

/// Derivative of an arm's solution by its target.
pub(super) fn of_arm(
    derivative: &ArmDerivative,
    joints: &[&str],
    frame: &str,
) -> TargetDerivatives {
    let by_target = BTreeMap::from([(frame.to_owned(), rows(&derivative.by_target))]);
    let names = joints.iter().map(|&joint| joint.to_owned()).collect();
    TargetDerivatives::new(derivative.differentiability.clone(), names, by_target)
}

fn rows(matrix: &DMatrix<f64>) -> Vec<Vec<f64>> {
    let rows = matrix.row_iter();
    rows.map(|row| row.iter().copied().collect()).collect()
}

impl TargetDerivatives {
    fn new(
        differentiability: Differentiability,
        velocity: Vec<String>,
        by_target: BTreeMap<String, Vec<Vec<f64>>>,
    ) -> Self {
        Self {
            differentiability: differentiability.name(),
            explanation: differentiability.to_string(),
            velocity,
            by_target,
        }
    }

    /// Differentiability, and a table of the joints that move for each target.
    pub(super) fn text(&self) -> String {
        let mut text = format!("\nDerivative by the target: {}.\n", self.explanation);
        for (frame, rows) in &self.by_target {
            let poses = rows.first().is_some_and(|row| row.len() == 6);
            let turns = match poses {
                true => "| >per rad about x | >y | >z",
                false => "",
            };
            let mut table = Table::new(&format!("by {frame} | >per m along x | >y | >z {turns}"));
            let moving = self.velocity.iter().zip(rows);
            for (name, row) in
                moving.filter(|(_, row)| row.iter().any(|derivative| *derivative != 0.0))
            {
                let mut cells = vec![name.clone()];
                cells.extend(row.iter().map(|derivative| six_digits(*derivative)));
                table.row(cells);
            }
            text.push_str(&table.text());
        }
        text
    }
}
