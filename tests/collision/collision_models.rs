//! Promise: a collision model has the shapes of the robot's links at their placements, and enables the pairs that can
//! and should not collide.

use kinopt::collision::{
    CollisionModel, CollisionModelError, CollisionObject, MeshUse, Shape, ShapeKind, separation,
};
use kinopt::kinematics::ForwardKinematics;
use kinopt::robot::{Robot, Srdf};
use kinopt::spatial::Placement;
use support::arms::robot;
use support::fault_tables::ExpectedError;

/// Names of each enabled pair.
fn names(model: &CollisionModel) -> Vec<String> {
    let frames = model.model().frames();
    let name = |link: &kinopt::model::FrameId| frames[link.index()].name.as_str();
    model
        .pairs()
        .iter()
        .map(|[a, b]| format!("{}{}", name(a), name(b)))
        .collect()
}

/// Links along x. The links a and b are rigidly connected, c swings slightly on them, and d without shape is on c. The
/// link e rotates on d, f on e, and g on f.
const ROW: &str = r#"<robot name="row">
  <link name="a"><collision><geometry><sphere radius="0.2"/></geometry></collision></link>
  <link name="b"><collision><geometry><sphere radius="0.2"/></geometry></collision></link>
  <link name="c"><collision><geometry><box size="0.2 0.1 0.1"/></geometry></collision></link>
  <link name="d"/>
  <link name="e"><collision name="elbow"><geometry><cylinder radius="0.1" length="0.2"/></geometry></collision>
    <collision><origin xyz="0 0 0.1"/><geometry><sphere radius="0.1"/></geometry></collision>
    <collision><origin xyz="0 0 -0.1"/><geometry><sphere radius="0.1"/></geometry></collision></link>
  <link name="f"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
  <link name="g"><collision><geometry><sphere radius="0.45"/></geometry></collision></link>
  <joint name="ab" type="fixed"><parent link="a"/><child link="b"/><origin xyz="0.3 0 0"/></joint>
  <joint name="bc" type="revolute"><limit lower="-0.1" upper="0.1" effort="1" velocity="1"/><parent link="b"/><child link="c"/><origin xyz="0.5 0 0"/><axis xyz="0 0 1"/></joint>
  <joint name="cd" type="revolute"><limit lower="-0.1" upper="0.1" effort="1" velocity="1"/><parent link="c"/><child link="d"/><origin xyz="0.5 0 0"/><axis xyz="0 0 1"/></joint>
  <joint name="de" type="continuous"><parent link="d"/><child link="e"/><origin xyz="0 0 0"/><axis xyz="0 1 0"/></joint>
  <joint name="ef" type="continuous"><parent link="e"/><child link="f"/><origin xyz="0.5 0 0"/><axis xyz="0 0 1"/></joint>
  <joint name="fg" type="continuous"><parent link="f"/><child link="g"/></joint>
</robot>"#;

#[test]
fn rigid_groups_and_neighbours_may_collide() {
    let robot = Robot::parse(ROW, "row.urdf").unwrap();
    let model = CollisionModel::of(&robot).unwrap();
    // Two joints and the shapeless link d are between c and e.
    let apart = ["ae", "af", "ag", "be", "bf", "bg", "ce", "cf", "cg", "eg"];
    assert_eq!(names(&model), apart);
}

/// Two links with shapes six joints apart, and a shoulder of three revolute joints between two links.
#[test]
fn links_several_joints_apart_are_no_neighbours() {
    let link = |name: &str, radius: f64| {
        format!(
            "<link name='{name}'><collision><geometry><sphere radius='{radius}'/></geometry></collision></link>"
        )
    };
    let joints: String = (0..6)
        .map(|k| {
            let axis = ["0 0 1", "0 1 0"][k % 2];
            format!(
                "<joint name='j{k}' type='continuous'><parent link='l{k}'/><child link='l{}'/>\
                 <origin xyz='0.2 0 0'/><axis xyz='{axis}'/></joint>",
                k + 1
            )
        })
        .collect();
    let bare: String = (1..6).map(|k| format!("<link name='l{k}'/>")).collect();
    let ends = link("l0", 0.12) + &link("l6", 0.06);
    let text = format!("<robot name='r'>{ends}{bare}{joints}</robot>");
    let model = CollisionModel::of(&Robot::parse(&text, "r.urdf").unwrap()).unwrap();
    assert_eq!(names(&model), ["l0l6"]);
    // A free base counts as one joint, although it is a chain of four.
    let free = format!(
        "<robot name='r'>{}{}<joint name='j' type='floating'><parent link='a'/><child link='b'/></joint></robot>",
        link("a", 0.1),
        link("b", 0.1)
    );
    let model = CollisionModel::of(&Robot::parse(&free, "r.urdf").unwrap()).unwrap();
    assert!(names(&model).is_empty());
    // So does a shoulder of three revolute joints in one MJCF body.
    let geom = "<geom size='0.1'/>";
    let body = format!(
        "<mujoco><worldbody><body name='trunk'><freejoint/>{geom}<body name='arm'>{geom}<joint axis='1 0 0'/>\
         <joint axis='0 1 0'/><joint axis='0 0 1'/></body></body></worldbody></mujoco>"
    );
    let model = CollisionModel::of(&Robot::parse_mjcf(&body, "r.xml").unwrap()).unwrap();
    assert!(names(&model).is_empty());
}

#[test]
fn cylinder_with_spheres_at_its_ends_is_a_capsule() {
    let robot = Robot::parse(ROW, "row.urdf").unwrap();
    let model = CollisionModel::of(&robot).unwrap();
    let elbow: Vec<_> = model
        .objects_of(robot.model().frame("e").unwrap())
        .collect();
    let [elbow] = elbow.as_slice() else {
        panic!("{elbow:?}");
    };
    assert_eq!(elbow.name, "elbow");
    let ShapeKind::Capsule { radius, length } = elbow.shape.kind() else {
        panic!("{elbow:?}");
    };
    assert_eq!((*radius, *length), (0.1, 0.2));
}

/// Spheres of another radius or position, or a single one, are separate shapes.
#[test]
fn cylinder_with_other_spheres_is_no_capsule() {
    for (radius, ends) in [
        (0.12, [0.1, -0.1]),
        (0.08, [0.1, -0.1]),
        (0.1, [0.1, -0.09]),
        (0.1, [0.1, -0.0995]),
        (0.1, [0.1, 0.1]),
    ] {
        let sphere = |z: f64| {
            format!(
                "<collision><origin xyz=\"0 0 {z}\"/><geometry><sphere radius=\"{radius}\"/></geometry></collision>"
            )
        };
        let text = format!(
            "<robot name=\"r\"><link name=\"e\"><collision><geometry><cylinder radius=\"0.1\" length=\"0.2\"/></geometry></collision>{}</link></robot>",
            ends.map(sphere).concat()
        );
        let robot = Robot::parse(&text, "r.urdf").unwrap();
        let model = CollisionModel::of(&robot).unwrap();
        let shapes: Vec<_> = model
            .objects_of(robot.model().frame("e").unwrap())
            .collect();
        let capsules = shapes
            .iter()
            .filter(|object| matches!(object.shape.kind(), ShapeKind::Capsule { .. }));
        assert_eq!(
            (shapes.len(), capsules.count()),
            (3, 0),
            "{radius} {ends:?}"
        );
    }
}

#[test]
fn pairs_are_edited_by_name() {
    let robot = Robot::parse(ROW, "row.urdf").unwrap();
    let model = CollisionModel::of(&robot).unwrap();
    let model = model
        .with_ignored("f", "a")
        .unwrap()
        .with_checked("c", "b")
        .unwrap();
    assert!(!model.is_checked("a", "f").unwrap() && model.is_checked("b", "c").unwrap());
    model.with_ignored("a", "d").says("`d` | a, b, c, e, f, g");
}

#[test]
fn srdf_disables_pairs() {
    let robot = Robot::parse(ROW, "row.urdf").unwrap();
    let text = r#"<robot name="row"><disable_collisions link1="f" link2="b" reason="Never"/>
      <disable_collisions link1="d" link2="a" reason="Never"/></robot>"#;
    let srdf = Srdf::parse(text, "row.srdf", &robot).unwrap();
    let model = CollisionModel::of(&robot).unwrap().with_srdf(&srdf);
    let apart = ["ae", "af", "ag", "be", "bg", "ce", "cf", "cg", "eg"];
    assert_eq!(names(&model), apart);
}

#[test]
fn sampling_drops_pairs_of_never_and_always() {
    let robot = Robot::parse(ROW, "row.urdf").unwrap();
    let model = CollisionModel::of(&robot).unwrap();
    let sampled = model.clone().with_pairs_sampled(3000, 7).unwrap();
    // By hand: e stays about 1.0 from b and 1.3 from a, and reaches 0.2. The centre of f and g circles e at 0.5, up to
    // c and no nearer to b than 0.5. Radii: f and b together 0.3, g and b together 0.65. a is 0.8 away. g always
    // contains a part of e.
    assert_eq!(names(&sampled), ["bg", "cf", "cg"]);
    let again = model.with_pairs_sampled(3000, 7).unwrap();
    assert_eq!(names(&again), names(&sampled));
}

#[test]
fn shipped_robots_have_valid_pairs() {
    for (name, arms) in [("franka_panda", 7), ("universal_ur5e", 6)] {
        let robot = robot(name);
        let model = CollisionModel::of(&robot).unwrap();
        assert!(model.links().len() > arms, "{name}");
        let sampled = model.with_pairs_sampled(2000, 1).unwrap();
        assert!(sampled.is_checked("base", "link4").is_ok());
        assert!(!sampled.pairs().is_empty() && sampled.notes().is_empty());
    }
}

#[test]
fn shipped_world_leaves_the_panda_free() {
    let world = kinopt::collision::World::read("../models/worlds/table.json").unwrap();
    let model = CollisionModel::of(&robot("franka_panda")).unwrap();
    let model = model.with_pairs_sampled(500, 1).unwrap();
    let checker = kinopt::collision::Checker::new(model)
        .with_world(&world)
        .unwrap();
    let pi = std::f64::consts::PI;
    let ready = [
        0.0,
        -pi / 4.0,
        0.0,
        -0.75 * pi,
        0.0,
        pi / 2.0,
        pi / 4.0,
        0.04,
        0.04,
    ];
    assert_eq!(checker.collisions(&ready).unwrap(), []);
    let leaning = [0.0, 1.4, 0.0, -0.8, 0.0, pi / 2.0, pi / 4.0, 0.04, 0.04];
    let reported = checker.collisions(&leaning).unwrap();
    assert!(
        reported.iter().any(|pair| pair.second == "table"),
        "{reported:?}"
    );
}

#[test]
fn meshes_are_found_in_packages_and_folders() {
    let folder = std::env::temp_dir().join(format!("kinopt-meshes-{}", std::process::id()));
    let meshes = folder.join("lamp_description/meshes");
    let others = folder.join("elsewhere/stand_description");
    std::fs::create_dir_all(&meshes).unwrap();
    std::fs::create_dir_all(&others).unwrap();
    let urdf = folder.join("lamp_description/urdf/lamp.urdf");
    std::fs::create_dir_all(urdf.parent().unwrap()).unwrap();
    let cube = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    for file in [meshes.join("arm.obj"), others.join("foot.obj")] {
        std::fs::write(file, cube).unwrap();
    }
    let mesh = |file: &str| {
        format!(
            "<collision><geometry><mesh filename=\"{file}\" scale=\"2 1 1\"/></geometry></collision>"
        )
    };
    let lamp = |foot: &str| {
        let (arm_shape, neighbour_shape) = (
            mesh("package://lamp_description/meshes/arm.obj"),
            mesh("../meshes/arm.obj"),
        );
        let foot = mesh(foot);
        format!(
            "<robot name=\"lamp\"><link name=\"arm\">{arm_shape}{neighbour_shape}{foot}</link></robot>"
        )
    };
    std::fs::write(&urdf, lamp("package://stand_description/foot.obj")).unwrap();

    let robot = Robot::read(&urdf).unwrap();
    let error = CollisionModel::of(&robot).unwrap_err();
    assert!(matches!(error, CollisionModelError::MeshNotFound { .. }));
    let message = error.to_string();
    assert!(
        message.contains("link `arm`") && message.contains("package://stand_description/foot.obj")
    );
    assert!(
        message.contains("lamp_description/urdf/stand_description/foot.obj"),
        "{message}"
    );

    let left_out = CollisionModel::builder(&robot)
        .leaving_out_missing_meshes()
        .build()
        .unwrap();
    assert_eq!((left_out.objects().len(), left_out.notes().len()), (2, 1));

    // The third has another mesh, the last a larger one of the same name.
    let (packages, others_copy, another) =
        (folder.join("elsewhere"), others.clone(), meshes.clone());
    let late = folder.join("late");
    std::fs::create_dir_all(late.join("stand_description")).unwrap();
    let larger = cube.replacen("v 1", "v 3", 1);
    std::fs::write(late.join("stand_description/foot.obj"), &larger).unwrap();
    // A file deeper in the package does not replace the package's own.
    let deeper = folder.join("lamp_description/lamp_description/meshes");
    std::fs::create_dir_all(&deeper).unwrap();
    std::fs::write(deeper.join("arm.obj"), &larger).unwrap();
    // A folder of another name is not the package.
    let stranger = folder.join("stranger");
    std::fs::create_dir_all(&stranger).unwrap();
    std::fs::write(stranger.join("foot.obj"), &larger).unwrap();
    for folders in [
        vec![&packages],
        vec![&stranger, &packages],
        vec![&others_copy],
        vec![&packages, &another],
        vec![&another, &others_copy],
        vec![&packages, &late],
    ] {
        let builder = CollisionModel::builder(&robot);
        let builder = (folders.iter()).fold(builder, |builder, folder| {
            builder.with_package_folder(folder)
        });
        let model = builder.build().unwrap();
        assert_eq!(model.objects().len(), 3);
        for object in model.objects() {
            let bounds = object.shape.bounding_box();
            assert_eq!(bounds.max.to_array(), [2.0, 1.0, 1.0]);
            assert!(matches!(object.shape.kind(), ShapeKind::Convex(_)));
        }
    }
    let robot = Robot::parse(
        &lamp(&format!("file://{}", others.join("foot.obj").display())),
        "lamp",
    )
    .unwrap();
    assert!(CollisionModel::of(&robot).is_err());
    let robot = robot.with_file(&urdf);
    let model = CollisionModel::builder(&robot)
        .with_meshes(MeshUse::Triangles)
        .build()
        .unwrap();
    assert!(
        model
            .objects()
            .iter()
            .all(|object| matches!(object.shape.kind(), ShapeKind::Mesh(mesh) if mesh.is_closed()))
    );
    std::fs::remove_dir_all(folder).unwrap();
}

/// Shapes within this distance count as connected, metres; shapes leave gaps at joints.
const CONNECTION_DISTANCE: f64 = 0.03;

/// Number of connected components of a robot's shapes at a configuration.
fn pieces(model: &CollisionModel, q: &[f64]) -> usize {
    let mut kinematics = ForwardKinematics::<f64>::new(model.model());
    let links = kinematics.place(q).unwrap();
    let objects = model.objects();
    let placed = |k: usize| links[objects[k].link.index()] * objects[k].link_from_shape;
    let mut left: Vec<usize> = (0..objects.len()).collect();
    let mut pieces = 0;
    while let Some(first) = left.pop() {
        let mut edge = vec![first];
        while let Some(a) = edge.pop() {
            let near = |b: &usize| {
                separation(
                    &objects[a].shape,
                    &placed(a),
                    &objects[*b].shape,
                    &placed(*b),
                )
                .distance
                    <= CONNECTION_DISTANCE
            };
            let (touching, others) = left.into_iter().partition(near);
            left = others;
            edge.extend::<Vec<usize>>(touching);
        }
        pieces += 1;
    }
    pieces
}

#[test]
fn shapes_of_shipped_arms_are_connected() {
    for name in [
        "adept_cobra_s600",
        "franka_panda",
        "kuka_iiwa14",
        "rethink_baxter",
        "universal_ur10e",
        "universal_ur5e",
    ] {
        let robot = robot(name);
        let model = CollisionModel::of(&robot).unwrap();
        for seed in 0..4 {
            let q = robot.model().random_configuration(seed);
            assert_eq!(pieces(&model, &q), 1, "{name}, {q:?}");
        }
    }
}

/// Unbounded shapes cannot move with a link.
#[test]
fn planes_and_height_fields_on_links_are_rejected() {
    let robot = Robot::parse(ROW, "row.urdf").unwrap();
    let model = robot.model();
    let heights = Shape::height_field(vec![0.0; 4], 2, [1.0; 2]).unwrap();
    for shape in [Shape::half_space(), heights] {
        let link = model.frame("b").unwrap();
        let object = CollisionObject::new("ground", link, Placement::identity(), shape);
        let error = CollisionModel::new(model, vec![object]).unwrap_err();
        assert!(
            matches!(&error, CollisionModelError::Boundless { object } if object == "ground"),
            "{error}"
        );
    }
}
