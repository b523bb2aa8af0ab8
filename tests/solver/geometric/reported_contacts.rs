//! Promise: geometric methods do not avoid collisions, but report contacts: a result in contact is not reached.

use kinopt::Problem;
use kinopt::collision::{Checker, CollisionModel, CollisionObject, Shape, World};
use kinopt::geometric::{Ccd, Elbow, Fabrik, Geometric, TwoBone};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::Point;
use support::planar_arm;

#[test]
fn result_in_contact_is_reported_not_reached() {
    let model = planar_arm(&[1.0, 1.0], None);
    let tip = model.frame("tip").unwrap();
    let ball = Shape::sphere(0.1).unwrap();
    let hand = CollisionObject::new("hand", tip, Placement::identity(), ball);
    let shapes = CollisionModel::new(&model, vec![hand]).unwrap();
    let (target, start) = (Vector3::new(1.0, 1.0, 0.0), [0.3, 0.4]);
    let methods: [&dyn Geometric; 3] = [
        &TwoBone::new(Elbow::Positive),
        &Ccd::default(),
        &Fabrik::default(),
    ];
    for (post, free) in [([1.0, 1.1, 0.0], false), ([1.0, 1.5, 0.0], true)] {
        let mut world = World::new();
        world
            .add_box("post", [0.1; 3], Placement::translation(post.into()))
            .unwrap();
        let checker = Checker::new(shapes.clone()).with_world(&world).unwrap();
        let mut tasks = Problem::builder(&model);
        tasks.add(Point::new(tip, target));
        tasks.keep_clear(&checker);
        let problem = tasks.build().unwrap();
        for method in methods {
            let name = method.name();
            let solved = method
                .solve_question((&problem).into(), &start, &mut kinopt::solver::Silent)
                .unwrap();
            let error = solved.tasks().next().unwrap().position_error().unwrap();
            assert!(error < 1e-6, "{name}: {error}");
            assert_eq!(solved.reached, free, "{name}");
            assert_eq!(solved.collisions().is_empty(), free, "{name}");
        }
    }
}
