//! Promise: targets, bounds, starts and lists of numbers of the command parse from text, and errors name the cause.

use std::str::FromStr;

use kinopt::Solver;
use kinopt::arm::Search;
use kinopt::spatial::{Placement, Quaternion, Vector3};
use kinopt_bindings::problem_file::body::{Centre, Foot, Lock};
use kinopt_bindings::problem_file::interval::Interval;
use kinopt_bindings::problem_file::methods;
use kinopt_bindings::problem_file::number_list::{not_negative, parse, parse_exactly, positive};
use kinopt_bindings::problem_file::start::{SolutionChoice, Start, search};
use kinopt_bindings::problem_file::target::{FrameTarget, RayTarget};

#[test]
fn interval_widths_and_ends_parse() {
    let at = |axis, low, high| Ok(Interval { axis, low, high });
    assert_eq!(Interval::from_str("x=0.01"), at(0, -0.01, 0.01));
    assert_eq!(Interval::from_str("z=-0.01..0.03"), at(2, -0.01, 0.03));
    assert_eq!(Interval::from_str("ry=0.5"), at(4, -0.5, 0.5));
    let free = at(5, f64::NEG_INFINITY, f64::INFINITY);
    assert_eq!(Interval::from_str("rz=free"), free);
    for (bad, reason) in [
        ("x", "AXIS=WIDTH"),
        ("w=1", "rx, ry, rz"),
        ("x=-1", "below 0"),
        ("x=2..1", "above the upper end"),
        ("rx=0..1", "symmetric"),
        ("x=wide", "not a number"),
    ] {
        let error = Interval::from_str(bad).unwrap_err();
        assert!(error.contains(reason), "{bad}: {error}");
    }
}

#[test]
fn starts_parse() {
    let start = |text: &str| text.parse::<Start>();
    assert!(matches!(start("rest"), Ok(Start::Rest)));
    assert!(matches!(start(" random "), Ok(Start::Random)));
    let is_pair = |start| matches!(start, Start::Numbers(numbers) if numbers.values == [1.0, -2.0]);
    assert!(start("1, -2").is_ok_and(is_pair));
    assert!(start("1, x").unwrap_err().contains("`x`"));
    assert!(start("home").unwrap_err().contains("`random`"));
}

#[test]
fn searches_by_name() {
    assert_eq!(search("start"), Ok(SolutionChoice::One(Search::Start)));
    assert_eq!(search("all"), Ok(SolutionChoice::All));
    for bad in ["", "All", "all:3", "best"] {
        assert!(search(bad).is_err(), "{bad}");
    }
}

#[test]
fn target_points_and_poses_parse() {
    let target = FrameTarget::from_str("left=hand=1,-2.5,3e-1").unwrap();
    assert_eq!(target.frame.as_deref(), Some("left=hand"));
    let at = Placement::translation(Vector3::new(1.0, -2.5, 0.3));
    assert_eq!((target.placement, target.turns), (at, false));
    assert_eq!(FrameTarget::from_str("1,2,3").unwrap().frame, None);
    let pose = FrameTarget::from_str("a=0,0,0,0.7071,0,0.7071,0").unwrap();
    let half = 0.5_f64.sqrt();
    let Quaternion { w, v } = Quaternion::from_matrix(&pose.placement.rotation);
    assert!((w - half).abs() < 1e-12 && (v.y - half).abs() < 1e-12);
    assert!(v.x.abs() < 1e-12 && v.z.abs() < 1e-12 && pose.turns);
}

#[test]
fn target_malformed_text_names_the_cause() {
    for (text, reason) in [
        ("a", "`a` is not a number"),
        ("=1,2,3", "expected FRAME="),
        ("a=1,2", "not 2"),
        ("a=1,2,3,4", "not 4"),
        ("a=1,2,x", "`x` is not a number"),
        ("a=1,2,inf", "not a finite number"),
        ("a=1,2,3,0,0,0,0", "length 0"),
        ("a=1,2,3,1,1,0,0", "length 1.41"),
    ] {
        let error = FrameTarget::from_str(text).unwrap_err();
        assert!(error.contains(reason), "{text}: {error}");
    }
}

#[test]
fn rays_parse() {
    let ray = RayTarget::from_str("tip=0,0,5:1,1,0").unwrap();
    assert_eq!((ray.eye, ray.through), ([0.0, 0.0, 5.0], [1.0, 1.0, 0.0]));
    let bad = [
        "tip=0,0,5",
        "tip=0,0,5:1,1",
        "tip=1,1,1:1,1,1",
        "0,0,5:1,1,1",
    ];
    for text in bad {
        assert!(RayTarget::from_str(text).is_err(), "{text}");
    }
}

#[test]
fn centres_and_feet_parse() {
    let centre = |text: &str| text.parse::<Centre>();
    assert_eq!(centre("1,-2"), Ok(Centre::Above([1.0, -2.0])));
    let at = [Some(0.5), None, Some(2.0)];
    assert_eq!(centre("0.5, free,2"), Ok(Centre::At(at)));
    for bad in ["1", "1,2,3,4", "free,free,free", "a,b", "free,1"] {
        assert!(centre(bad).is_err(), "{bad}");
    }
    let foot = |at| Foot {
        frame: "foot".to_owned(),
        at,
    };
    assert_eq!("foot".parse(), Ok(foot(None)));
    assert_eq!("foot=1,2,3".parse(), Ok(foot(Some([1.0, 2.0, 3.0]))));
    for bad in ["", "=1,2,3", "foot=1,2"] {
        assert!(bad.parse::<Foot>().is_err(), "{bad}");
    }
}

#[test]
fn locks_parse() {
    let lock = |joint: &str, value| Lock {
        joint: joint.to_owned(),
        value,
        degrees: false,
    };
    assert_eq!("elbow".parse(), Ok(lock("elbow", None)));
    assert_eq!("a=b=-1.5".parse(), Ok(lock("a=b", Some(-1.5))));
    for bad in ["", "=1", "a=", "a=x", "a=nan"] {
        assert!(bad.parse::<Lock>().is_err(), "{bad}");
    }
}

#[test]
fn separators_mix() {
    let mixed = parse("1,2 3, -4e-1\n,5").unwrap();
    assert_eq!(mixed, [1.0, 2.0, 3.0, -0.4, 5.0]);
    assert!(parse("").unwrap().is_empty());
    assert_eq!(parse_exactly::<2>("1, 2", "a pair").unwrap(), [1.0, 2.0]);
}

#[test]
fn number_invalid_text_is_named() {
    for bad in ["x", "1,nan", "1,inf", "--json"] {
        let word = bad.rsplit(',').next().unwrap_or(bad);
        assert!(parse(bad).unwrap_err().contains(word), "{bad}");
    }
    let two = parse_exactly::<3>("1,2", "a point").unwrap_err();
    assert!(two.contains("3 numbers"));
    assert!(parse_exactly::<3>("1,,2", "a point").is_err());
    assert!(positive("0").is_err() && positive("-1").is_err() && positive("2").is_ok());
    assert!(not_negative("0").is_ok() && not_negative("-1").is_err());
}

#[test]
fn default_method_is_the_library_default() {
    assert_eq!(methods::names()[0], Solver::default().method());
    for known in methods::names() {
        assert_eq!(methods::solver(known).method(), known);
    }
}
