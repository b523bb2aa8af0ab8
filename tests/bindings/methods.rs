//! Methods of solvers by name.

use kinopt_bindings::method::{METHODS, SolverMethod};
use kinopt_bindings::option::solver::SolverOptions;
use serde_json::{Value, json};

fn method(name: &str, settings: Value) -> Result<Option<SolverMethod>, String> {
    let settings = settings.as_object().unwrap().clone();
    let method = SolverMethod::of(name, &settings, &SolverOptions::default());
    method.map_err(|error| error.to_string())
}

#[test]
fn methods_without_settings_have_their_names() {
    for name in METHODS {
        let method = method(name, json!({}));
        assert_eq!(
            method
                .ok()
                .flatten()
                .map(|method| method.name().to_owned())
                .as_deref(),
            Some(name)
        );
    }
    assert!(method("newton", json!({})).is_ok_and(|method| method.is_none()));
}

#[test]
fn setting_out_of_range_is_named() {
    let wrong = [
        (
            "levenberg-marquardt",
            json!({"damping": "none"}),
            "damping rule",
        ),
        (
            "levenberg-marquardt",
            json!({"initial_damping": 0.0}),
            "initial_damping",
        ),
        (
            "gauss-newton",
            json!({"rank_tolerance": 0.9}),
            "rank_tolerance",
        ),
        (
            "projected-gradient",
            json!({"first_step": -1.0}),
            "first_step",
        ),
        ("two_bone", json!({"elbow": "up"}), "side of an elbow"),
        ("two_bone", json!({}), "elbow"),
    ];
    for (name, settings, named) in wrong {
        let error = method(name, settings).err().unwrap_or_default();
        assert!(error.contains(named), "{name}: {error}");
    }
}

#[test]
fn two_bone_rejects_limits() {
    let limits = SolverOptions {
        attempts: Some(2),
        ..SolverOptions::default()
    };
    let settings = json!({"elbow": "positive"});
    let settings = settings.as_object().unwrap().clone();
    assert!(SolverMethod::of("two_bone", &settings, &SolverOptions::default()).is_ok());
    assert!(SolverMethod::of("two_bone", &settings, &limits).is_err());
}
