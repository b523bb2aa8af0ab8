//! Macros for residuals: delegation of their methods.

/// Delegates methods of a residual to an inner residual, by the field's name.
///
/// `as_inner!(residual: kind, frames, rows)` within `impl Residual`.
macro_rules! as_inner {
    ($inner:tt: $($method:ident),+) => { $(as_inner!(@$method $inner);)+ };
    (@kind $inner:tt) => { fn kind(&self) -> &'static str { self.$inner.kind() } };
    (@is_of_body $inner:tt) => { fn is_of_body(&self) -> bool { self.$inner.is_of_body() } };
    (@frames $inner:tt) => { fn frames(&self) -> Vec<crate::model::FrameId> { self.$inner.frames() } };
    (@joints $inner:tt) => { fn joints(&self) -> Vec<crate::model::JointId> { self.$inner.joints() } };
    (@joint_values $inner:tt) => {
        fn joint_values(&self) -> Option<usize> { self.$inner.joint_values() }
    };
    (@rows $inner:tt) => { fn rows(&self) -> Vec<crate::task::RowBlock> { self.$inner.rows() } };
    (@inequalities $inner:tt) => { fn inequalities(&self) -> Vec<crate::task::Inequality> { self.$inner.inequalities() } };
    (@target_len $inner:tt) => { fn target_len(&self) -> usize { self.$inner.target_len() } };
    (@validate $inner:tt) => { fn validate(&self) -> Result<(), String> { self.$inner.validate() } };
}

/// `evaluate` of a residual that implements `evaluate_moved`: with an empty step.
macro_rules! evaluate_unmoved {
    () => {
        fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], joints: &[S], residual: &mut [S]) {
            self.evaluate_moved(frames, joints, &[], residual);
        }
    };
}

/// `evaluate` and `evaluate_moved` of a residual of frames only, by its method `evaluate_frames`.
macro_rules! evaluate_by_frames {
    () => {
        evaluate_unmoved!();

        fn evaluate_moved<S: Scalar>(
            &self,
            frames: &[Placement<S>],
            _joints: &[S],
            step: &[S],
            residual: &mut [S],
        ) {
            self.evaluate_frames(frames, step, residual);
        }
    };
}
