//! Promise: a cone may have any axis and is equally wide in all directions, and continuous joints have no range.

use kinopt::model::{BallLimits, Joint, JointKind, Limits, Model};
use kinopt::spatial::{Placement, Vector3};

/// Independent of the direction from which the swing is measured.
#[test]
fn cone_limits_apply_about_any_axis() {
    let [x, y, z] = Vector3::UNITS;
    let leaning =
        |x: f64, y: f64, z: f64| Vector3::new(x, y, z) * (1.0 / Vector3::new(x, y, z).norm());
    for axis in [
        x,
        -x,
        y,
        -y,
        z,
        -z,
        leaning(-0.9, 0.1, 0.2),
        leaning(0.1, -0.9, 0.0),
    ] {
        let mut builder = Model::builder("shoulder");
        let cone = BallLimits::cone(0.5, Limits::new(-0.3, 0.2));
        builder.ball("ball", None, Placement::identity(), axis, Some(cone));
        let model = builder.build().unwrap();
        let turned = |about: Vector3<f64>, angle: f64| {
            let Vector3 { x, y, z } = about * (1.0 / about.norm() * (0.5 * angle).sin());
            model.is_within_limits(&[(0.5 * angle).cos(), x, y, z])
        };
        for other in [x, y, z, leaning(1.0, -2.0, 0.5)] {
            let across = axis.cross(other);
            if across.norm() > 0.1 {
                assert!(turned(across, 0.499) && turned(across, -0.499), "{axis:?}");
                assert!(
                    !turned(across, 0.501) && !turned(across, -0.501),
                    "{axis:?}"
                );
            }
        }
        assert!(turned(axis, 0.199) && turned(axis, -0.299), "{axis:?}");
        assert!(!turned(axis, 0.201) && !turned(axis, -0.301), "{axis:?}");
        for seed in 0..20 {
            assert!(model.is_within_limits(&model.random_configuration(seed)));
        }
    }
}

/// Given limits are ignored: they apply to one bounded coordinate.
#[test]
fn continuous_joint_has_no_range() {
    for (kind, numbers) in [
        (JointKind::Continuous, vec![9.0]),
        (JointKind::Ball, vec![-0.6, 0.8, 0.0, 0.0]),
    ] {
        let mut builder = Model::builder("wheel");
        let (at, z) = (Placement::identity(), Vector3::UNITS[2]);
        builder.joint(Joint::new(
            "wheel",
            None,
            at,
            kind,
            z,
            Limits::new(-0.5, 0.5),
        ));
        let model = builder.build().unwrap();
        assert_eq!(model.joints()[0].limits, Limits::UNBOUNDED);
        assert!(model.is_within_limits(&numbers), "{kind:?}");
    }
}
