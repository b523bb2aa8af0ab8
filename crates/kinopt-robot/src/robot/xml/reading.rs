//! State of reading one file: text, options and repairs.

use std::cell::RefCell;

use super::error::{ParseIssue, Read, RobotFileError};
use super::repair::{Repair, RepairKind};

/// A file that is being read: name, text, leniency, and repairs so far.
#[derive(Debug)]
pub(crate) struct Reading<'a> {
    pub(crate) file: &'a str,
    pub(crate) text: &'a str,
    pub(crate) lenient: bool,
    pub(crate) repairs: RefCell<Vec<Repair>>,
}

impl Reading<'_> {
    /// Line of a byte offset, from 1.
    pub(crate) fn line(&self, offset: usize) -> u32 {
        let before = self.text.as_bytes().iter().take(offset);
        1 + before.filter(|&&byte| byte == b'\n').count() as u32
    }

    pub(crate) fn fault(
        &self,
        offset: usize,
        element: String,
        fault: ParseIssue,
    ) -> RobotFileError {
        RobotFileError::Element {
            file: self.file.to_owned(),
            line: self.line(offset),
            element,
            fault,
        }
    }

    /// Adds a repair to the list.
    pub(crate) fn note(&self, offset: usize, element: &str, kind: RepairKind) {
        self.repairs.borrow_mut().push(Repair {
            line: self.line(offset),
            element: element.to_owned(),
            mended: kind,
        });
    }

    /// Returns a fault as an error if the reader is strict; a lenient reader notes the repair instead.
    pub(crate) fn repair_or_fail(
        &self,
        offset: usize,
        element: &str,
        fault: ParseIssue,
        repair: impl FnOnce(ParseIssue) -> RepairKind,
    ) -> Read<()> {
        if !self.lenient {
            return Err(self.fault(offset, element.to_owned(), fault));
        }
        self.note(offset, element, repair(fault));
        Ok(())
    }

    /// Returns errors if the reader is strict; a lenient reader notes them and returns `None`.
    pub(crate) fn leniently<T>(&self, read: Read<T>) -> Read<Option<T>> {
        match self.lenient {
            true => Ok(self.or_left_out(read)),
            false => read.map(Some),
        }
    }

    /// Notes an error as a repair and returns `None`, for elements that no joint depends on. Strict readers do so too.
    pub(crate) fn or_left_out<T>(&self, read: Read<T>) -> Option<T> {
        match read {
            Ok(value) => Some(value),
            // All errors of single elements convert to a repair.
            Err(error) => {
                let repair = Repair::left_out(error);
                self.repairs.borrow_mut().extend(repair);
                None
            }
        }
    }
}
