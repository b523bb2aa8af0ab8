//! Promise: masses, quaternions, ranges and loops that have no meaning are errors or notes with their names.

use kinopt::robot::{ParseIssue, Robot, RobotFileError};
use support::fault_tables::ExpectedError;

/// A document with joints, classes, geoms, loops and actuators.
const SMALL: &str = r#"<mujoco model="small">
  <compiler angle="radian" autolimits="true" eulerseq="XYZ"/>
  <default>
    <joint limited="auto" range="-1.5 1.5"/>
    <default class="arm"><joint axis="0 1 0"/><default class="hand"><joint range="0 0.4"/><site pos="0 0 0.1"/></default></default>
    <default class="loose"><joint type="ball" range="0 1.2"/></default>
  </default>
  <worldbody>
    <site name="goal" pos="1 0 0"/>
    <body name="base" pos="0 0 0.5" quat="0.8 0 0.6 0"><freejoint name="float"/><site name="far" pos="9 0 0"/>
      <inertial pos="0 0 0.1" mass="3" diaginertia="0.1 0.1 0.1"/>
      <body name="upper" childclass="arm" pos="0.1 0 0"><joint name="shoulder"/><joint name="twist" axis="1 0 0" ref="0.2"/>
        <geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.04" density="500"/>
        <body name="lower" pos="0.3 0 0"><joint name="elbow"/><geom type="box" size="0.1 0.02 0.02" mass="0.7"/>
          <body name="left" class="hand" pos="0.2 0.02 0"><joint name="left" class="hand"/><site name="left tip" class="hand"/></body>
          <body name="right" pos="0.2 -0.02 0"><joint name="right" class="hand"/><site name="right tip" class="hand" euler="0 0.1 0"/></body>
        </body></body>
      <body name="tail" pos="-0.1 0 0"><joint name="tail" class="loose"/>
        <body name="tail end" pos="-0.2 0 0"><joint name="tail slide" type="slide" axis="1 0 0" range="-0.1 0.2"/><site name="tail tip"/></body></body>
      <body name="link" pos="0.1 0 0.1"><joint name="link" class="arm"/><body name="rod" pos="0.3 0 0"><joint name="rod" class="arm"/></body></body>
    </body>
  </worldbody>
  <equality>
    <joint name="mirror" joint1="right" joint2="left" polycoef="0 1 0 0 0"/>
    <connect name="pin" body1="rod" body2="lower" anchor="0.05 0 -0.1"/>
    <weld name="grip" site1="left tip" site2="right tip" active="false"/>
  </equality>
  <tendon><fixed name="pull"><joint joint="elbow" coef="1"/></fixed></tendon>
  <actuator><motor joint="shoulder"/><position tendon="pull"/><motor joint="left"/></actuator>
</mujoco>"#;

/// Error of the small document with a replacement.
fn rejected_error(from: &str, to: &str) -> RobotFileError {
    match small(from, to) {
        Err(error) => error,
        Ok(_) => panic!("{to} was taken"),
    }
}

fn small(from: &str, to: &str) -> Result<Robot, RobotFileError> {
    assert!(SMALL.contains(from), "{from}");
    Robot::parse_mjcf(&SMALL.replace(from, to), "small.xml")
}

#[test]
fn zero_and_negative_masses_are_handled() {
    // Massless bodies are dropped; a massless robot has no centre of mass.
    let light = small("mass=\"3\"", "mass=\"0\"").unwrap();
    let all = small("mass=\"3\"", "mass=\"3\"")
        .unwrap()
        .masses()
        .unwrap()
        .total();
    assert!((light.masses().unwrap().total() - (all - 3.0)).abs() < 1e-12);
    let nothing = SMALL
        .replace("mass=\"3\"", "mass=\"0\"")
        .replace("mass=\"0.7\"", "mass=\"0\"")
        .replace("density=\"500\"", "density=\"0\"");
    let nothing = Robot::parse_mjcf(&nothing, "small.xml").unwrap();
    nothing.masses().says("`small` has no centre of mass");
    let q = nothing.model().neutral();
    assert!(nothing.centre_of_mass(&q).is_err() && nothing.centre_of_mass_jacobian(&q).is_err());
    small("mass=\"3\"", "mass=\"-3\"")
        .unwrap()
        .masses()
        .says("`base` is -3 kg");
    // A geom with a negative mass is dropped with a note.
    for (from, to) in [
        ("mass=\"0.7\"", "mass=\"-0.7\""),
        ("density=\"500\"", "density=\"-1\""),
    ] {
        let lacks = small(from, to).unwrap();
        let message = lacks.repairs()[0].to_string();
        assert!(
            message.contains("<geom>") && message.contains("at least 0"),
            "{message}"
        );
        assert!(lacks.masses().unwrap().total() < all);
    }
}

#[test]
fn zero_quaternions_and_open_loops_are_named() {
    let error = rejected_error("quat=\"0.8 0 0.6 0\"", "quat=\"0 0 0 0\"");
    assert!(
        matches!(
            &error,
            RobotFileError::Element {
                fault: ParseIssue::ZeroLength { attribute: "quat" },
                ..
            }
        ),
        "{error}"
    );
    for range in ["0 -1", "0.2 1", "0 nan"] {
        let error = rejected_error("range=\"0 1.2\"", &format!("range=\"{range}\"")).to_string();
        assert!(
            error.contains("tail") || error.contains("range"),
            "{range}: {error}"
        );
    }
    // More than a whole turn limits nothing.
    assert!(small("range=\"0 1.2\"", "range=\"0 400\"").is_ok());
    let error = rejected_error(
        "body1=\"rod\" body2=\"lower\" anchor=\"0.05 0 -0.1\"",
        "site1=\"far\" site2=\"left tip\"",
    )
    .to_string();
    assert!(error.contains("loop `pin` cannot close"), "{error}");
    for (from, to) in [
        ("body2=\"lower\"", "body2=\"rod\""),
        ("site2=\"right tip\" active=\"false\"", "site2=\"left tip\""),
    ] {
        let error = rejected_error(from, to).to_string();
        assert!(
            error.contains("small.xml") && error.contains("to itself"),
            "{error}"
        );
    }
}
