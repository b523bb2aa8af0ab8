//! Options of an arm as keywords.

use std::time::Duration;

use kinopt::arm::{ArmBuilder, Search};
use kinopt::model::UnknownName;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};

use crate::arrays::{self, number};
use crate::error::{OrRaise, invalid};
use crate::goal::PoseBounds;
use crate::placement::placement;

/// All keywords; `held` requires `only`, `margin` requires `world`.
const NAMES: [&str; 23] = [
    "attempts",
    "atlas",
    "collision_model",
    "global_search_on_miss",
    "goal",
    "held",
    "iterations",
    "joint_weights",
    "limit_avoidance",
    "locked",
    "margin",
    "max_move",
    "metres_per_radian",
    "only",
    "orientation_tolerance",
    "position_tolerance",
    "posture",
    "search",
    "seed",
    "srdf",
    "time_limit",
    "tool",
    "world",
];

/// Applies all keywords to the builder; None is the default, `neutral` for `held`.
pub(super) fn apply<'m>(
    mut builder: ArmBuilder<'m>,
    options: &Bound<'_, PyDict>,
    neutral: &[f64],
) -> PyResult<ArmBuilder<'m>> {
    for (name, value) in options {
        let name: String = name.extract()?;
        if !NAMES.contains(&name.as_str()) {
            Err(UnknownName::new("option of an arm", &name, NAMES)).or_raise()?;
        }
        if !value.is_none() {
            builder = set(builder, &name, &value, options, neutral)?;
        }
    }
    Ok(builder)
}

fn set<'m>(
    builder: ArmBuilder<'m>,
    name: &str,
    value: &Bound<'_, PyAny>,
    options: &Bound<'_, PyDict>,
    neutral: &[f64],
) -> PyResult<ArmBuilder<'m>> {
    let numbers = || arrays::vector(value, name);
    Ok(match name {
        "attempts" => builder.with_attempts(whole::<u32>(value, name)?),
        "atlas" => builder.with_atlas(switch(value, name)?),
        "global_search_on_miss" => builder.with_global_search_on_miss(switch(value, name)?),
        "goal" => builder.with_goal(goal(value)?),
        "iterations" => builder.with_iterations(whole::<u32>(value, name)?),
        "joint_weights" => builder.with_joint_weights(&numbers()?),
        "limit_avoidance" => builder.with_limit_avoidance(number(value, name)?),
        "locked" => locked(builder, value)?,
        "max_move" => builder.with_max_move(&numbers()?),
        "metres_per_radian" => builder.with_metres_per_radian(number(value, name)?),
        "only" => only(builder, value, options, neutral)?,
        "orientation_tolerance" => builder.with_orientation_tolerance(number(value, name)?),
        "position_tolerance" => builder.with_position_tolerance(number(value, name)?),
        "posture" => builder.with_posture(&numbers()?),
        "search" => builder.with_search(search(value)?),
        "seed" => builder.with_seed(whole::<u64>(value, name)?),
        "time_limit" => builder.with_time_limit(seconds(value)?),
        "tool" => builder.with_tool(placement(value, "tool")?),
        // `held` is read with `only`; `srdf`, `world`, `margin` and `collision_model` are read when the arm is created.
        _ => builder,
    })
}

fn whole<T: TryFrom<u64>>(value: &Bound<'_, PyAny>, name: &str) -> PyResult<T> {
    let number = arrays::whole(value);
    number.map_err(|_| {
        invalid(format!(
            "{name} must be a whole number of at least 0, not {value}"
        ))
    })
}

fn switch(value: &Bound<'_, PyAny>, name: &str) -> PyResult<bool> {
    let switch = value.extract::<bool>();
    switch.map_err(|_| invalid(format!("{name} must be True or False, not {value}")))
}

fn seconds(value: &Bound<'_, PyAny>) -> PyResult<Duration> {
    let seconds = number(value, "time_limit")?;
    Duration::try_from_secs_f64(seconds).map_err(|_| {
        invalid(format!(
            "time_limit is {seconds} s, expected a finite number of at least 0"
        ))
    })
}

fn goal(value: &Bound<'_, PyAny>) -> PyResult<kinopt::arm::PoseBounds> {
    match value.cast::<PoseBounds>() {
        Ok(goal) => Ok(goal.get().inner),
        Err(_) => Err(invalid(format!(
            "goal must be a kinopt.PoseBounds, not {value}"
        ))),
    }
}

fn search(value: &Bound<'_, PyAny>) -> PyResult<Search> {
    let names = ["start", "first", "nearest"];
    let name = value.cast::<PyString>().map(|name| name.to_string());
    match name.as_deref() {
        Ok("start") => Ok(Search::Start),
        Ok("first") => Ok(Search::First),
        Ok("nearest") => Ok(Search::Nearest),
        _ => Err(UnknownName::new("search", &value.str()?.to_string(), names)).or_raise(),
    }
}

fn locked<'m>(mut builder: ArmBuilder<'m>, value: &Bound<'_, PyAny>) -> PyResult<ArmBuilder<'m>> {
    let locked = value
        .cast::<PyDict>()
        .map_err(|_| invalid("locked must be a dict {joint: value}"))?;
    for (joint, value) in locked {
        let joint = arrays::name(&joint, "a joint of locked")?;
        let value = number(&value, &format!("locked[{joint:?}]"))?;
        builder = builder.with_locked(&joint, value);
    }
    Ok(builder)
}

fn only<'m>(
    builder: ArmBuilder<'m>,
    value: &Bound<'_, PyAny>,
    options: &Bound<'_, PyDict>,
    neutral: &[f64],
) -> PyResult<ArmBuilder<'m>> {
    let joints: Vec<String> = value
        .extract()
        .map_err(|_| invalid("only must be a list of names of joints"))?;
    match options.get_item("held")? {
        Some(held) if !held.is_none() => {
            let held = arrays::vector(&held, "held")?;
            Ok(builder.with_only(&joints, &held))
        }
        _ => Ok(builder.with_only(&joints, neutral)),
    }
}
