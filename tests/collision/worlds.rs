//! Promise: obstacles are edited by name, every edit raises the revision, copies are independent, and unknown names are
//! reported with the known ones.

use kinopt::collision::{World, WorldError};
use kinopt::spatial::{Matrix3, Placement, Vector3};
use support::fault_tables::ExpectedError;

fn at(x: f64) -> Placement<f64> {
    Placement::translation(Vector3::new(x, 0.0, 0.0))
}

#[test]
fn obstacles_are_edited_by_name() {
    let mut world = World::new();
    world.add_box("table", [1.0, 0.5, 0.1], at(0.5)).unwrap();
    world.add_sphere("ball", 0.1, at(1.0)).unwrap();
    let before = world.clone();
    let mut revision = world.revision();
    let mut raised = |world: &World| {
        assert!(world.revision() > revision);
        revision = world.revision();
    };
    world.move_to("ball", at(2.0)).unwrap();
    raised(&world);
    world.attach("ball", "hand", at(0.1)).unwrap();
    raised(&world);
    assert_eq!(
        world.obstacle("ball").unwrap().attached.as_deref(),
        Some("hand")
    );
    world.detach("ball", at(3.0)).unwrap();
    raised(&world);
    let ball = world.obstacle("ball").unwrap();
    assert_eq!((ball.attached.clone(), ball.placement), (None, at(3.0)));
    world.remove("table").unwrap();
    raised(&world);
    assert_eq!(
        world.obstacles().map(|o| &*o.name).collect::<Vec<_>>(),
        ["ball"]
    );
    // The iterator counts the remaining obstacles.
    let mut reported = before.obstacles();
    assert!(reported.next().is_some());
    assert_eq!(reported.len(), 1);
    // The copy is unchanged.
    assert_eq!(before.len(), 2);
    assert_eq!(before.obstacle("ball").unwrap().placement, at(1.0));
}

#[test]
fn invalid_edits_change_nothing() {
    let mut world = World::new();
    world.add_plane("floor", at(0.0)).unwrap();
    let revision = world.revision();
    assert!(matches!(
        world.add_sphere("floor", 1.0, at(0.0)),
        Err(WorldError::Taken(_))
    ));
    let message = world
        .add_sphere("ball", 0.0, at(0.0))
        .unwrap_err()
        .to_string();
    assert!(
        message.contains("\"ball\"") && message.contains("radius"),
        "{message}"
    );
    for message in [
        world.move_to("wall", at(0.0)).unwrap_err(),
        world.remove("wall").unwrap_err(),
        world.attach("wall", "hand", at(0.0)).unwrap_err(),
        world.detach("wall", at(0.0)).unwrap_err(),
        world.obstacle("wall").unwrap_err(),
    ] {
        let message = message.to_string();
        assert!(
            message.contains("wall") && message.contains("floor"),
            "{message}"
        );
    }
    // An obstacle that was never attached cannot be detached.
    world.detach("floor", at(0.0)).says("\"floor\" | attached");
    // Singular and plural are correct.
    let flat = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
    let flat = flat.map(Vector3::from);
    let message = world.add_convex("flat", &flat, at(0.0)).unwrap_err();
    assert!(
        message.to_string().ends_with("lie in one plane"),
        "{message}"
    );
    let mirrored = Matrix3::from_columns(
        Vector3::new(-1.0, 0.0, 0.0),
        Vector3::new(0.0, 1.0, 0.0),
        Vector3::new(0.0, 0.0, 1.0),
    );
    let mirror = Placement::new(mirrored, Vector3::zero());
    assert!(world.move_to("floor", mirror).is_err());
    assert!(world.move_to("floor", at(f64::NAN)).is_err());
    assert_eq!((world.len(), world.revision()), (1, revision));
}
