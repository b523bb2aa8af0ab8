//! Promise: a clip with a closed seam ends as it starts, is unchanged before its last seconds, and has no jumps.

use kinopt::animation::{Clip, ClipError};
use support::armatures::{armature, difference, pose};
use support::random::Random;

use super::baked_clips::at;

#[test]
fn closed_seam_ends_at_the_start() {
    let random = &mut Random::new(61);
    let armature = armature(7, random);
    let (first, last) = (pose(&armature, random), pose(&armature, random));
    let open = Clip::through_poses("open", &armature, &[1.0, 4.0], &[first.clone(), last]).unwrap();
    let closed = open.with_closed_seam(&armature, 0.5, 120.0).unwrap();
    assert_eq!(closed.span(), open.span());
    let jump = difference(&at(&closed, &armature, 4.0), &at(&closed, &armature, 1.0));
    assert!(jump < 1e-6, "{jump}");
    let mut before = at(&closed, &armature, 1.0);
    let whole = difference(&at(&open, &armature, 1.0), &at(&open, &armature, 4.0));
    for step in 1..=360 {
        let time = 1.0 + step as f32 / 120.0;
        let now = at(&closed, &armature, time);
        if time < 3.5 {
            assert!(difference(&now, &at(&open, &armature, time)) < 1e-5);
        }
        // The correction is distributed over half a second, at most 1.5 times as fast as evenly, in addition to the
        // clip's speed.
        let most = whole * (1.5 / 60.0 + 1.0 / 360.0);
        assert!(difference(&now, &before) < 1.5 * most);
        before = now;
    }
}

#[test]
fn seam_longer_than_the_clip_is_rejected() {
    let random = &mut Random::new(62);
    let armature = armature(2, random);
    let poses = [pose(&armature, random), pose(&armature, random)];
    let clip = Clip::through_poses("short", &armature, &[0.0, 1.0], &poses).unwrap();
    for seconds in [0.0, -1.0, 1.5, f64::NAN] {
        let refused = clip.with_closed_seam(&armature, seconds, 30.0);
        assert!(
            matches!(refused, Err(ClipError::NotWithin { .. })),
            "{seconds}"
        );
    }
}
