//! Promise: so it is for clips made of other clips and of poses.
#![allow(clippy::unwrap_used)]

use glam::Vec3;
use kinopt::animation::{Clip, KeyTolerance, Playback, Pose};
use support::random::Random;

use crate::animated::{armature, bone, check_single, pose};
use crate::clips::varied;
use crate::digest::{Digest, Value};

fn edited() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(115));
    let body = armature(16, &mut random);
    let small = armature(2, &mut random);
    let clip = varied(&body, &mut random);
    let baked = clip.baked(&body, 7.0).unwrap();
    digest.clip(&body, &baked);
    digest.clip(&body, &clip.baked(&body, 1.0).unwrap());
    let some = KeyTolerance::default()
        .with_translation(0.3)
        .with_rotation(0.4)
        .with_scale(0.2);
    let dense = clip.baked(&body, 30.0).unwrap();
    for tolerance in [
        KeyTolerance::EXACT,
        some,
        some.with_translation(-1.0).with_rotation(f32::NAN),
        some.with_scale(100.0).with_rotation(10.0),
    ] {
        digest.json(&tolerance);
        digest.clip(&body, &dense.with_fewer_keys(&body, &tolerance).unwrap());
        digest.clip(&body, &clip.with_fewer_keys(&body, &tolerance).unwrap());
    }
    for (seconds, rate) in [(0.5, 8.0), (3.5, 4.0), (1.0, 2.5)] {
        digest.clip(&body, &clip.with_closed_seam(&body, seconds, rate).unwrap());
    }
    let up = Vec3::new(0.2, 1.0, -0.1);
    for index in [0, 5, 9] {
        let (bone, rate) = (bone(&body, index), 6.0);
        let (still, motion) = clip.without_root_motion(&body, bone, up, rate).unwrap();
        digest.clip(&body, &still);
        digest.json(motion.way());
        digest.json(motion.heading());
        for playback in [Playback::Hold, Playback::Loop, Playback::PingPong] {
            for elapsed in [-4.5, 0.0, 1.25, 3.5, 9.0, 40.0, f64::NAN, 4e3] {
                digest.affine(&motion.after(elapsed, playback));
            }
        }
        digest.affine(&motion.at(0.3));
        digest.clip(
            &body,
            &still.with_root_motion(&body, bone, &motion, 3.0).unwrap(),
        );
    }
    // Ends that single precision puts a hair behind a sample, or before it.
    for [start, end] in [
        [0.0, 3.3],
        [0.1, 3.4],
        [-100.3, -97.0],
        [-0.7, 0.2],
        [1000.1, 1001.2],
    ] {
        let poses = [(); 2].map(|()| pose(&small, &mut random));
        let clip = Clip::through_poses("ends", &small, &[start, end], &poses).unwrap();
        for rate in [10.0, 30.0, 60.0] {
            digest.clip(&small, &clip.baked(&small, rate).unwrap());
        }
    }
    let moment = clip.span()[0];
    let one = [body.rest().clone()];
    let one = Clip::through_poses("one", &body, &[moment], &one).unwrap();
    let (still, motion) = one
        .without_root_motion(&body, bone(&body, 0), up, 5.0)
        .unwrap();
    digest.clip(&body, &still);
    digest.affine(&motion.after(2.0, Playback::Loop));
    let poses: Vec<Pose> = (0..3).map(|_| pose(&body, &mut random)).collect();
    let through = |times: &[f32], poses: &[Pose]| Clip::through_poses("p", &body, times, poses);
    digest.clip(&body, &through(&[0.0, 0.5, 2.0], &poses).unwrap());
    let same = [poses[0].clone(), poses[0].clone()];
    digest.clip(&body, &through(&[1.0, 2.0], &same).unwrap());
    digest.refused(through(&[], &[]));
    digest.refused(through(&[0.0], &poses));
    digest.refused(through(&[0.0, 0.0], &same));
    digest.refused(through(&[0.0], &[small.rest().clone()]));
    for rate in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e7] {
        digest.refused(clip.baked(&body, rate));
    }
    digest.refused(clip.baked(&small, 5.0));
    digest.refused(clip.with_fewer_keys(&small, &some));
    for seconds in [0.0, -1.0, 3.75, f64::NAN] {
        digest.refused(clip.with_closed_seam(&body, seconds, 5.0));
    }
    let first = bone(&body, 0);
    for up in [Vec3::ZERO, Vec3::NAN] {
        digest.refused(clip.without_root_motion(&body, first, up, 5.0));
    }
    let far = armature(30, &mut random).bone_at(29).unwrap();
    digest.refused(clip.without_root_motion(&body, far, up, 5.0));
    digest.refused(clip.with_root_motion(&small, first, &motion, 5.0));
    digest.value()
}

#[test]
fn of_edited_clips() {
    check_single(&[("clips of other clips", edited())]);
}
