//! Promise: the foot contact of a frame consists of the links fixed to it and the corners of their shapes, in the
//! frame's axes.

use kinopt::kinematics::ForwardKinematics;
use kinopt::robot::Robot;
use kinopt::spatial::Vector3;

/// A shin, an ankle, and a foot with a toe and a tool fixed to it, rotated by a quarter turn about z.
const LEG: &str = r#"<robot name="leg">
  <link name="shin"/>
  <link name="foot">
    <collision><origin xyz="0.05 0 -0.03"/><geometry><box size="0.2 0.1 0.02"/></geometry></collision>
    <collision><geometry><mesh filename="foot.stl"/></geometry></collision>
  </link>
  <link name="toe">
    <collision><origin xyz="0.01 0 0"/><geometry><sphere radius="0.005"/></geometry></collision>
    <collision><geometry><cylinder radius="0.02" length="0.04"/></geometry></collision>
  </link>
  <joint name="ankle" type="revolute">
    <parent link="shin"/><child link="foot"/><origin xyz="0 0 -0.4"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="0" velocity="0"/>
  </joint>
  <joint name="tip" type="fixed">
    <parent link="foot"/><child link="toe"/><origin xyz="0.2 0 -0.03" rpy="0 0 1.5707963267948966"/>
  </joint>
</robot>"#;

fn has(points: &[Vector3<f64>], [x, y, z]: [f64; 3]) -> bool {
    let corner = Vector3::new(x, y, z);
    points.iter().any(|point| (*point - corner).norm() < 1e-12)
}

#[test]
fn foot_contact_has_all_fixed_links() {
    let robot = Robot::parse(LEG, "leg.urdf").unwrap();
    let model = robot.model();
    let of_foot = robot.sole(model.frame("foot").unwrap());
    // Both origins, eight corners of the box, the sphere's centre and eight corners of the cylinder; nothing of the
    // mesh.
    assert_eq!(of_foot.len(), 2 + 8 + 1 + 8);
    assert_eq!(of_foot[0].to_array(), [0.0; 3]);
    let square = 0.02 / 2.0_f64.sqrt();
    for corner in [
        [0.15, 0.05, -0.04],
        [-0.05, -0.05, -0.02],
        [0.2, 0.0, -0.03],
        [0.2, 0.01, -0.03],
        [0.2 + square, square, -0.05],
    ] {
        assert!(has(&of_foot, corner), "{corner:?} of {of_foot:?}");
    }
    // From the toe they are the same points, at any ankle angle.
    let (foot, toe) = (model.frame("foot").unwrap(), model.frame("toe").unwrap());
    let of_toe = robot.sole(toe);
    assert_eq!(
        (of_toe.len(), of_toe[0].to_array()),
        (of_foot.len(), [0.0; 3])
    );
    let mut kinematics = ForwardKinematics::new(model);
    let placed = kinematics.place(&[0.7]).unwrap();
    let (world_from_foot, world_from_toe) = (placed[foot.index()], placed[toe.index()]);
    let seen: Vec<_> = of_foot
        .iter()
        .map(|at| world_from_foot.apply(*at))
        .collect();
    for point in of_toe {
        assert!(has(&seen, world_from_toe.apply(point).to_array()));
    }
    // The shin has only its own point, and a frame of another model none.
    assert_eq!(robot.sole(model.frame("shin").unwrap()).len(), 1);
    let nao = support::arms::robot("aldebaran_nao");
    assert!(
        robot
            .sole(nao.model().frame("right_sole").unwrap())
            .is_empty()
    );
}
