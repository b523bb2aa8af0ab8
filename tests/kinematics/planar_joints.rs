//! Promise: a planar joint translates by its coordinates along two orthogonal directions, right-handed about its
//! normal, and rotates about the normal, for any normal.

use kinopt::kinematics::ForwardKinematics;
use kinopt::model::{Limits, Model};
use kinopt::spatial::{Placement, Vector3};
use support::random::Random;

#[test]
fn planar_joint_works_for_any_normal() {
    let mut random = Random::new(41);
    for _ in 0..200 {
        let normal = [(); 3].map(|()| random.within(-1.0, 1.0));
        let normal = Vector3::from(normal);
        let mut builder = Model::builder("puck");
        let (at, free) = (Placement::identity(), Limits::UNBOUNDED);
        let puck = builder.planar("puck", None, at, normal, [free; 2], free);
        let frame = builder.frame("puck", Some(puck), at);
        let model = builder.build().unwrap();
        let mut kinematics = ForwardKinematics::new(&model);
        let mut frame_at = |q: [f64; 3]| kinematics.place(&q).unwrap()[frame.index()];
        let [x, y] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(|q| frame_at(q).translation);
        let up = normal * (1.0 / normal.norm());
        let right = [
            x.dot(y),
            x.dot(up),
            y.dot(up),
            x.norm() - 1.0,
            y.norm() - 1.0,
        ];
        assert!(
            right.iter().all(|deviation| deviation.abs() < 1e-14),
            "{normal:?}: {right:?}"
        );
        assert!((x.cross(y) - up).norm() < 1e-14);
        // A quarter turn takes one direction to the other, after both translations.
        let placement = frame_at([0.3, -0.2, std::f64::consts::FRAC_PI_2]);
        assert!((placement.translation - (x * 0.3 - y * 0.2)).norm() < 1e-14);
        assert!(
            (placement.rotation * x - y).norm() < 1e-14
                && (placement.rotation * up - up).norm() < 1e-14
        );
    }
}
