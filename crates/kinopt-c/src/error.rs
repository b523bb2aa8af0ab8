//! Status codes, and the message of the last error of a thread.

use std::cell::RefCell;
use std::ffi::{CString, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};

use kinopt_bindings::json::JsonError;
use kinopt_bindings::{Classify, ErrorKind};

use crate::pointer::kept_text;

/// Result of a function.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KinoptStatus {
    /// Success; also for a target that is not reached.
    Ok = 0,
    /// An invalid argument: null, a wrong length, a number out of range, text that is not UTF-8.
    InvalidValue = 1,
    /// An unknown name of a frame, joint, task or option.
    UnknownName = 2,
    /// A file with invalid content.
    InvalidFile = 3,
    /// A file that cannot be read.
    File = 4,
    /// A defect of the library.
    Internal = 5,
}

impl From<ErrorKind> for KinoptStatus {
    fn from(kind: ErrorKind) -> Self {
        match kind {
            ErrorKind::InvalidValue => Self::InvalidValue,
            ErrorKind::UnknownName => Self::UnknownName,
            ErrorKind::InvalidFile => Self::InvalidFile,
            ErrorKind::File => Self::File,
        }
    }
}

/// An error with its status and message.
pub(crate) struct Failure {
    status: KinoptStatus,
    message: String,
}

impl Failure {
    /// An invalid argument.
    pub(crate) fn invalid(message: String) -> Self {
        Self {
            status: KinoptStatus::InvalidValue,
            message,
        }
    }
}

impl<E: Classify> From<E> for Failure {
    fn from(error: E) -> Self {
        Self {
            status: error.kind().into(),
            message: error.to_string(),
        }
    }
}

/// Not an implementation of `From`, which would overlap with that of the library's errors.
pub(crate) fn of_json(error: JsonError) -> Failure {
    Failure {
        status: error.kind.into(),
        message: error.message,
    }
}

thread_local! {
    static MESSAGE: RefCell<CString> = RefCell::default();
}

/// Text of the last error of the calling thread; empty without one. It is valid until the next call of this thread that
/// fails.
#[unsafe(no_mangle)]
pub extern "C" fn kinopt_error_message() -> *const c_char {
    MESSAGE.with_borrow(|message| message.as_ptr())
}

/// Version of the library, such as "0.1.0".
#[unsafe(no_mangle)]
pub extern "C" fn kinopt_version() -> *const c_char {
    concat!(env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast()
}

/// Runs a function of the interface: stores the message of an error, and turns a panic into a status.
pub(crate) fn guard(run: impl FnOnce() -> Result<(), Failure>) -> KinoptStatus {
    let failure = match catch_unwind(AssertUnwindSafe(run)) {
        Ok(Ok(())) => return KinoptStatus::Ok,
        Ok(Err(failure)) => failure,
        Err(_) => Failure {
            status: KinoptStatus::Internal,
            message: "internal error of kinopt; please report it".to_owned(),
        },
    };
    MESSAGE.set(kept_text(&failure.message));
    failure.status
}
