//! Promise: a clip is found by its full name, or by the part after a separator if exactly one clip has it.

use std::sync::Arc;

use kinopt::animation::{Armature, Clip, ClipError, StateMachine, StateMachineDefinition};

fn clips(names: &[&str]) -> Vec<Clip> {
    let armature = Armature::new(Vec::new(), Vec::new()).unwrap();
    let clip = |name: &&str| Clip::builder(*name, &armature).build();
    names.iter().map(clip).collect()
}

const NAMES: [&str; 6] = [
    "Armature|Walk",
    "Armature|SlowWalk",
    "Armature|Run",
    "Other:Run",
    "Walk.001",
    "Idle",
];

#[test]
fn unique_suffix_of_a_name_is_accepted() {
    let clips = clips(&NAMES);
    for (query, meant) in [
        ("Walk", "Armature|Walk"),
        ("SlowWalk", "Armature|SlowWalk"),
        ("Armature|Run", "Armature|Run"),
        ("Other:Run", "Other:Run"),
        ("001", "Walk.001"),
        ("Idle", "Idle"),
    ] {
        assert_eq!(Clip::named(&clips, query).unwrap().name(), meant, "{query}");
    }
    // A full name has precedence over a last part, and of equal names the first clip is found.
    let same = self::clips(&["a|b", "b", "b", "c|d", "c|d"]);
    assert!(std::ptr::eq(Clip::named(&same, "b").unwrap(), &same[1]));
    assert!(std::ptr::eq(Clip::named(&same, "d").unwrap(), &same[3]));
}

#[test]
fn unknown_and_ambiguous_names_are_reported() {
    let clips = clips(&NAMES);
    let error = Clip::named(&clips, "Run").unwrap_err();
    let text = "clip name `Run` may mean `Armature|Run` or `Other:Run`";
    assert_eq!(error.to_string(), text);
    for unknown in ["alk", "walk", "", "|Walk", "Jump"] {
        let error = Clip::named(&clips, unknown).unwrap_err();
        let ClipError::UnknownName(error) = error else {
            panic!("{unknown}: {error}");
        };
        assert_eq!(error.valid, NAMES, "{unknown}");
    }
}

#[test]
fn state_machines_accept_name_suffixes() {
    let clips: Vec<Arc<Clip>> = clips(&NAMES).into_iter().map(Arc::new).collect();
    let machine = |clip: &str| {
        let text = format!(r#"{{"initial": "s", "states": [{{"name": "s", "clip": "{clip}"}}]}}"#);
        let definition: StateMachineDefinition = serde_json::from_str(&text).unwrap();
        StateMachine::new(&definition, &clips)
    };
    assert!(machine("Walk").is_ok());
    let error = machine("Run").unwrap_err().to_string();
    let text = "states[0].clip: clip name `Run` may mean `Armature|Run` or `Other:Run`";
    assert_eq!(error, text);
}
