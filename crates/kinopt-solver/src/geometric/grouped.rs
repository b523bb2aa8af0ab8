//! Lists of numbers by group, stored in two vectors (compressed sparse rows).

/// Some numbers for each group, in the order of insertion.
pub(super) struct Grouped {
    /// Start of each group's members, followed by the end of the last.
    starts: Vec<usize>,
    members: Vec<usize>,
}

impl Grouped {
    /// Groups from pairs of (group, member); groups are below `groups`.
    pub(super) fn new(groups: usize, pairs: &[(usize, usize)]) -> Self {
        // Counted two entries ahead, so that filling the members moves each start to its final value.
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
