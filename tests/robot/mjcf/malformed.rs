//! Promise: errors of an MJCF file name the line and the element.

use std::path::PathBuf;

use kinopt::robot::{ParseIssue, Robot, RobotFileError};
use support::fault_tables::ExpectedError;

fn fault(text: &str) -> (u32, String, ParseIssue) {
    match Robot::parse_mjcf(text, "robot.xml") {
        Err(RobotFileError::Element {
            file,
            line,
            element,
            fault,
        }) => {
            assert_eq!(file, "robot.xml");
            (line, element, fault)
        }
        other => panic!("{text}: {other:?}"),
    }
}

/// A document with a default section and a world.
fn world(defaults: &str, body: &str) -> String {
    format!("<mujoco>\n<default>{defaults}</default>\n<worldbody>{body}</worldbody></mujoco>")
}

#[test]
fn nested_or_repeated_class_is_named() {
    for defaults in [
        r#"<default class="a"><default class="b"><default class="a"/></default></default>"#,
        r#"<default class="a"/><default class="a"/>"#,
    ] {
        let (line, _, fault) = fault(&world(defaults, ""));
        let class = "a".to_owned();
        assert_eq!(
            (line, fault),
            (
                2,
                ParseIssue::RepeatedClass {
                    class,
                    first_line: 2
                }
            )
        );
    }
    let (_, _, main) = fault(&world(r#"<default class="main"/>"#, ""));
    assert!(matches!(
        main,
        ParseIssue::RepeatedClass { first_line: 0, .. }
    ));
    let (_, _, unnamed) = fault(&world("<default/>", ""));
    assert_eq!(unnamed, ParseIssue::MissingAttribute { attribute: "class" });
}

#[test]
fn unknown_class_lists_the_valid_ones() {
    let defaults = r#"<default class="leg"/>"#;
    for body in [
        r#"<body name="b" childclass="lek"/>"#,
        r#"<body><joint class="lek"/></body>"#,
        r#"<frame childclass="lek"/>"#,
        r#"<site class="lek"/>"#,
    ] {
        let (line, _, fault) = fault(&world(defaults, body));
        let ParseIssue::UnknownName(unknown) = fault else {
            panic!("{fault:?}")
        };
        assert_eq!(
            (line, &*unknown.name, unknown.valid.as_slice()),
            (3, "lek", &["leg".to_owned(), "main".to_owned()][..])
        );
    }
}

/// Texts within programs start with an empty line.
#[test]
fn lines_are_counted_from_the_first() {
    let zero = "<body quat=\"0 0 0 0\"/>";
    for (text, expected) in [
        (format!("<mujoco><worldbody>{zero}</worldbody></mujoco>"), 1),
        (
            format!("\n<mujoco><worldbody>{zero}</worldbody></mujoco>"),
            2,
        ),
        (
            format!("\n\n<mujoco><worldbody>\n{zero}</worldbody></mujoco>"),
            4,
        ),
        (
            format!("\u{feff}\n<mujoco>\n<worldbody>{zero}</worldbody></mujoco>"),
            3,
        ),
    ] {
        assert_eq!(fault(&text).0, expected, "{text:?}");
    }
}

#[test]
fn each_fault_is_identified() {
    let zero = |attribute| ParseIssue::ZeroLength { attribute };
    let body = |inner: &str| world("", &format!("<body name=\"b\">{inner}</body>"));
    let bodies: Vec<(String, ParseIssue)> = vec![
        (world("", r#"<body quat="0 0 0 0"/>"#), zero("quat")),
        (world("", r#"<body axisangle="0 0 0 1"/>"#), zero("axisangle")),
        (world("", r#"<body zaxis="0 0 0"/>"#), zero("zaxis")),
        (world("", r#"<body xyaxes="1 0 0 2 0 0"/>"#), zero("xyaxes")),
        (world("", r#"<site fromto="1 1 1 1 1 1"/>"#), zero("fromto")),
        (body(r#"<joint axis="0 0 0"/>"#), zero("axis")),
        (body(r#"<joint range="1 -1"/>"#), ParseIssue::LimitsOutOfOrder { lower: 1_f64.to_radians(), upper: -1_f64.to_radians() }),
        (body(r#"<joint type="ball" range="1 2"/>"#), ParseIssue::BadBallRange),
        (body(r#"<joint type="ball" limited="true"/>"#), ParseIssue::BadBallRange),
        (world("", r#"<body quat="1 0 0 0" euler="1 2 3"/>"#), ParseIssue::SeveralOrientations),
        (body("<freejoint/><joint/>"), ParseIssue::MisplacedFreeJoint),
        (body("<body><joint type=\"free\"/></body>"), ParseIssue::MisplacedFreeJoint),
        (world("", "<freejoint/>"), ParseIssue::MisplacedFreeJoint),
        (world("", "<replicate/>"), ParseIssue::UnsupportedElement { element: "replicate".to_owned() }),
        (body("<body name=\"b\"/>"), ParseIssue::DuplicateName { first_line: 3 }),
        (body("<joint name=\"j\"/><joint name=\"j\"/>"), ParseIssue::DuplicateName { first_line: 3 }),
        ("<robot/>".to_owned(), ParseIssue::NotMujoco),
        ("<mujoco><compiler autolimits=\"false\"/><worldbody><body><joint range=\"0 1\"/></body></worldbody></mujoco>".to_owned(), ParseIssue::UnsaidLimits),
        ("<mujoco><compiler eulerseq=\"xyw\"/></mujoco>".to_owned(), ParseIssue::BadEulerSequence { text: "xyw".to_owned() }),
        ("<mujoco><include/></mujoco>".to_owned(), ParseIssue::MissingAttribute { attribute: "file" }),
    ];
    for (text, expected) in bodies {
        assert_eq!(fault(&text).2, expected, "{text}");
    }
    for text in [
        body(r#"<joint type="screw"/>"#),
        "<mujoco><compiler angle=\"grad\"/></mujoco>".to_owned(),
        "<mujoco><compiler coordinate=\"global\"/></mujoco>".to_owned(),
        "<mujoco><worldbody/><equality><weld active=\"maybe\"/></equality></mujoco>".to_owned(),
    ] {
        assert!(
            matches!(fault(&text).2, ParseIssue::UnknownWord { .. }),
            "{text}"
        );
    }
    for pos in ["1 2", "1 2 3 4", "1 2 x", "1 2 nan", "1 2 1e999", ""] {
        let text = world("", &format!("<body pos=\"{pos}\"/>"));
        assert!(
            matches!(
                fault(&text).2,
                ParseIssue::BadNumbers {
                    attribute: "pos",
                    count: 3,
                    ..
                }
            ),
            "{text}"
        );
    }
    for equality in [
        r#"<joint joint1="k"/>"#,
        r#"<joint joint1="j" joint2="k"/>"#,
        r#"<connect body1="c" anchor="0 0 0"/>"#,
        r#"<weld body1="b" body2="c"/>"#,
        r#"<weld site1="b" site2="c"/>"#,
    ] {
        let text = format!(
            "<mujoco><worldbody><body name=\"b\"><joint name=\"j\"/></body></worldbody><equality>{equality}</equality></mujoco>"
        );
        assert!(
            matches!(fault(&text).2, ParseIssue::UnknownName(_)),
            "{text}"
        );
    }
}

#[test]
fn nesting_depth_is_limited() {
    let nested = |levels: usize| {
        world(
            "",
            &format!("{}{}", "<body>".repeat(levels), "</body>".repeat(levels)),
        )
    };
    // The root element and the world's element are above them.
    assert!(Robot::parse_mjcf(&nested(999), "deep.xml").is_ok());
    assert!(matches!(
        Robot::parse_mjcf(&nested(1000), "robot.xml"),
        Err(RobotFileError::Element {
            fault: ParseIssue::TooDeep { limit: 1000 },
            ..
        })
    ));
    assert!(matches!(
        Robot::parse_mjcf(&nested(1100), "robot.xml"),
        Err(RobotFileError::Element {
            fault: ParseIssue::TooDeep { .. },
            ..
        } | RobotFileError::NotXml { .. })
    ));
}

/// Creates a folder with the files of a test.
pub(crate) fn files(name: &str, files: &[(&str, &str)]) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&folder).unwrap();
    for (name, text) in files {
        std::fs::write(folder.join(name), text).unwrap();
    }
    folder
}

#[test]
fn fault_of_an_included_file_names_that_file() {
    let folder = files(
        "mjcf_included",
        &[
            (
                "main.xml",
                "<mujoco>\n\n<include file=\"part.xml\"/></mujoco>",
            ),
            (
                "part.xml",
                "<mujoco>\n<worldbody>\n<body quat=\"0 0 0 0\"/></worldbody></mujoco>",
            ),
        ],
    );
    Robot::read_mjcf(folder.join("main.xml"))
        .says("part.xml:3: <body>: attribute `quat` has length zero");
}

#[test]
fn cyclic_and_missing_includes_are_named() {
    let folder = files(
        "mjcf_rings",
        &[
            ("self.xml", "<mujoco><include file=\"self.xml\"/></mujoco>"),
            ("there.xml", "<mujoco><include file=\"back.xml\"/></mujoco>"),
            ("back.xml", "<mujoco><include file=\"there.xml\"/></mujoco>"),
            (
                "missing.xml",
                "<mujoco>\n<include file=\"nowhere.xml\"/></mujoco>",
            ),
        ],
    );
    for name in ["self.xml", "there.xml"] {
        let error = Robot::read_mjcf(folder.join(name)).unwrap_err();
        assert!(
            matches!(
                error,
                RobotFileError::Element {
                    fault: ParseIssue::IncludedTwice { .. },
                    ..
                }
            ),
            "{error}"
        );
    }
    Robot::read_mjcf(folder.join("missing.xml")).says("line 2 | nowhere.xml");
}
