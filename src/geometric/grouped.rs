//! Which things belong to which group, in two lists instead of one a group: a method makes them for every question.

/// Some numbers for each group, in the order in which they were given.
pub(super) struct Grouped {
    /// Where each group's members begin; one more for the end.
    starts: Vec<usize>,
    members: Vec<usize>,
}

impl Grouped {
    /// From pairs of (group, member), the groups being below `groups`.
    pub(super) fn new(groups: usize, pairs: &[(usize, usize)]) -> Self {
        // A group's members are counted two places on, so that placing them moves its start to where it belongs.
        let mut starts = vec![0; groups + 2];
        for &(group, _) in pairs {
            starts[group + 2] += 1;
        }
        for group in 2..starts.len() {
            starts[group] += starts[group - 1];
        }
        let mut members = vec![0; pairs.len()];
        for &(group, member) in pairs {
            members[starts[group + 1]] = member;
            starts[group + 1] += 1;
        }
        starts.pop();
        Self { starts, members }
    }

    pub(super) fn groups(&self) -> usize {
        self.starts.len() - 1
    }

    pub(super) fn of(&self, group: usize) -> &[usize] {
        &self.members[self.starts[group]..self.starts[group + 1]]
    }
}
