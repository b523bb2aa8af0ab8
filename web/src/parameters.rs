//! Free and locked joints of a problem.

use kinopt::model::{JointKind, ParameterMap};
use wasm_bindgen::prelude::*;

use crate::arguments::{self, NamedArguments};
use crate::model::Model;
use crate::raise;

/// Builds the map from `locked`, `only` and `held`; the default is that of the robot.
pub(crate) fn parameters(
    model: &Model,
    options: &NamedArguments,
) -> Result<Option<ParameterMap>, JsError> {
    let (only, held) = (options.texts("only")?, options.numbers("held")?);
    let locked = arguments::entries(options.get("locked").as_ref(), "locked")?;
    if locked.is_empty() && only.is_none() && held.is_none() {
        return Ok(model.robot.as_ref().map(|robot| robot.map().clone()));
    }
    let inner_model = &model.inner;
    let mut builder = match &model.robot {
        Some(robot) => robot.parameters(),
        None => ParameterMap::builder(inner_model),
    };
    for (name, value) in locked {
        let (joint, what) = (
            inner_model.joint(&name).map_err(raise)?,
            format!("locked.{name}"),
        );
        builder = match inner_model.joints()[joint.index()].kind {
            JointKind::Ball => builder.with_locked_ball(joint, arguments::vector(&value, &what)?),
            _ => builder.with_locked(joint, arguments::number(&value, &what)?),
        };
    }
    if let Some(names) = only {
        let free = names.iter().map(|name| inner_model.joint(name));
        let free = free.collect::<Result<Vec<_>, _>>().map_err(raise)?;
        builder = builder.with_only(&free, &held.unwrap_or_else(|| inner_model.neutral()));
    } else if held.is_some() {
        let message = "held needs `only`: it is the configuration of the joints that `only` omits";
        return Err(JsError::new(message));
    }
    builder.build().map(Some).map_err(raise)
}
