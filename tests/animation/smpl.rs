//! Promise: motions of the SMPL family have the joints that their rotations and rest joints define. Rest joints are
//! those of the file, posed or not, of a body model, or of a default skeleton of the given height.

use kinopt::animation::{Cursor, Playback};
use kinopt::io::bvh::MotionCapture;
use kinopt::io::smpl::{BodyModel, RestJoints, SmplArrays, SmplMotion, default_joints};
use nalgebra as na;
use support::fault_tables::ExpectedError;
use support::random::Random;

/// Parents of SMPL's 24 joints.
const PARENTS: [usize; 24] = [
    0, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 9, 9, 12, 13, 14, 16, 17, 18, 19, 20, 21,
];

struct Case {
    arrays: SmplArrays,
    rest: Vec<na::Vector3<f64>>,
}

fn random_case(frames: usize) -> Case {
    let mut random = Random::new(11);
    let rest: Vec<_> = (0..24).map(|_| random.vector(0.5)).collect();
    let mut arrays = SmplArrays {
        frame_rate: 30.0,
        ..SmplArrays::default()
    };
    for _ in 0..frames {
        arrays.translations.extend(random.vector(2.0).iter());
        for _ in 0..24 {
            arrays.poses.extend(random.rotation().scaled_axis().iter());
        }
    }
    arrays.joints = Some(
        rest.iter()
            .flat_map(|joint| joint.iter().copied())
            .collect(),
    );
    Case { arrays, rest }
}

/// Joint positions by the definition of SMPL: rotations about the rest joints, then the translation.
fn expected(case: &Case, frame: usize) -> Vec<na::Vector3<f64>> {
    let pose = &case.arrays.poses[72 * frame..72 * (frame + 1)];
    let root = na::Vector3::from_column_slice(&case.arrays.translations[3 * frame..3 * frame + 3]);
    let mut world: Vec<(na::Rotation3<f64>, na::Vector3<f64>)> = Vec::new();
    for joint in 0..24 {
        let rotation = na::Rotation3::new(na::Vector3::from_column_slice(
            &pose[3 * joint..3 * joint + 3],
        ));
        world.push(match joint {
            0 => (rotation, case.rest[0] + root),
            _ => {
                let (parent, at) = world[PARENTS[joint]];
                let offset = case.rest[joint] - case.rest[PARENTS[joint]];
                (parent * rotation, at + parent * offset)
            }
        });
    }
    world.into_iter().map(|(_, at)| at).collect()
}

/// Joint positions of a motion at a frame.
fn found(motion: &SmplMotion, frame: usize) -> Vec<na::Vector3<f64>> {
    let mut pose = motion.armature.rest().clone();
    let time = frame as f64 / motion.frame_rate;
    motion
        .clip
        .sample(time, Playback::Hold, &mut Cursor::new(), &mut pose)
        .unwrap();
    let mut placed = motion.armature.rest_from_model().to_vec();
    motion.armature.local_to_model(&pose, &mut placed).unwrap();
    let origins = placed
        .iter()
        .map(|bone| bone.translation.as_dvec3().to_array());
    origins.map(na::Vector3::from).collect()
}

fn assert_near(found: &[na::Vector3<f64>], expected: &[na::Vector3<f64>]) {
    for (joint, (found, expected)) in found.iter().zip(expected).enumerate() {
        assert!(
            (found - expected).norm() < 1e-5,
            "joint {joint}: {found} {expected}"
        );
    }
}

#[test]
fn joints_are_those_of_the_definition() {
    let case = random_case(4);
    let motion = SmplMotion::new("random", &case.arrays, &RestJoints::Default).unwrap();
    assert!(motion.notes.is_empty());
    assert_eq!(motion.armature.names()[4], "left_knee");
    for frame in 0..4 {
        assert_near(&found(&motion, frame), &expected(&case, frame));
    }
    // As the content of a BVH file, read again.
    let capture = MotionCapture::from(motion.clone());
    let read =
        kinopt::io::bvh::from_bytes(capture.to_text().unwrap().as_bytes(), "random.bvh").unwrap();
    let again = SmplMotion::new("random", &case.arrays, &RestJoints::Default).unwrap();
    let mut pose = read.armature.rest().clone();
    read.clip
        .sample(
            read.frame_time,
            Playback::Hold,
            &mut Cursor::new(),
            &mut pose,
        )
        .unwrap();
    let mut placed = read.armature.rest_from_model().to_vec();
    read.armature.local_to_model(&pose, &mut placed).unwrap();
    for (name, expected) in again.armature.names().iter().zip(expected(&case, 1)) {
        let bone = read.armature.bone(name).unwrap().index();
        let at = na::Vector3::from(placed[bone].translation.as_dvec3().to_array());
        assert!((at - expected).norm() < 1e-4, "{name}: {at} {expected}");
    }
}

#[test]
fn posed_joints_determine_the_rest_joints() {
    let mut case = random_case(3);
    let posed = (0..3).flat_map(|frame| expected(&case, frame));
    case.arrays.joints = Some(posed.flat_map(|at| [at.x, at.y, at.z]).collect());
    let motion = SmplMotion::new("posed", &case.arrays, &RestJoints::Default).unwrap();
    for frame in 0..3 {
        let (found, expected) = (found(&motion, frame), expected(&case, frame));
        // The position of the pelvis at rest is unknown.
        let shift = expected[0] - found[0];
        let found: Vec<_> = found.iter().map(|at| at + shift).collect();
        assert_near(&found, &expected);
    }
}

#[test]
fn body_model_shapes_the_rest_joints() {
    let mut case = random_case(2);
    let mut random = Random::new(3);
    let vertices = 30;
    let regressor: Vec<f64> = (0..24 * vertices)
        .map(|_| random.within(0.0, 0.1))
        .collect();
    let template: Vec<f64> = (0..3 * vertices)
        .map(|_| random.within(-1.0, 1.0))
        .collect();
    let directions: Vec<f64> = (0..3 * vertices * 2)
        .map(|_| random.within(-0.1, 0.1))
        .collect();
    case.arrays.joints = None;
    case.arrays.betas = vec![0.7, -1.3, 9.0];
    let shaped: Vec<f64> = (0..3 * vertices)
        .map(|k| template[k] + 0.7 * directions[2 * k] - 1.3 * directions[2 * k + 1])
        .collect();
    let shaped = na::DMatrix::from_row_slice(vertices, 3, &shaped);
    let joints = na::DMatrix::from_row_slice(24, vertices, &regressor) * shaped;
    case.rest = joints
        .row_iter()
        .map(|row| row.transpose().fixed_rows::<3>(0).into())
        .collect();
    let model = BodyModel::new(&regressor, &template, &directions).unwrap();
    let motion = SmplMotion::new("shaped", &case.arrays, &RestJoints::BodyModel(model)).unwrap();
    assert_eq!(
        motion.notes[0].to_string(),
        "the first 2 of 3 shape components are used"
    );
    assert_near(&found(&motion, 1), &expected(&case, 1));
}

#[test]
fn default_skeleton_has_height_and_axis_of_the_motion() {
    for (joints, angle, up) in [
        (24, 0.0, 1),
        (52, 0.5 * std::f64::consts::PI, 2),
        (55, 0.0, 1),
    ] {
        let mut arrays = SmplArrays {
            frame_rate: 30.0,
            poses: vec![0.0; 3 * joints],
            translations: vec![0.0; 3],
            ..SmplArrays::default()
        };
        arrays.poses[0] = angle;
        let motion = SmplMotion::new("stand", &arrays, &RestJoints::Height(2.0)).unwrap();
        assert_eq!(motion.armature.bones(), joints);
        assert!(
            motion.notes[0]
                .to_string()
                .contains("a default skeleton of 2 m")
        );
        // Winter's figure 4.1: the knee is at 0.285, the ankle at 0.039 of the height. The rest pose is upright as well.
        let rest: Vec<_> = {
            let inverses = motion.armature.rest_from_model().iter();
            inverses
                .map(|bone| bone.inverse().translation.as_dvec3().to_array())
                .collect()
        };
        for joints in [
            found(&motion, 0).iter().map(|at| (*at).into()).collect(),
            rest,
        ] {
            let joints: Vec<[f64; 3]> = joints;
            let height = joints[4][up] - joints[7][up];
            assert!((height - 2.0 * (0.285 - 0.039)).abs() < 1e-6, "{height}");
        }
    }
    assert_eq!(default_joints(1.0).len(), 24);
}

#[test]
fn invalid_arrays_are_named() {
    let build = |change: fn(&mut SmplArrays)| {
        let mut arrays = random_case(2).arrays;
        change(&mut arrays);
        SmplMotion::new("bad", &arrays, &RestJoints::Default)
    };
    build(|arrays| arrays.poses.truncate(100)).says("poses have 50 numbers a frame | 156 (SMPL-H)");
    build(|arrays| arrays.translations.clear()).says("no frames");
    build(|arrays| arrays.poses[3] = f64::NAN).says("`poses` | index 3");
    build(|arrays| arrays.frame_rate = 0.0).says("frame rate is 0");
    build(|arrays| arrays.joints = Some(vec![0.0; 30])).says("jtr");
    let mut arrays = random_case(1).arrays;
    arrays.joints = None;
    SmplMotion::new("tall", &arrays, &RestJoints::Height(-1.0)).says("height is -1 m");
}
