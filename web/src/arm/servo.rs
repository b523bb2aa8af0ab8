//! Servos: targets at a fixed rate, within joint limits.

use std::rc::Rc;

use kinopt_bindings::option::{names, servo};
use self_cell::self_cell;
use wasm_bindgen::prelude::*;

use crate::arguments::NamedArguments;
use crate::error::{Exception, raise};
use crate::placement::read;
use crate::value::Value;

use kinopt::arm::Servo as Servoing;

self_cell!(
    struct Cell {
        owner: Rc<kinopt::Arm>,
        #[covariant]
        dependent: Servoing,
    }
);

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
export interface ServoOptions {
    /** Velocity limits of the joints, rad/s or m/s, infinite for none; default: those of the robot's files. */
    velocityLimits?: PerJoint;
    /** Acceleration limits of the joints, rad/s² or m/s², infinite for none; default: those of the robot's files. */
    accelerationLimits?: PerJoint;
    /** Jerk limits of the joints, rad/s³ or m/s³, infinite for none; default: those of the robot's files. */
    jerkLimits?: PerJoint;
    /** Keeps the tool on the straight line to its target, at reduced speed if necessary; default false. */
    straightLine?: boolean;
    /** Damping near singular configurations, radians; default 0.01. */
    damping?: number;
}
"#;

#[wasm_bindgen]
extern "C" {
    /// Options of a servo.
    #[wasm_bindgen(typescript_type = "ServoOptions")]
    pub type ServoOptions;
}

/// Servo of an arm: one target in each control cycle.
#[wasm_bindgen]
pub struct Servo {
    cell: Cell,
    reached: bool,
    errors: [f64; 2],
}

impl Servo {
    pub(super) fn new(
        arm: Rc<kinopt::Arm>,
        start: &[f64],
        step: f64,
        options: Option<ServoOptions>,
    ) -> Result<Self, Exception> {
        // The motion at the start is at rest.
        let known = names(&servo::options())
            .into_iter()
            .filter(|name| !["velocity", "acceleration"].contains(name));
        let options = NamedArguments::of(options, "option of a servo", known)?;
        let options = servo::ServoOptions::of(&options, &arm)?;
        let cell = Cell::try_new(arm, |arm| {
            options.apply::<Value>(arm.servo(start, step).map_err(raise)?)
        })?;
        Ok(Self {
            cell,
            reached: false,
            errors: [f64::NAN; 2],
        })
    }
}

#[wasm_bindgen]
impl Servo {
    /// Commanded joint positions, radians or metres.
    #[wasm_bindgen(getter)]
    pub fn q(&self) -> Vec<f64> {
        self.cell.borrow_dependent().q().to_vec()
    }

    /// Velocity limits, rad/s or m/s; infinite for none.
    #[wasm_bindgen(getter, js_name = velocityLimits)]
    pub fn velocity_limits(&self) -> Vec<f64> {
        self.cell.borrow_dependent().velocity_limits().to_vec()
    }

    /// Acceleration limits, rad/s² or m/s²; infinite for none.
    #[wasm_bindgen(getter, js_name = accelerationLimits)]
    pub fn acceleration_limits(&self) -> Vec<f64> {
        self.cell.borrow_dependent().acceleration_limits().to_vec()
    }

    /// Jerk limits, rad/s³ or m/s³; infinite for none.
    #[wasm_bindgen(getter, js_name = jerkLimits)]
    pub fn jerk_limits(&self) -> Vec<f64> {
        self.cell.borrow_dependent().jerk_limits().to_vec()
    }

    /// Commanded velocities, rad/s or m/s.
    #[wasm_bindgen(getter)]
    pub fn velocity(&self) -> Vec<f64> {
        self.cell.borrow_dependent().velocity().to_vec()
    }

    /// Commanded accelerations, rad/s² or m/s².
    #[wasm_bindgen(getter)]
    pub fn acceleration(&self) -> Vec<f64> {
        self.cell.borrow_dependent().acceleration().to_vec()
    }

    /// One control cycle of a stop; the commanded joint positions. Call it until `velocity` is zero.
    pub fn stop(&mut self) -> Vec<f64> {
        self.cell
            .with_dependent_mut(|_, servo| servo.stop().q.to_vec())
    }

    /// Distance of the tool from its target, metres.
    #[wasm_bindgen(getter, js_name = positionError)]
    pub fn position_error(&self) -> f64 {
        self.errors[0]
    }

    /// Angle between the tool and its target, radians.
    #[wasm_bindgen(getter, js_name = orientationError)]
    pub fn orientation_error(&self) -> f64 {
        self.errors[1]
    }

    /// True if the last cycle reached its target.
    #[wasm_bindgen(getter)]
    pub fn reached(&self) -> bool {
        self.reached
    }

    /// One control cycle towards a target; returns the commanded joint positions.
    pub fn step(
        &mut self,
        #[wasm_bindgen(unchecked_param_type = "Placement")] target: &[f64],
    ) -> Result<Vec<f64>, Exception> {
        let target = read(target, "target")?;
        let result = self.cell.with_dependent_mut(|_, servo| {
            let step = servo.step(target)?;
            let errors = [step.position_error, step.orientation_error];
            Ok::<_, kinopt::arm::QueryError>((step.reached(), errors))
        });
        (self.reached, self.errors) = result.map_err(raise)?;
        Ok(self.q())
    }
}
