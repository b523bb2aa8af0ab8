//! One file being read: where faults are reported, and what is mended instead.

use std::cell::RefCell;

use super::error::{Fault, Read, RobotFileError};
use super::repair::{Mended, Repair};

/// The file's name, its text to count lines in, and what was mended so far.
#[derive(Debug)]
pub(crate) struct Reading<'a> {
    pub(crate) file: &'a str,
    pub(crate) text: &'a str,
    pub(crate) lenient: bool,
    pub(crate) repairs: RefCell<Vec<Repair>>,
}

impl Reading<'_> {
    /// The line of a byte offset, from 1.
    pub(crate) fn line(&self, at: usize) -> u32 {
        let before = self.text.as_bytes().iter().take(at);
        1 + before.filter(|&&byte| byte == b'\n').count() as u32
    }

    pub(crate) fn fault(&self, at: usize, element: String, fault: Fault) -> RobotFileError {
        RobotFileError::Element {
            file: self.file.to_owned(),
            line: self.line(at),
            element,
            fault,
        }
    }

    /// Notes what was taken where the file says nothing or cannot be taken at its word.
    pub(crate) fn note(&self, at: usize, element: &str, mended: Mended) {
        self.repairs.borrow_mut().push(Repair {
            line: self.line(at),
            element: element.to_owned(),
            mended,
        });
    }

    /// What is damage to a strict reader, and mended by a lenient one.
    pub(crate) fn mend(
        &self,
        at: usize,
        element: &str,
        fault: Fault,
        mended: impl FnOnce(Fault) -> Mended,
    ) -> Read<()> {
        if !self.lenient {
            return Err(self.fault(at, element.to_owned(), fault));
        }
        self.note(at, element, mended(fault));
        Ok(())
    }

    /// What is damage to a strict reader, and left out by a lenient one.
    pub(crate) fn leniently<T>(&self, read: Read<T>) -> Read<Option<T>> {
        match self.lenient {
            true => Ok(self.or_left_out(read)),
            false => read.map(Some),
        }
    }

    /// Something that no joint depends on; where it is wrong it is left out, by strict readers too.
    pub(crate) fn or_left_out<T>(&self, read: Read<T>) -> Option<T> {
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
