//! Tasks of whole robots around a configuration, with their expected residuals.

use super::random::Random;
use super::tasks::{TaskCase, rotation_vector, sum_case};
use super::trees::RandomTree;
use super::{Rigid, placement, rigid, vector};
use kinopt::kinematics::frame_jacobian;
use kinopt::model::{JointKind, Masses, PointMass};
use kinopt::task::{
    Axis, Bounded, CentreOfMass, FrameVelocity, Gaze, JointCoupling, Manipulability, Posture,
    Smoothness, SupportPolygon,
};
use nalgebra as na;

/// Mass on a frame of a tree: frame index, position in the frame in metres, and mass in kg.
type Mass = (usize, na::Vector3<f64>, f64);

/// A mass on every frame; masses that no joint moves are omitted from the sum.
pub fn random_masses(tree: &RandomTree, random: &mut Random) -> (Masses, Vec<Mass>) {
    let all: Vec<Mass> = (0..tree.frames.len())
        .map(|k| (k, random.vector(0.3), random.within(0.1, 5.0)))
        .collect();
    let points = all.iter().map(|&(k, at, mass)| PointMass {
        frame: tree.frames[k],
        at: vector(at),
        mass,
    });
    let masses = Masses::new(&tree.model, points).unwrap();
    let moved = |&(k, _, _): &Mass| {
        let mut ancestor = tree.frame_offsets[k].0;
        while let Some(joint) = ancestor {
            if tree.parts[joint].kind != JointKind::Fixed {
                return true;
            }
            ancestor = tree.parts[joint].parent;
        }
        false
    };
    (masses, all.into_iter().filter(moved).collect())
}

/// Centre of mass, Σ m p / Σ m.
pub fn centre(at: &[Rigid], masses: &[Mass]) -> na::Vector3<f64> {
    let total: f64 = masses.iter().map(|(_, _, mass)| mass).sum();
    let moments = masses
        .iter()
        .map(|&(k, on, mass)| (at[k] * na::Point3::from(on)).coords * mass);
    moments.sum::<na::Vector3<f64>>() / total
}

/// Vector to `at` from the closest point of the hull of points. It is zero inside any triangle of the points, and
/// otherwise ends at the closest segment between two points.
pub fn outside_hull(points: &[na::Vector2<f64>], at: na::Vector2<f64>) -> na::Vector2<f64> {
    let turn = |a: na::Vector2<f64>, b: na::Vector2<f64>| (b - a).perp(&(at - a));
    for a in points {
        for b in points {
            for c in points {
                let area = (b - a).perp(&(c - a));
                if area > 0.0 && turn(*a, *b) >= 0.0 && turn(*b, *c) >= 0.0 && turn(*c, *a) >= 0.0 {
                    return na::Vector2::zeros();
                }
            }
        }
    }
    let mut nearest = at - points[0];
    for a in points {
        for b in points {
            let edge = b - a;
            let fraction = match edge.norm_squared() {
                0.0 => 0.0,
                squared => ((at - a).dot(&edge) / squared).clamp(0.0, 1.0),
            };
            let offset = at - (a + edge * fraction);
            if offset.norm() < nearest.norm() {
                nearest = offset;
            }
        }
    }
    nearest
}

/// One task of every kind; most of them have an error at `q`.
pub fn body_cases(tree: &RandomTree, q: &[f64], random: &mut Random) -> Vec<TaskCase> {
    let mut all = balance_cases(tree, q, random);
    all.extend(joint_cases(tree, q, random));
    let at = tree.frames_at(q);
    let slot = at.len() - 2;
    let (frame, frame_pose) = (tree.frames[slot], at[slot]);

    let axis = random.direction().into_inner();
    let across = axis.cross(&random.direction()).normalize();
    for (name, off) in [
        ("gaze along, within its cone", 0.2),
        ("gaze along", 1.3),
        ("gaze along, almost opposite", 3.0),
    ] {
        let aim = frame_pose.rotation * (axis * f64::cos(off) + across * f64::sin(off));
        all.push(sum_case(
            name,
            move || Gaze::along(frame, axis * 2.0, aim * 0.3, 0.4),
            move |at, _| vec![((at[slot].rotation * axis).angle(&aim) - 0.4).max(0.0)],
        ));
        let gaze_target = frame_pose.translation.vector + aim * 2.0;
        all.push(sum_case(
            name,
            move || Gaze::at(frame, axis * 0.7, gaze_target, 0.4),
            move |at, _| {
                let sight = gaze_target - at[slot].translation.vector;
                vec![((at[slot].rotation * axis).angle(&sight) - 0.4).max(0.0)]
            },
        ));
    }

    let turning = random.direction();
    for (name, angle) in [
        ("frame velocity", 0.05),
        ("frame velocity at rest", 0.0),
        ("frame velocity of almost half a turn", 3.1),
    ] {
        let back = rigid(
            na::Rotation3::from_axis_angle(&turning, -angle),
            na::Vector3::zeros(),
        );
        let turned = back.rotation * frame_pose.rotation;
        let previous = rigid(turned, frame_pose.translation.vector + random.vector(0.01));
        let [v, w] = [random.vector(0.3), random.vector(0.3)];
        all.push(sum_case(
            name,
            move || FrameVelocity::new(frame, placement(&previous), 0.1, (v, w)),
            move |at, _| {
                let displacement = at[slot].translation.vector - previous.translation.vector;
                let turn = rotation_vector(at[slot].rotation * previous.rotation.inverse());
                let linear = displacement / 0.1 - v;
                let angular = na::Vector3::from_vec(turn) / 0.1 - w;
                linear.iter().chain(angular.iter()).copied().collect()
            },
        ));
    }
    all
}

fn balance_cases(tree: &RandomTree, q: &[f64], random: &mut Random) -> Vec<TaskCase> {
    let at = tree.frames_at(q);
    let other = at.len() / 2 - 1;
    let base = tree.frames[other];
    let (masses, parts) = random_masses(tree, random);
    let target = centre(&at, &parts) + random.vector(0.3);
    let mut all = Vec::new();
    let mass_data = (masses.clone(), parts.clone());
    all.push(sum_case(
        "centre of mass",
        move || CentreOfMass::new(&mass_data.0, target),
        move |at, _| (centre(at, &mass_data.1) - target).as_slice().to_vec(),
    ));
    let mass_data = (masses.clone(), parts.clone());
    all.push(sum_case(
        "centre of mass over a point",
        move || CentreOfMass::new(&mass_data.0, target).free_along(Axis::Z),
        move |at, _| (centre(at, &mass_data.1) - target).as_slice()[..2].to_vec(),
    ));
    let mass_data = (masses.clone(), parts.clone());
    let seen = at[other].inverse() * na::Point3::from(target);
    all.push(sum_case(
        "centre of mass in a base",
        move || {
            let task = CentreOfMass::new(&mass_data.0, seen.coords).relative_to(base);
            task.free_along(Axis::X)
        },
        move |at, _| {
            let placed = at[other].inverse() * na::Point3::from(centre(at, &mass_data.1));
            (placed - seen).as_slice()[1..].to_vec()
        },
    ));
    let mass_data = (masses.clone(), parts.clone());
    all.push(sum_case(
        "centre of mass within a room",
        move || Bounded::new(CentreOfMass::new(&mass_data.0, target), 0.05),
        move |at, _| {
            let miss = centre(at, &mass_data.1) - target;
            miss.iter().map(|v| v - v.clamp(-0.05, 0.05)).collect()
        },
    ));

    let corners: Vec<na::Vector3<f64>> = (0..6).map(|_| target + random.vector(0.2)).collect();
    let mass_data = (masses.clone(), parts.clone());
    let flat = |v: &na::Vector3<f64>| v.xy();
    let points = corners.clone();
    all.push(sum_case(
        "support polygon",
        move || SupportPolygon::new(&mass_data.0).with_points(points.iter().map(|p| vector(*p))),
        move |at, _| {
            let hull: Vec<_> = corners.iter().map(flat).collect();
            outside_hull(&hull, centre(at, &mass_data.1).xy())
                .as_slice()
                .to_vec()
        },
    ));
    let feet: Vec<(usize, Vec<na::Vector3<f64>>)> = [other, at.len() - 2]
        .map(|foot| {
            let local_target = at[foot].inverse() * na::Point3::from(target);
            let soles = (0..3).map(|_| local_target.coords + random.vector(0.2));
            (foot, soles.collect())
        })
        .to_vec();
    let carried = feet.clone();
    let frames = tree.frames.clone();
    all.push(sum_case(
        "support polygon on feet that move",
        move || {
            let polygon = SupportPolygon::new(&masses).with_up([0.0, 2.0, 0.0]);
            let feet = carried.iter();
            feet.fold(polygon, |polygon, (foot, soles)| {
                polygon.with_points_on(frames[*foot], soles.iter().map(|p| vector(*p)))
            })
        },
        move |at, _| {
            // With y up, x and z are horizontal.
            let seen = |v: na::Vector3<f64>| na::Vector2::new(v.z, v.x);
            let soles = feet.iter().flat_map(|(foot, soles)| {
                let points = soles.iter().map(|p| at[*foot] * na::Point3::from(*p));
                points.map(|p| seen(p.coords))
            });
            let hull: Vec<_> = soles.collect();
            outside_hull(&hull, seen(centre(at, &parts)))
                .as_slice()
                .to_vec()
        },
    ));
    all
}

fn joint_cases(tree: &RandomTree, q: &[f64], random: &mut Random) -> Vec<TaskCase> {
    let (model, count) = (tree.model.clone(), q.len());
    let mut all = Vec::new();
    let coefficients: Vec<f64> = q.iter().map(|_| random.within(-2.0, 2.0)).collect();
    let joints = model.moving_joints().to_vec();
    let (tree_model, factors) = (model.clone(), coefficients.clone());
    all.push(sum_case(
        "joint coupling",
        move || {
            let pairs = joints.iter().copied().zip(factors.iter().copied());
            JointCoupling::new(&tree_model, pairs, 0.3)
        },
        move |_, q| {
            let sum: f64 = q.iter().zip(&coefficients).map(|(a, b)| a * b).sum();
            vec![sum - 0.3]
        },
    ));

    let reference: Vec<f64> = q.iter().map(|_| random.within(-1.0, 1.0)).collect();
    let weights: Vec<f64> = q.iter().map(|_| random.within(0.0, 3.0)).collect();
    let rows = {
        let (reference, weights) = (reference.clone(), weights.clone());
        move |q: &[f64], scale: f64| -> Vec<f64> {
            (0..count)
                .map(|k| weights[k] * (q[k] - reference[k]) * scale)
                .collect()
        }
    };
    let (tree_model, reference_copy, weighted) =
        (model.clone(), reference.clone(), weights.clone());
    let expected = rows.clone();
    all.push(sum_case(
        "posture with weights",
        move || Posture::new(&tree_model, &reference_copy).with_weights(weighted.clone()),
        move |_, q| expected(q, 1.0),
    ));
    let tree_model = model.clone();
    all.push(sum_case(
        "smoothness with weights",
        move || Smoothness::new(&tree_model, &reference, 0.02).with_weights(weights.clone()),
        move |_, q| rows(q, 1.0 / 0.02),
    ));

    let (slot, other) = (tree.frames.len() - 2, tree.frames.len() / 2 - 1);
    for (name, base, part) in [
        ("manipulability", None, 0..6),
        ("manipulability of a position", None, 0..3),
        ("manipulability of an orientation", None, 3..6),
        ("manipulability against a frame", Some(other), 0..3),
    ] {
        let path = |k: usize| {
            let mut joints = Vec::new();
            let mut ancestor = tree.frame_offsets[k].0;
            while let Some(joint) = ancestor {
                joints.push(tree.joints[joint]);
                ancestor = tree.parts[joint].parent;
            }
            joints
        };
        let (down, up) = (path(slot), base.map_or(Vec::new(), path));
        let between = |joint: &kinopt::model::JointId| down.contains(joint) != up.contains(joint);
        let columns: Vec<bool> = model.moving_joints().iter().map(between).collect();
        let turning = columns
            .iter()
            .zip(model.moving_joints())
            .filter(|(between, joint)| {
                **between && model.joints()[joint.index()].kind != JointKind::Prismatic
            });
        let (turning, moving) = (turning.count(), columns.iter().filter(|b| **b).count());
        if moving < part.len() || (part.end == 6 && turning < 3) {
            continue;
        }
        let (tree_model, frame, base) = (
            model.clone(),
            tree.frames[slot],
            base.map(|k| tree.frames[k]),
        );
        let rows = part.clone();
        let product = move |q: &[f64]| -> na::DMatrix<f64> {
            let jacobian_of = |frame| frame_jacobian(&tree_model, frame, q).unwrap();
            let tip = jacobian_of(frame);
            let at = kinopt::kinematics::ForwardKinematics::new(&tree_model)
                .place(q)
                .unwrap()[frame.index()]
            .translation;
            let mut sum = na::DMatrix::zeros(rows.len(), rows.len());
            for (k, _) in columns.iter().enumerate().filter(|(_, between)| **between) {
                let mut column = tip.column(k).into_owned();
                if let Some(base) = base {
                    // Motion of the base at the tip is subtracted.
                    let moved = jacobian_of(base);
                    let base_origin = kinopt::kinematics::ForwardKinematics::new(&tree_model)
                        .place(q)
                        .unwrap()[base.index()]
                    .translation;
                    let lever = na::Vector3::from(at) - na::Vector3::from(base_origin);
                    let turn = moved.fixed_view::<3, 1>(3, k).into_owned();
                    let carried = moved.fixed_view::<3, 1>(0, k) + turn.cross(&lever);
                    for r in 0..3 {
                        column[r] -= carried[r];
                        column[3 + r] -= turn[r];
                    }
                }
                let column = column.rows(rows.start, rows.len()).into_owned();
                sum += &column * column.transpose();
            }
            sum
        };
        // Configurations near the kink of the measure are excluded.
        if product(q).symmetric_eigenvalues().min() < 0.02 {
            continue;
        }
        let measure = move |q: &[f64]| product(q).determinant().max(0.0).sqrt();
        // Twice the current measure, so that half of the requirement is missing.
        let required = 2.0 * measure(q);
        let tree_model = model.clone();
        all.push(sum_case(
            name,
            move || {
                let task = Manipulability::new(&tree_model, base, frame, required);
                match (part.start, part.end) {
                    (0, 3) => task.of_position(),
                    (3, _) => task.of_orientation(),
                    _ => task,
                }
            },
            move |_, q| vec![(1.0 - measure(q) / required).max(0.0)],
        ));
    }
    all
}
