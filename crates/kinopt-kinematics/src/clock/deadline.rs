//! Collision checks that end at a deadline.
//!
//! The distances of shapes are computed far below the searches that have a deadline. What such a computation leaves unfinished must
//! not be taken for a result, so whoever sets the deadline gets no result then.

use std::cell::Cell;

use super::{Instant, is_past};
use crate::scoped_cell::with_value;

/// Deadline of the work under way on this thread, and whether it ended early.
#[derive(Clone, Copy)]
struct CurrentWork {
    deadline: Instant,
    is_cut: bool,
}

thread_local! {
    static WORK: Cell<Option<CurrentWork>> = const { Cell::new(None) };
}

/// Runs `work`, whose parts end early once [`is_over`] returns true; `None` if one did, or if the deadline was past before.
#[doc(hidden)]
pub fn until<T>(deadline: Option<Instant>, work: impl FnOnce() -> T) -> Option<T> {
    let Some(time) = deadline else {
        return Some(work());
    };
    if is_past(deadline) {
        return None;
    }
    let initial = CurrentWork {
        deadline: time,
        is_cut: false,
    };
    with_value(&WORK, Some(initial), || {
        let result = work();
        let is_cut = WORK.get().is_some_and(|work| work.is_cut);
        (!is_cut).then_some(result)
    })
}

/// Returns true if the deadline is past.
#[inline]
#[doc(hidden)]
pub fn is_over() -> bool {
    let Some(work) = WORK.get() else {
        return false;
    };
    if work.is_cut {
        return true;
    }
    let is_cut = is_past(Some(work.deadline));
    WORK.set(Some(CurrentWork { is_cut, ..work }));
    is_cut
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::{is_over, until};
    use crate::clock::Instant;

    #[test]
    fn work_past_its_deadline_is_not_begun() {
        let mut runs = 0;
        assert_eq!(until(Some(Instant::now()), || runs += 1), None);
        assert_eq!(until(None, || runs += 1), Some(()));
        assert_eq!(runs, 1);
    }

    #[test]
    fn work_cut_short_has_no_result() {
        let soon = Instant::now().checked_add(Duration::from_millis(2));
        let mut looks = 0_u64;
        let work = || {
            while !is_over() {
                looks += 1;
            }
            looks
        };
        assert_eq!(until(soon, work), None);
        assert!(looks > 0 && !is_over());
    }

    #[test]
    fn work_within_its_time_has_its_result() {
        let later = Instant::now().checked_add(Duration::from_secs(3600));
        assert_eq!(until(later, is_over), Some(false));
        assert!(!is_over());
    }
}
