//! Promise: defaults of the standard are applied with a note. Violations of the standard are errors, unless the reader
//! is lenient: then each repair is listed with its line.

use kinopt::model::Limits;
use kinopt::robot::{RepairKind, Robot};

/// Robot of one joint `j` on line 2 with the given body.
fn text(kind: &str, body: &str) -> String {
    format!(
        "<robot name=\"one\"><link name=\"a\"/><link name=\"b\"/>\n<joint name=\"j\" type=\"{kind}\">\
         <parent link=\"a\"/><child link=\"b\"/>{body}</joint></robot>"
    )
}

fn limits(robot: &Robot) -> Limits {
    robot.model().joints()[0].limits
}

fn repairs(robot: &Robot) -> Vec<String> {
    robot.repairs().iter().map(ToString::to_string).collect()
}

#[test]
fn missing_bounds_are_0_with_a_note() {
    let location = "2: joint `j`, <limit>:";
    let lower = format!("{location} `lower` is not given and taken as 0, the default");
    let upper = format!("{location} `upper` is not given and taken as 0, the default");
    for kind in ["revolute", "prismatic"] {
        for (body, expected, notes) in [
            ("<limit velocity='1'/>", (0.0, 0.0), vec![&lower, &upper]),
            ("<limit lower='-1'/>", (-1.0, 0.0), vec![&upper]),
            ("<limit upper='1'/>", (0.0, 1.0), vec![&lower]),
            ("<limit lower='-1' upper='1'/>", (-1.0, 1.0), vec![]),
        ] {
            let text = text(kind, body);
            for reader in [Robot::reader(), Robot::reader().lenient()] {
                let robot = reader.parse(&text, "one.urdf").unwrap();
                assert_eq!(limits(&robot), Limits::new(expected.0, expected.1));
                assert!(repairs(&robot).iter().eq(notes.iter().copied()));
                // A joint that cannot move is no variable, but has a coordinate.
                let locked = expected == (0.0, 0.0);
                assert_eq!(robot.map().variables(), usize::from(!locked));
                assert_eq!(robot.model().degrees_of_freedom(), 1);
            }
        }
    }
}

#[test]
fn missing_bound_from_version_1_2_is_unlimited() {
    let text = text("revolute", "<limit lower='-1'/>").replace("<robot ", "<robot version='1.2' ");
    let robot = Robot::parse(&text, "one.urdf").unwrap();
    assert_eq!(limits(&robot), Limits::new(-1.0, f64::INFINITY));
    let expected = "2: joint `j`, <limit>: `upper` is not given: no limit";
    assert_eq!(repairs(&robot), [expected]);
}

#[test]
fn missing_bound_before_version_1_2_is_0() {
    for version in ["1.0", "1.1"] {
        let version = format!("<robot version='{version}' ");
        let text = text("revolute", "<limit lower='-1'/>").replace("<robot ", &version);
        let robot = Robot::parse(&text, "one.urdf").unwrap();
        assert_eq!(limits(&robot), Limits::new(-1.0, 0.0));
    }
}

#[test]
fn mimic_without_bounds_leaves_its_source_free() {
    let two = text("revolute", "<limit lower='-1' upper='1'/>").replace(
        "</robot>",
        "<link name='c'/><joint name='k' type='revolute'><parent link='a'/><child link='c'/>\
         <limit/><mimic joint='j'/></joint></robot>",
    );
    let robot = Robot::parse(&two, "two.urdf").unwrap();
    assert_eq!(
        (robot.map().lower(), robot.map().upper()),
        (&[-1.0][..], &[1.0][..])
    );
}

/// Content of a joint, its repair, and the resulting limits.
const REPAIRED_JOINTS: [(&str, &str, &str, (f64, f64)); 8] = [
    (
        "revolute",
        "<limit lower='2' upper='-1'/>",
        "2: joint `j`, <limit>: limits out of order, taken as -1 to 2",
        (-1.0, 2.0),
    ),
    (
        "revolute",
        "",
        "2: joint `j`: there is no <limit>: the joint is locked at 0",
        (0.0, 0.0),
    ),
    (
        "revolute",
        "<limit lower='-1' upper='2'/><axis xyz='0 1 0'/><axis xyz='0 0 1'/>",
        "2: joint `j`: <axis> is given more than once; the first counts",
        (-1.0, 2.0),
    ),
    (
        "prismatic",
        "<limit lower='-1' upper='2'/><limit lower='0' upper='0'/>",
        "2: joint `j`: <limit> is given more than once; the first counts",
        (-1.0, 2.0),
    ),
    (
        "revolute",
        "<limit lower='-1' upper='2' effort='ten'/>",
        "2: joint `j`, <limit>: left out: attribute `effort` must be 1 finite number(s), not `ten`",
        (-1.0, 2.0),
    ),
    (
        "revolute",
        "<limit lower='-1' upper='2'/><dynamics/><hardware/>",
        "",
        (-1.0, 2.0),
    ),
    (
        "revolute",
        "<limit lower='-1' upper='2'/><axiss xyz='0 0 1'/>",
        "2: joint `j`: left out: `axiss` is not known; `axis` may be meant",
        (-1.0, 2.0),
    ),
    (
        "revolute",
        "<origin xyz='1, 2, -3'/><limit lower='-1' upper='2'/>",
        "2: joint `j`, <origin>: commas in `xyz` are read as spaces",
        (-1.0, 2.0),
    ),
];

#[test]
fn lenient_reader_repairs_with_notes() {
    for (kind, body, repair, expected) in REPAIRED_JOINTS {
        let text = text(kind, body);
        let robot = Robot::reader().lenient().parse(&text, "one.urdf").unwrap();
        let strict = Robot::parse(&text, "one.urdf");
        assert_eq!(
            limits(&robot),
            Limits::new(expected.0, expected.1),
            "{body}"
        );
        let listed: Vec<&str> = repair.split_terminator('\n').collect();
        assert_eq!(repairs(&robot), listed, "{body}");
        assert_eq!(strict.is_ok(), repair.is_empty(), "{body}");
    }
    let twice = text("revolute", REPAIRED_JOINTS[2].1);
    let robot = Robot::reader().lenient().parse(&twice, "one.urdf").unwrap();
    assert_eq!(robot.model().joints()[0].axis.to_array(), [0.0, 1.0, 0.0]);
    let commas = text("revolute", REPAIRED_JOINTS[7].1);
    let robot = Robot::reader().lenient().parse(&commas, "one").unwrap();
    let origin = robot.model().joints()[0].parent_from_joint.translation;
    assert_eq!(origin.to_array(), [1.0, 2.0, -3.0]);
}

#[test]
fn lenient_reader_repairs_surrounding_xml() {
    let sound = text("revolute", "<limit lower='-1' upper='2'/>");
    let nameless = sound.replacen(" name=\"one\"", "", 1);
    let drake = sound.replace("</joint>", "<drake:ratio value='1'/></joint>");
    let comment = format!("<!-- made by hand -->\n\n<?xml version=\"1.0\"?>\n{sound}");
    for (text, repair) in [
        (
            nameless,
            "1: <robot>: there is no name; the robot is called `robot`",
        ),
        (
            drake,
            "2: <robot>: prefix `drake` is not declared; its elements are extensions",
        ),
        (
            format!("\n<?xml version=\"1.0\"?>\n{sound}"),
            "2: <?xml?>: it is not at the start of the file: ignored",
        ),
        (
            comment,
            "3: <?xml?>: it is not at the start of the file: ignored",
        ),
    ] {
        assert!(Robot::parse(&text, "one.urdf").is_err());
        let robot = Robot::reader().lenient().parse(&text, "one.urdf").unwrap();
        assert_eq!(repairs(&robot), [repair]);
        assert_eq!(limits(&robot), Limits::new(-1.0, 2.0));
    }
}

#[test]
fn ambiguous_faults_stay_errors() {
    let sound = "<limit lower='-1' upper='2'/>";
    for (kind, body) in [
        ("screw", sound),
        ("revolute", "<limit lower='-1' upper='two'/>"),
        ("revolute", "<limit lower='-1' upper='0,5'/>"),
        ("revolute", "<limit lower='nan' upper='1'/>"),
        (
            "revolute",
            "<axis xyz='0 0 0'/><limit lower='-1' upper='2'/>",
        ),
        (
            "revolute",
            "<origin rpy='0 0'/><limit lower='-1' upper='2'/>",
        ),
        (
            "revolute",
            "<mimic joint='nobody'/><limit lower='-1' upper='2'/>",
        ),
        (
            "revolute",
            "<mimic joint='j'/><limit lower='-1' upper='2'/>",
        ),
    ] {
        let text = text(kind, body);
        let read = Robot::reader().lenient().parse(&text, "one.urdf");
        assert!(read.is_err(), "{kind} {body}");
    }
    for text in [
        "",
        "<robot",
        "<sdf/>",
        "<robot name='nobody'/>",
        "<?xml?><?xml?>",
    ] {
        assert!(Robot::reader().lenient().parse(text, "one.urdf").is_err());
    }
}

#[test]
fn valid_files_need_no_repair() {
    for entry in std::fs::read_dir("../models").unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "urdf") {
            let (strict, lenient) = (Robot::read(&path), Robot::reader().lenient().read(&path));
            assert_eq!(strict.unwrap().repairs(), []);
            assert_eq!(lenient.unwrap().repairs(), []);
        }
    }
    let speed = text("revolute", "<limit lower='-1' upper='1' velocity='fast'/>");
    let robot = Robot::reader().lenient().parse(&speed, "one.urdf").unwrap();
    assert!(matches!(robot.repairs()[0].mended, RepairKind::LeftOut(_)));
    let joint = robot.model().joint("j").unwrap();
    assert_eq!(robot.velocity_limit(joint), None);
}

/// Repairs are in file order with line numbers of the original file, also after an ignored multi-line XML declaration.
#[test]
fn repairs_have_lines_of_the_file() {
    let body = "\n<axis xyz='0 0 1'/>\n<axis xyz='1 0 0'/>\n<limit lower='1' upper='-1'/>";
    let body = format!("\n<origin xyz='1, 2, 3'/>{body}");
    let text = format!(
        "<!-- old -->\n<?xml version='1.0'\nencoding='utf-8'\n?>\n{}",
        text("revolute", &body)
    );
    let robot = Robot::reader().lenient().parse(&text, "one.urdf").unwrap();
    let lines: Vec<u32> = robot.repairs().iter().map(|repair| repair.line).collect();
    // The declaration, the commas, the second axis, the limits.
    assert_eq!(lines, [2, 7, 9, 10], "{:?}", repairs(&robot));
    for (line, word) in lines.iter().zip(["<?xml", "1, 2, 3", "1 0 0", "-1"]) {
        let found = text.lines().nth(*line as usize - 1).unwrap();
        assert!(found.contains(word), "{line}: {found}");
    }
}

/// A comma within a number may be a decimal comma and is never replaced.
#[test]
fn decimal_commas_are_not_separators() {
    for (xyz, is_valid) in [("1, 2, 3", true), ("0,5 2", false), ("1,2,3", false)] {
        let text = text("continuous", &format!("<origin xyz='{xyz}'/>"));
        let read = Robot::reader().lenient().parse(&text, "one.urdf");
        assert_eq!(read.is_ok(), is_valid, "{xyz}");
    }
}

#[test]
fn infinite_bounds_are_no_limits_if_lenient() {
    for (bounds, limits) in [
        ("lower='-inf' upper='1'", (f64::NEG_INFINITY, 1.0)),
        ("lower='-1' upper=' inf '", (-1.0, f64::INFINITY)),
        (
            "lower='-INF' upper='Infinity'",
            (f64::NEG_INFINITY, f64::INFINITY),
        ),
    ] {
        let text = text("revolute", &format!("<limit {bounds}/>"));
        assert!(Robot::parse(&text, "one.urdf").is_err(), "{bounds}");
        let robot = Robot::reader().lenient().parse(&text, "one.urdf").unwrap();
        assert_eq!(self::limits(&robot), Limits::new(limits.0, limits.1));
        assert!(
            repairs(&robot)[0].ends_with("is infinite: no limit"),
            "{:?}",
            repairs(&robot)
        );
    }
    for bounds in [
        "lower='inf' upper='1'",
        "lower='-1' upper='-inf'",
        "lower='nan' upper='1'",
    ] {
        let text = text("revolute", &format!("<limit {bounds}/>"));
        assert!(
            Robot::reader().lenient().parse(&text, "one.urdf").is_err(),
            "{bounds}"
        );
    }
}

#[test]
fn leftover_macro_call_is_ignored_with_a_note() {
    let call = "<xacro:sensors port='none'/></robot>";
    let text = text("revolute", "<limit lower='-1' upper='1'/>")
        .replace("</robot>", call)
        .replace("<robot ", "<robot xmlns:xacro='http://ros.org/wiki/xacro' ");
    let robot = Robot::parse(&text, "one.urdf").unwrap();
    let [note] = &repairs(&robot)[..] else {
        panic!("{:?}", repairs(&robot))
    };
    assert!(note.contains("<xacro:sensors>"), "{note}");
    // A file that defines a macro must be expanded first.
    let defines = text.replace(
        call,
        "<xacro:macro name='sensors'/><xacro:sensors/></robot>",
    );
    assert!(Robot::parse(&defines, "one.urdf").is_err());
}

#[test]
fn undeclared_world_link_is_added_with_a_note() {
    let text = "<robot name='r'><link name='arm'/><joint name='weld' type='fixed'><parent link='world'/><child link='arm'/>\
                <origin xyz='0 0 1'/></joint></robot>";
    let robot = Robot::parse(text, "r.urdf").unwrap();
    assert!(robot.model().frame("world").is_ok());
    assert!(
        repairs(&robot)[0].contains("`world`"),
        "{:?}",
        repairs(&robot)
    );
    assert!(Robot::parse(&text.replace("world", "ground"), "r.urdf").is_err());
}
