//! Arms of a path: one per tool, with the same joints.

use super::PathError;
use crate::arm::{Arm, Ends, QueryError};
use kinopt_kinematics::spatial::Placement;

/// The solver's arm, followed by those with other tools.
#[derive(Clone, Debug)]
pub(super) struct Tools<'a> {
    arms: Vec<&'a Arm>,
}

impl<'a> Tools<'a> {
    pub(super) fn new(arm: &'a Arm) -> Self {
        Self { arms: vec![arm] }
    }

    pub(super) fn add(&mut self, arm: &'a Arm) {
        self.arms.push(arm);
    }

    pub(super) fn primary(&self) -> &'a Arm {
        self.arms[0]
    }

    pub(super) fn arm(&self, tool: usize) -> &'a Arm {
        self.arms[tool]
    }

    pub(super) fn check(&self, tools: &[usize]) -> Result<(), PathError> {
        for (index, arm) in self.arms.iter().enumerate() {
            if !arm.joints().eq(self.primary().joints()) {
                return Err(PathError::OtherJoints(index));
            }
        }
        let unknown = tools.iter().position(|tool| *tool >= self.arms.len());
        match unknown {
            Some(index) => Err(PathError::Tool {
                index,
                tool: tools[index],
                tools: self.arms.len(),
            }),
            None => Ok(()),
        }
    }

    /// Returns true if the goal of an arm bounds the orientation.
    pub(super) fn bound_orientation(&self) -> bool {
        self.arms.iter().any(|arm| arm.goal().has_orientation())
    }

    /// Solves each target from its start with the tool of its knot.
    pub(super) fn continue_all(
        &self,
        tool_of: impl Fn(usize) -> usize,
        targets: &[Placement<f64>],
        starts: &[f64],
        ends: &mut Ends,
    ) -> Result<(), QueryError> {
        if self.arms.len() == 1 {
            return self.primary().continue_all(targets, starts, ends);
        }
        let n = self.primary().joint_count();
        let (mut all, mut part) = (Ends::default(), Ends::default());
        let mut from = 0;
        while from < targets.len() {
            let tool = tool_of(from);
            let mut to = from + 1;
            while to < targets.len() && tool_of(to) == tool {
                to += 1;
            }
            let starts = &starts[from * n..to * n];
            self.arm(tool)
                .continue_all(&targets[from..to], starts, &mut part)?;
            all.q.append(&mut part.q);
            all.outcomes.append(&mut part.outcomes);
            from = to;
        }
        *ends = all;
        Ok(())
    }
}
