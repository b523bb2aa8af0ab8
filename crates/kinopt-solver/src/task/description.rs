//! Description of residuals for reports and validation.

/// The kind of a residual, its scope, and the first defect of its parameters.
///
/// The default is the kind "custom", without a defect.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Description {
    pub(crate) kind: &'static str,
    pub(crate) is_of_body: bool,
    defect: Option<String>,
}

impl Default for Description {
    fn default() -> Self {
        Self::new("custom")
    }
}

impl Description {
    /// A residual of this kind, in one or two words. Reports name the kind and the first frame.
    #[must_use]
    pub fn new(kind: &'static str) -> Self {
        Self {
            kind,
            is_of_body: false,
            defect: None,
        }
    }

    /// Makes it a residual of the whole body; reports then name no frame.
    #[must_use]
    pub fn of_body(mut self) -> Self {
        self.is_of_body = true;
        self
    }

    /// Records the result of a check of the residual's parameters; a defect recorded before stays.
    ///
    /// An error is a continuation of the task's name, such as "its radius is negative". A problem with a defective
    /// residual is not built.
    #[must_use]
    pub fn with_validity(mut self, validity: Result<(), String>) -> Self {
        self.defect = self.defect.or(validity.err());
        self
    }

    /// The kind of residual in one or two words.
    #[must_use]
    pub fn kind(&self) -> &'static str {
        self.kind
    }

    /// The first defect of the residual's parameters; `None` if they are valid.
    #[must_use]
    pub fn defect(&self) -> Option<&str> {
        self.defect.as_deref()
    }
}
