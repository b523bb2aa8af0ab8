//! Promise: a drag through a wall that is thinner than its steps stops at the near side, in contact with it.

use kinopt::Problem;
use kinopt::collision::{Checker, CollisionModel, CollisionObject, Shape, World};
use kinopt::ik::Drag;
use kinopt::kinematics::ForwardKinematics;
use kinopt::model::{Limits, Model};
use kinopt::spatial::{Placement, Vector3};
use kinopt::task::Point;

/// Radius of the sphere, metres.
const RADIUS: f64 = 0.02;
const THICKNESS: f64 = 1e-3;
/// Near side of the wall, metres along y.
const WALL_DISTANCE: f64 = 0.1;

/// Positions of the tip after each frame of a drag beyond a wall. The tip is a sphere at the end of a planar chain of 1
/// m, initially along x.
fn dragged(links: usize) -> Vec<Vector3<f64>> {
    let mut builder = Model::builder("arm");
    let [x, y, z] = Vector3::UNITS;
    let length = 1.0 / links as f64;
    let (mut last, mut start) = (None, Vec::new());
    for k in 0..links {
        let at = Placement::translation(x * if k == 0 { 0.0 } else { length });
        let limits = Limits::new(-2.5, 2.5);
        last = Some(builder.revolute(format!("joint {k}"), last, at, z, limits));
        start.push([-0.4, 0.8, -0.4][k] * if links == 1 { 0.0 } else { 1.0 });
    }
    let tip = builder.frame("tip", last, Placement::translation(x * length));
    let model = builder.build().unwrap();
    let ball = Shape::sphere(RADIUS).unwrap();
    let ball = CollisionObject::new("ball", tip, Placement::identity(), ball);
    let mut kinematics = ForwardKinematics::new(&model);
    let from = kinematics.place(&start).unwrap()[tip.index()].translation;
    let mut world = World::new();
    let wall = Vector3::new(1.0, from.y + WALL_DISTANCE + 0.5 * THICKNESS, 0.0);
    world.add_box("wall", [3.0, THICKNESS, 1.0], wall).unwrap();
    let checker = Checker::new(CollisionModel::new(&model, vec![ball]).unwrap());
    let checker = checker.with_world(&world).unwrap();
    let mut tasks = Problem::builder(&model);
    let task = tasks.add(Point::new(tip, from));
    tasks.keep_clear(&checker);
    let mut drag = Drag::new(tasks.build().unwrap(), &start).unwrap();
    drag.target_mut(task)
        .unwrap()
        .set_target(from + y * 0.6 - x * 0.2);
    let mut workspace = checker.workspace();
    let places = (0..30).map(|frame| {
        let before = drag.q().to_vec();
        drag.advance();
        let motion = checker
            .check_motion(&mut workspace, &before, drag.q())
            .unwrap();
        assert_eq!(motion.blocked_by, None, "frame {frame}");
        kinematics.place(drag.q()).unwrap()[tip.index()].translation - y * from.y
    });
    places.collect()
}

#[test]
fn drag_through_a_thin_wall_stops_at_it() {
    for links in [1, 3] {
        let places = dragged(links);
        for (frame, at) in places.iter().enumerate() {
            assert!(
                at.y < WALL_DISTANCE - RADIUS + 1e-9,
                "{links} links, frame {frame}: {at:?}"
            );
        }
        let gap = WALL_DISTANCE - RADIUS - places[29].y;
        assert!(gap < 2e-3, "{links} links: {gap} m before the wall");
    }
}
