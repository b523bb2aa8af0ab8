//! Promise: invalid obstacles are rejected with their name and change nothing. Worlds of valid obstacles cause no
//! panic, no non-finite number and no reached result in contact.

use kinopt::arm::Arm;
use kinopt::collision::{Checker, CollisionModel, Shape, World, separation};
use kinopt::spatial::{Matrix3, Placement, Vector3};
use support::arms::robot;
use support::random::{Random, cases};

/// Invalid lengths, and valid ones.
const INVALID_LENGTHS: [f64; 7] = [
    0.0,
    -0.1,
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    1e-10,
    1e10,
];
const VALID_LENGTHS: [f64; 6] = [1e-9, 1e-4, 0.05, 0.3, 1e3, 1e9];

/// Random generator of obstacles that is sometimes invalid, which `bad` records.
struct RandomWorld {
    random: Random,
    bad: bool,
}

impl RandomWorld {
    fn length(&mut self) -> f64 {
        if self.random.below(12) == 0 {
            self.bad = true;
            return INVALID_LENGTHS[self.random.below(INVALID_LENGTHS.len())];
        }
        VALID_LENGTHS[self.random.below(VALID_LENGTHS.len())]
    }

    /// Lengths of one shape: a ratio above 10¹² is invalid.
    fn lengths<const N: usize>(&mut self) -> [f64; N] {
        let lengths = [(); N].map(|()| self.length());
        let longest = lengths.iter().copied().fold(0.0, f64::max);
        self.bad |= lengths.iter().any(|length| longest > 1e12 * length);
        lengths
    }

    fn coordinate(&mut self) -> f64 {
        if self.random.below(30) == 0 {
            self.bad = true;
            return [f64::NAN, f64::INFINITY, f64::NEG_INFINITY][self.random.below(3)];
        }
        self.random.within(-1.0, 1.0)
    }

    fn point(&mut self) -> Vector3<f64> {
        [(); 3].map(|()| self.coordinate()).into()
    }

    fn placement(&mut self) -> Placement<f64> {
        let rotation = match self.random.below(15) {
            0 => {
                self.bad = true;
                let [x, y, z] = Vector3::UNITS;
                [
                    Matrix3::from_columns(-x, y, z),
                    Matrix3::from_columns(x, x, z),
                    Matrix3::from_columns(x * 2.0, y, z),
                ][self.random.below(3)]
            }
            _ => Matrix3::identity(),
        };
        Placement::new(rotation, self.point())
    }

    /// A tetrahedron: whole, open, with inconsistent winding, with a degenerate triangle, or with a missing vertex.
    fn mesh(&mut self) -> (Vec<Vector3<f64>>, Vec<[u32; 3]>) {
        let corners = [(); 4].map(|()| self.point()).to_vec();
        let mut triangles = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
        match self.random.below(6) {
            0 => drop(triangles.pop()),
            1 => triangles[0].swap(0, 1),
            2 => triangles.push([1, 1, 3]),
            3 => {
                self.bad = true;
                triangles.push([0, 1, 4]);
            }
            _ => {}
        }
        (corners, triangles)
    }
}

#[test]
fn invalid_obstacles_are_rejected_by_name() {
    let robot = robot("franka_panda");
    let bodies = CollisionModel::of(&robot).unwrap();
    let bodies = bodies.with_pairs_sampled(200, 1).unwrap();
    let checker = Checker::covered(bodies);
    let rest = robot.model().neutral();
    let mut arm = Arm::new(&robot, "base", "flange").unwrap();
    let mut drawn = RandomWorld {
        random: Random::new(31),
        bad: false,
    };
    let (mut refused, mut taken, mut reached) = (0, 0, 0);
    for _ in cases(300, 40) {
        let mut world = World::new();
        for _ in 0..8 {
            drawn.bad = false;
            let before = (world.len(), world.revision());
            // Few names, so that some repeat.
            let name = format!("thing {}", drawn.random.below(12));
            drawn.bad |= world.obstacle(&name).is_ok();
            let at = drawn.placement();
            let added = match drawn.random.below(7) {
                0 => world.add_box(&name, drawn.lengths(), at),
                1 => world.add_sphere(&name, drawn.length(), at),
                2 => {
                    let [radius, length] = drawn.lengths();
                    world.add_cylinder(&name, radius, length, at)
                }
                3 => {
                    let [radius, length] = drawn.lengths();
                    world.add_capsule(&name, radius, length, at)
                }
                4 => world.add_points(
                    &name,
                    vec![drawn.point(), drawn.point()],
                    drawn.length(),
                    at,
                ),
                5 => world.add_convex(&name, &[(); 5].map(|()| drawn.point()), at),
                _ => {
                    let (corners, triangles) = drawn.mesh();
                    world.add_mesh(&name, corners, triangles, at)
                }
            };
            assert_eq!(added.is_err(), drawn.bad, "{name}: {added:?}");
            match added {
                Err(error) => {
                    refused += 1;
                    let message = error.to_string();
                    assert!(message.contains(&format!("{name:?}")), "{message}");
                    assert_eq!((world.len(), world.revision()), before);
                }
                Ok(()) => taken += 1,
            }
        }
        let among = checker.clone().with_world(&world).unwrap();
        arm = arm.with_checker(&among, &rest).unwrap();
        let [goal, start] = [(); 2].map(|()| {
            let limits = arm.limits();
            limits
                .map(|l| drawn.random.within(l.lower, l.upper))
                .collect::<Vec<_>>()
        });
        // Most starts and goals are deep inside an obstacle.
        let solution = arm
            .solve(arm.base_from_tool(&goal).unwrap(), &start)
            .unwrap();
        assert!(solution.q.iter().all(|value| value.is_finite()));
        let touched = arm.collisions(&solution.q).unwrap();
        assert_eq!(solution.collisions(), touched);
        assert_eq!(
            solution.reached,
            solution.goals_reached() && touched.is_empty()
        );
        assert!(
            touched.iter().all(|pair| pair.distance.is_finite()),
            "{touched:?}"
        );
        reached += usize::from(solution.reached);
    }
    assert!(
        refused > 50 && taken > 100 && reached > 0,
        "{refused} {taken} {reached}"
    );
}

#[test]
fn arm_leaves_an_obstacle_it_starts_in() {
    let robot = robot("franka_panda");
    let bodies = CollisionModel::of(&robot).unwrap();
    let bodies = bodies.with_pairs_sampled(200, 1).unwrap();
    let checker = Checker::covered(bodies);
    let rest = robot.model().neutral();
    let arm = Arm::new(&robot, "base", "flange").unwrap();
    let inside = [0.0, -0.3, 0.0, -2.0, 0.0, 1.9, 0.8];
    let outside = [1.8, -0.3, 0.0, -2.0, 0.0, 1.9, 0.8];
    let mut world = World::new();
    let tool = arm.base_from_tool(&inside).unwrap();
    world.add_box("crate", [0.5; 3], tool.translation).unwrap();
    let arm = arm
        .with_checker(&checker.with_world(&world).unwrap(), &rest)
        .unwrap();
    let deep = arm.collisions(&inside).unwrap();
    assert!(
        deep[0].depth() > 0.1 && deep[0].second == "crate",
        "{deep:?}"
    );
    let target = arm.base_from_tool(&outside).unwrap();
    let solution = arm.solve(target, &inside).unwrap();
    assert!(solution.reached, "{}", solution.explain());
    assert!(arm.collisions(&solution.q).unwrap().is_empty());

    // A path that starts in contact reports it at every pose until one is free.
    let path = [tool, target];
    for solution in arm.track(&path, &inside).unwrap().solutions {
        let touched = arm.collisions(&solution.q).unwrap();
        assert!(!solution.reached || touched.is_empty(), "{touched:?}");
        assert!(solution.reached || !solution.collisions().is_empty());
    }
}

#[test]
fn slender_boxes_are_measured_or_rejected() {
    let ball = Shape::sphere(0.1).unwrap();
    for long in [1e3, 1e6, 1e9] {
        for thin in [1e-12 * long, 1e-9 * long, 1e-6 * long] {
            let plate = Shape::cuboid([0.05_f64.max(thin), long, thin]).unwrap();
            for gap in [-0.02, 0.0, 1e-3, 0.5] {
                // Above the plate's middle, and off it.
                for along in [0.0, 0.3 * long] {
                    let at = Vector3::new(0.01, along, 0.5 * thin + 0.1 + gap);
                    let found = separation(&plate, &Placement::identity(), &ball, &at.into());
                    let resolved = 1e-9 + 4.0 * f64::EPSILON * long;
                    let deviation = found.distance - gap;
                    assert!(
                        deviation.abs() < resolved,
                        "{long:e} {thin:e} {gap} {along}: {deviation:e}"
                    );
                }
            }
        }
    }
    let error = Shape::cuboid([0.05, 1e9, 1e-9]).unwrap_err();
    let reported = "the length of the box along y is 1e9 and the length of the box along z 1e-9: more than 1e12 times";
    assert_eq!(error.to_string(), reported);
}
