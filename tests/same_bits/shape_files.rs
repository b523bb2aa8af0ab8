//! Promise: so it is for a robot's shapes and the spheres that cover them, read in every mixture of choices: where meshes lie and what
//! they count as, spheres as others write them, what is written and read back.
#![allow(clippy::unwrap_used)]

use std::path::Path;

use kinopt::collision::{CollisionModel, CollisionObject, MeshUse, Resolution, Shape, SphereModel};
use kinopt::robot::Robot;
use kinopt::spatial::Vector3;
use support::random::Random;
use support::{changed_json, changed_text, changed_xml::Element};

use crate::checkers::{ROBOT, spheres_of};
use crate::digest::{Digest, Value, check};
use crate::robot_texts::{add_error, add_text};

fn add_model(digest: &mut Digest, model: &CollisionModel) {
    // A radius of each shape, what is noted, and all else as it is written.
    for object in model.objects() {
        digest.doubles([object.shape.bounding_sphere().radius]);
    }
    add_text(
        digest,
        &format!(
            "{:?} {:?} {:?}",
            model.notes(),
            model.pairs(),
            model.links()
        ),
    );
    add_text(digest, &serde_json::to_string(model).unwrap());
}

/// Tetrahedra apart from each other, of which one is flat, or bent so that pieces differ from a hull.
const TENTS: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
const FLAT: &str = "v 5 0 0\nv 6 0 0\nv 5 1 0\nf 5 6 7\n";
const BENT: &str = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 3 0\nv 0 3 0\nv 0 0 1\nv 2 0 1\nv 2 1 1\nv 1 1 1\nv 1 3 1\nv 0 3 1\nv 9 9 9
f 6 5 4 1\nf 4 3 2 1\nf 7 10 11 12\nf 7 8 9 10\nf 1 2 8 7\nf 2 3 9 8\nf 3 4 10 9\nf 4 5 11 10\nf 5 6 12 11\nf 6 1 7 12\n";

/// Folders of packages, of which one is named as the package within it, and a robot beside.
fn make(folder: &Path) {
    for (name, text) in [
        ("tent.obj", TENTS.to_owned()),
        ("rob/tent.obj", format!("{TENTS}v 8 8 8\n")),
        ("rob/meshes/bent.obj", BENT.to_owned()),
        ("rob/urdf/two.obj", format!("{TENTS}{FLAT}")),
        ("packages/kit/bent.obj", BENT.replace("v 0 3", "v 0 4")),
        ("packages/rob/meshes/bent.obj", BENT.replace('9', "4")),
        ("flat.obj", FLAT.replace("5 6 7", "1 2 3")),
        ("bad.obj", "f 1 2 3\n".to_owned()),
    ] {
        let path = folder.join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }
}

fn mixes() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(921));
    let folder = std::env::temp_dir().join(format!("kinopt-same-shapes-{}", std::process::id()));
    make(&folder);
    let at = folder.to_string_lossy().into_owned();
    let absolute = format!("file://{at}/tent.obj");
    let files = [
        "package://rob/meshes/bent.obj",
        "package://rob/tent.obj",
        "model://kit/bent.obj",
        "package://kit/bent.obj",
        "two.obj",
        "../meshes/bent.obj",
        "file://two.obj",
        &absolute,
        "tent.obj",
        "../../flat.obj",
        "../../bad.obj",
        "package://none/x.obj",
        "package://rob",
        "",
    ];
    for _ in 0..80 {
        let mut text = String::from("<robot name='r'>");
        for link in 0..3 {
            text += &format!("<link name='l{link}'>");
            for _ in 0..random.below(3) {
                let among = if random.below(3) == 0 { files.len() } else { 9 };
                let file = files[random.below(among)];
                let scale = ["", " scale='2 1 1'", " scale='-1 1 0.5'", " scale='0 1 1'"]
                    [random.below(9) % 4];
                let name = ["", " name='part'"][random.below(2)];
                text += &format!(
                    "<collision{name}><origin xyz='0 {link} 1'/><geometry><mesh filename='{file}'{scale}/></geometry></collision>"
                );
            }
            text += "<collision><geometry><sphere radius='0.5'/></geometry></collision></link>";
        }
        for (a, b) in [(0, 1), (1, 2)] {
            text += &format!(
                "<joint name='j{a}' type='continuous'><parent link='l{a}'/><child link='l{b}'/></joint>"
            );
        }
        let mut robot = Robot::parse(&format!("{text}</robot>"), "r.urdf").unwrap();
        if random.below(5) > 0 {
            robot = robot.with_file(folder.join(["rob/urdf/r.urdf", "r.urdf"][random.below(2)]));
        }
        let mut builder = CollisionModel::builder(&robot);
        for _ in 0..random.below(3) {
            builder = builder.with_package_folder(
                folder.join(["packages", "packages/kit", "", "rob"][random.below(4)]),
            );
        }
        let uses = [
            MeshUse::Hull,
            MeshUse::Parts,
            MeshUse::Triangles,
            MeshUse::Pieces(1),
            MeshUse::Pieces(3),
            MeshUse::Pieces(0),
        ];
        match random.below(8) {
            6 => {}
            k => builder = builder.with_meshes(uses[k.min(random.below(6))]),
        }
        if random.below(2) == 0 {
            builder = builder.leaving_out_missing_meshes();
        }
        let without = |text: &str| {
            let told = text.replace('\\', "/").replace(&at.replace('\\', "/"), "");
            // Where it was looked for above the folder is each machine's own.
            told.split("; looked for").next().unwrap().to_owned()
        };
        match builder.build() {
            Ok(model) => {
                add_text(
                    &mut digest,
                    &without(&format!("{:?}", model.notes().first())),
                );
                digest.word(model.notes().len() as u64);
                for object in model.objects() {
                    digest.text(&object.name);
                    let ball = object.shape.bounding_sphere();
                    digest.doubles([ball.centre.x, ball.centre.y, ball.centre.z, ball.radius]);
                }
            }
            Err(error) => add_text(&mut digest, &without(&error.to_string())),
        }
    }
    std::fs::remove_dir_all(folder).unwrap();
    digest.value()
}

/// Shapes of every kind on links, as serde has them, and with something changed.
fn serialised() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(922));
    let robot = Robot::parse(ROBOT, "r.urdf").unwrap();
    let points = [
        [0.0, 0.0, 0.0],
        [0.2, 0.0, 0.0],
        [0.0, 0.3, 0.0],
        [0.0, 0.0, 0.25],
    ]
    .map(Vector3::from);
    let shapes = [
        Shape::convex(&points),
        Shape::mesh(points.to_vec(), vec![[0, 2, 1], [0, 1, 3]]),
        Shape::points(points.to_vec(), 0.05),
        Shape::capsule(0.1, 0.2),
        Shape::cylinder(0.1, 0.3),
        Shape::cuboid([0.1, 0.2, 0.3]),
        Shape::sphere(0.1),
    ];
    let links = robot.model().frame_ids().collect::<Vec<_>>();
    let objects = shapes.into_iter().enumerate().map(|(k, shape)| {
        let at = Vector3::new(0.0, 0.1 * k as f64, 0.0);
        CollisionObject::new(format!("o{k}"), links[k % 4], at, shape.unwrap())
    });
    let own = CollisionModel::new(robot.model(), objects.collect()).unwrap();
    for bodies in [own.clone(), CollisionModel::of(&robot).unwrap()] {
        add_model(&mut digest, &bodies);
        let text = serde_json::to_string(&bodies).unwrap();
        let again: CollisionModel = serde_json::from_str(&text).unwrap();
        add_model(&mut digest, &again);
        for text in changed_json::changed(&text, 22, &mut random) {
            match serde_json::from_str::<CollisionModel>(&text) {
                Ok(model) => add_model(&mut digest, &model),
                Err(error) => add_error(&mut digest, &error),
            }
        }
        let spheres = SphereModel::of(&bodies, Resolution::PerLink(2)).unwrap();
        let text = serde_json::to_string(&spheres).unwrap();
        for text in changed_json::changed(&text, 22, &mut random) {
            match serde_json::from_str::<SphereModel>(&text) {
                Ok(spheres) => {
                    spheres_of(&mut digest, &spheres);
                    add_text(&mut digest, &serde_json::to_string(&spheres).unwrap());
                }
                Err(error) => add_error(&mut digest, &error),
            }
        }
    }
    for fineness in [Resolution::MaxProtrusion(0.2), Resolution::PerLink(3)] {
        spheres_of(&mut digest, &SphereModel::of(&own, fineness).unwrap());
    }
    digest.word(SphereModel::of_spheres(&own).is_some().into());
    // What others made leaves gaps, and one says what it left out.
    let bodies = CollisionModel::of(&robot).unwrap();
    let given = SphereModel::parse(SPHERES.as_bytes(), "s.yaml", &bodies).unwrap();
    let text = serde_json::to_string(&given).unwrap();
    add_text(&mut digest, &text);
    spheres_of(&mut digest, &serde_json::from_str(&text).unwrap());
    digest.value()
}

/// Links out of order, without shapes, two at one body, nothing in lists, and switched off.
const SPHERES: &str = "other: [1]\nrobot_cfg:\n  kinematics:\n    collision_spheres:
      hand:\n      - center: [0, 0.01, 0.5]\n        radius: 0.05\n      - {radius: 0.5, center: [0, 0, 0]}
      base:\n      - center: [0.1, 0, 0]\n        radius: 0.3\n      - center: [0, 0, 0]\n        radius: -10\n      - {center: [0, 0, 1], radius: 0}
      wrist: [{center: [0.0, 0, -0.1], radius: 1e-1}]\n      upper: ~\n      left: null\n      \"lower\":\n      - {center: [3, 0, 0], radius: 0.25, extra: x}\n      - {center: [0, 0, 0], radius: 0.01}\n";

const SPHERE_ROBOT: &str = "<robot name=\"s\"><link name=\"hand\"><collision><origin xyz=\"0 0 0.1\"/><geometry><sphere radius=\"0.2\"/></geometry></collision></link>
<link name=\"wrist\"><collision><geometry><sphere radius=\"0.1\"/></geometry></collision><collision><origin xyz=\"1 0 0\"/><geometry><sphere radius=\"0.3\"/></geometry></collision></link><link name=\"base\"/>
<joint name=\"a\" type=\"fixed\"><parent link=\"base\"/><child link=\"wrist\"/></joint><joint name=\"b\" type=\"fixed\"><parent link=\"wrist\"/><child link=\"hand\"/></joint></robot>";

fn spheres() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(923));
    let bodies = CollisionModel::of(&Robot::parse(ROBOT, "r.urdf").unwrap()).unwrap();
    // A link without shapes more, none of them its neighbour's.
    let bare = ROBOT.replace(
        "<collision name=\"palm\"><geometry><box size=\"0.04 0.12 0.08\"/></geometry></collision>",
        "",
    );
    let bare = CollisionModel::of(&Robot::parse(&bare, "r.urdf").unwrap()).unwrap();
    let mut add = |text: &str, file: &str, bodies: &CollisionModel| match SphereModel::parse(
        text.as_bytes(),
        file,
        bodies,
    ) {
        Ok(spheres) => {
            spheres_of(&mut digest, &spheres);
            add_text(&mut digest, &spheres.to_yaml());
            let urdf = spheres.spherised(ROBOT, "r.urdf").unwrap();
            add_text(&mut digest, &urdf);
        }
        Err(error) => add_error(&mut digest, &error),
    };
    let mut tree = Element::parse(SPHERE_ROBOT);
    for bodies in [&bodies, &bare] {
        add(SPHERES, "s.yaml", bodies);
        for text in changed_text::changed(SPHERES, 70, &mut random) {
            add(&text, ["s.yaml", "s.YML"][random.below(2)], bodies);
        }
        add(SPHERE_ROBOT, "s.URDF", bodies);
        for _ in 0..40 {
            let mut own = tree.clone();
            own.change(&mut random);
            add(&own.text(), "s.urdf", bodies);
            if random.below(12) == 0 {
                tree = Element::parse(SPHERE_ROBOT);
            }
        }
    }
    // Written into texts of many forms.
    let model = SphereModel::parse(SPHERES.as_bytes(), "s.yaml", &bodies).unwrap();
    let forms = [
        "<robot><link name='base'/><link name=\"hand\"/></robot>",
        "<robot>\n  <link name='none'>\n  <collision/></link>\n<link name='hand' ></link>\n</robot>\n",
        "<?xml version='1.0'?><!-- x --><robot><link name='wrist'  />\n<link name='base'><collision>\n</collision>\n\n<visual/><collision/>\n</link><collision/></robot>",
        "<robot><group><link name='hand'/></group><link><collision/></link></robot>",
        "<robot/>",
        "<world><link name='hand'/></world>",
        "<robot>\n<link></robot>",
    ];
    for text in forms {
        match model.spherised(text, "w.urdf") {
            Ok(text) => add_text(&mut digest, &text),
            Err(error) => add_error(&mut digest, &error),
        }
    }
    digest.value()
}

#[test]
fn of_meshes_of_robots() {
    check(&[("meshes of robots, every choice mixed", mixes())]);
}

/// Cylinders with balls about their ends, of which some make capsules, and clouds of points alone and beside others.
fn capsules() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(924));
    for _ in 0..40 {
        let mut text = "<robot name='r'><link name='a'>".to_owned();
        for _ in 0..=random.below(2) {
            let x = random.below(2);
            text += &format!(
                "<collision><origin xyz='{x} 0 0'/><geometry><cylinder radius='0.1' length='0.5'/></geometry></collision>"
            );
            for z in [-0.25, 0.25] {
                let z = z * [1.0, 1.0, 1.00003, 1.1][random.below(4)];
                let radius = [0.1, 0.1, 0.100009, 0.12][random.below(4)];
                text += &format!(
                    "<collision name='{}'><origin xyz='{x} 0 {z}'/><geometry><sphere radius='{radius}'/></geometry></collision>",
                    ["", "cap"][random.below(2)]
                );
            }
        }
        let robot = Robot::parse(&format!("{text}</link></robot>"), "r.urdf").unwrap();
        add_model(&mut digest, &CollisionModel::of(&robot).unwrap());
    }
    let robot = Robot::parse(ROBOT, "r.urdf").unwrap();
    for count in [1, 2, 6] {
        let points: Vec<Vector3<f64>> = (0..count)
            .map(|_| [(); 3].map(|()| random.within(-0.3, 0.3)).into())
            .collect();
        let link = robot.model().frame("hand").unwrap();
        let cloud = CollisionObject::new(
            "cloud",
            link,
            Vector3::new(0.1, 0.0, 0.2),
            Shape::points(points, 0.08).unwrap(),
        );
        let beside = CollisionObject::new(
            "box",
            link,
            Vector3::zero(),
            Shape::cuboid([0.2; 3]).unwrap(),
        );
        for objects in [
            vec![cloud.clone()],
            vec![cloud.clone(), beside],
            vec![cloud.clone(), cloud],
        ] {
            let bodies = CollisionModel::new(robot.model(), objects).unwrap();
            for fineness in [Resolution::MaxProtrusion(0.05), Resolution::PerLink(2)] {
                spheres_of(&mut digest, &SphereModel::of(&bodies, fineness).unwrap());
            }
        }
    }
    digest.value()
}

/// Plates, of which the first balls that are found make some needless that came before.
fn plates() -> Value {
    let (mut digest, robot) = (Digest::new(), Robot::parse(ROBOT, "r.urdf").unwrap());
    let link = robot.model().frame("hand").unwrap();
    for size in [[0.4, 0.4, 0.05], [0.5, 0.3, 0.06]] {
        let plate = Shape::cuboid(size).unwrap();
        let plate = CollisionObject::new("plate", link, Vector3::zero(), plate);
        let bodies = CollisionModel::new(robot.model(), vec![plate]).unwrap();
        let cover = SphereModel::of(&bodies, Resolution::MaxProtrusion(0.05)).unwrap();
        spheres_of(&mut digest, &cover);
    }
    digest.value()
}

#[test]
fn of_plates() {
    check(&[("spheres that cover plates", plates())]);
}

#[test]
fn of_capsules_and_clouds() {
    check(&[("capsules of robots and clouds, mixed", capsules())]);
}

#[test]
fn of_shapes_through_serde() {
    check(&[("shapes and spheres through serde, changed", serialised())]);
}

#[test]
fn of_texts_of_spheres() {
    check(&[("texts of spheres, changed", spheres())]);
}
