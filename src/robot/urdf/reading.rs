//! One file being read: where faults are reported, and what is mended instead.

use std::cell::RefCell;

use super::error::{Fault, UrdfError};
use super::repair::{Mended, Repair};

/// The file's name, its text to count lines in, and what was mended so far.
#[derive(Debug)]
pub(super) struct Reading<'a> {
    pub(super) file: &'a str,
    pub(super) text: &'a str,
    pub(super) lenient: bool,
    pub(super) repairs: RefCell<Vec<Repair>>,
}

impl Reading<'_> {
    /// The line of a byte offset, from 1.
    pub(super) fn line(&self, at: usize) -> u32 {
        let before = self.text.as_bytes().iter().take(at);
        1 + before.filter(|&&byte| byte == b'\n').count() as u32
    }

    pub(super) fn fault(&self, at: usize, element: String, fault: Fault) -> UrdfError {
        UrdfError::Element {
            file: self.file.to_owned(),
            line: self.line(at),
            element,
            fault,
        }
    }

    /// Notes what was taken where the file says nothing or cannot be taken at its word.
    pub(super) fn note(&self, at: usize, element: &str, mended: Mended) {
        self.repairs.borrow_mut().push(Repair {
            line: self.line(at),
            element: element.to_owned(),
            mended,
        });
    }

    /// What is damage to a strict reader, and mended by a lenient one.
    pub(super) fn mend(
        &self,
        at: usize,
        element: &str,
        fault: Fault,
        mended: impl FnOnce(Fault) -> Mended,
    ) -> Result<(), UrdfError> {
        if !self.lenient {
            return Err(self.fault(at, element.to_owned(), fault));
        }
        self.note(at, element, mended(fault));
        Ok(())
    }

    /// Something that no joint depends on; where it is wrong it is left out, by strict readers too.
    pub(super) fn or_left_out<T>(&self, read: Result<T, UrdfError>) -> Option<T> {
        match read {
            Ok(value) => Some(value),
            // Nothing else comes from a single element.
            Err(error) => {
                let repair = Repair::left_out(error);
                self.repairs.borrow_mut().extend(repair);
                None
            }
        }
    }
}
