//! Promise: collision avoidance has the priority of the first required tasks, whatever the levels of tasks and soft
//! tasks. A hand whose target is behind an obstacle slides around it.

use kinopt::Problem;
use kinopt::collision::{Checker, CollisionModel, CollisionObject, Shape, World};
use kinopt::ik::Drag;
use kinopt::model::{FrameId, Limits, Model};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{Plane, Point, Posture, Task};

/// Sphere of radius 5 cm on prismatic joints along x and y with a range of ±`range`.
pub(crate) fn ball_on_slides(range: f64) -> (FrameId, CollisionModel) {
    let mut builder = Model::builder("slides");
    let [x, y, _] = Vector3::UNITS;
    let (origin, limits) = (Placement::identity(), Limits::new(-range, range));
    let first = builder.prismatic("x", None, origin, x, limits);
    let second = builder.prismatic("y", Some(first), origin, y, limits);
    let hand = builder.frame("hand", Some(second), origin);
    let model = builder.build().unwrap();
    let ball = CollisionObject::new("ball", hand, origin, Shape::sphere(0.05).unwrap());
    (hand, CollisionModel::new(&model, vec![ball]).unwrap())
}

#[test]
fn sphere_slides_around_an_obstacle() {
    let (hand, bodies) = ball_on_slides(1.0);
    let model = bodies.model().clone();
    let mut world = World::new();
    world
        .add_sphere("rock", 0.1, Placement::identity())
        .unwrap();
    let checker = Checker::new(bodies).with_world(&world).unwrap();
    for (goal, preference) in [(0, 0), (0, 2), (1, 0), (1, 3)] {
        for later in [None, Some(goal + 1)] {
            let mut tasks = Problem::builder(&model);
            let point = Point::new(hand, [0.5, 0.0, 0.0]);
            tasks.add(Task::new(point).at_level(goal));
            let rest = Task::new(Posture::new(&model, &[-0.5, 0.02]));
            tasks.add(rest.preference().at_level(preference));
            if let Some(later) = later {
                // This task is always met.
                let flat = Plane::new(hand, [0.0; 3], Vector3::UNITS[2]);
                tasks.add(Task::new(flat).at_level(later));
            }
            tasks.keep_clear(&checker);
            let mut drag = Drag::new(tasks.build().unwrap(), &[-0.5, 0.02]).unwrap();
            let solution = drag.settle(100);
            let (q, reported) = (solution.q.clone(), solution.explain());
            assert!(solution.reached, "{goal} {preference}: {q:?} {reported}");
        }
    }
}
